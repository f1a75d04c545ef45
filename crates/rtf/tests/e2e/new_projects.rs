//! `rtf new`: each project runs with the commands that it prints, and turns red after an edit.

use std::path::Path;
use std::process::Command;

use insta::assert_snapshot;

use crate::support::{Finished, Folder, root};

/// An edit that makes the test of a project fail: a file, a text in it, and its replacement.
type Edit<'a> = (&'a str, &'a str, &'a str);

/// Pastes commands into a shell that has `rtf` in its path.
fn paste(folder: &Folder, commands: &str) -> Finished {
    let bins = Path::new(env!("CARGO_BIN_EXE_rtf")).parent().expect("a folder");
    let rtf = folder.command(&[]);
    let mut shell = Command::new("bash");
    shell.args(["-euc", commands]).current_dir(folder.path());
    for (name, value) in rtf.get_envs() {
        match value {
            Some(value) => shell.env(name, value),
            None => shell.env_remove(name),
        };
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    let paths = std::iter::once(bins.to_owned()).chain(std::env::split_paths(&path));
    shell.env("PATH", std::env::join_paths(paths).expect("a path"));
    Finished::of(shell.output().expect("bash runs"))
}

/// Writes a project, runs it with the printed commands, and again after an edit.
fn is_green_and_then_red(language: &str, kind: &str, (file, from, to): Edit<'_>) {
    let folder = Folder::new();
    let dir = "my robots/elbow";
    let written =
        folder.rtf(&["new", kind, "--language", language, "ElbowJoint", "--directory", dir]);
    assert_eq!((written.code, written.stderr.as_str()), (Some(0), ""), "{}", written.stdout);
    let (_, commands) = written.stdout.split_once("next:\n").expect("the next commands");
    let green = paste(&folder, commands);
    assert_eq!(green.code, Some(0), "{language} {kind}:\n{}{}", green.stdout, green.stderr);
    let passed = "PASSED  1 test in 1 suite";
    assert!(green.stdout.contains(passed), "{language} {kind}:\n{}", green.stdout);

    let file = format!("{dir}/{file}");
    let text = folder.read(&file);
    assert!(text.contains(from), "{file} has no `{from}`");
    folder.file(&file, &text.replace(from, to));
    let red = paste(&folder, commands);
    assert_eq!(red.code, Some(1), "{language} {kind}:\n{}{}", red.stdout, red.stderr);
    assert!(red.stdout.contains("1 failed"), "{language} {kind}:\n{}", red.stdout);
}

fn all_kinds(language: &str, test: Edit<'_>) {
    is_green_and_then_red(language, "test", test);
    is_green_and_then_red(language, "suite", ("elbow_joint.xml", "\"90\"", "\"80\""));
    is_green_and_then_red(language, "fixture", ("ElbowJointTest.lua", "\"ready\"", "\"lost\""));
}

#[test]
fn in_cpp() {
    all_kinds("cpp", ("ElbowJointTest.cpp", "90.0", "80.0"));
}

#[test]
fn in_python() {
    all_kinds("python", ("ElbowJointTest.py", "90.0", "80.0"));
}

#[test]
fn in_lua() {
    all_kinds("lua", ("ElbowJointTest.lua", "90", "80"));
}

#[test]
fn in_ruby() {
    all_kinds("ruby", ("ElbowJointTest.rb", "90", "80"));
}

#[test]
fn in_ada() {
    all_kinds("ada", ("elbow_joint_test.ads", "90.0", "80.0"));
}

/// The commands of the guide.
#[test]
fn the_guide() {
    let page = std::fs::read_to_string(root().join("docs/how-to/new-project.md")).expect("a page");
    let blocks: Vec<_> = page.split("```sh\n").skip(1).collect();
    assert_eq!(blocks.len(), 4);
    for block in blocks {
        let commands = block.split("```").next().expect("a block");
        let finished = paste(&Folder::new(), commands);
        assert_eq!(finished.code, Some(0), "{commands}{}{}", finished.stdout, finished.stderr);
    }
}

#[test]
fn prints_the_files_and_the_next_commands() {
    let folder = Folder::new();
    let finished = folder.rtf(&["new", "suite", "--language", "cpp", "elbow"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 0
    ----- stdout
    wrote elbow/CMakeLists.txt
    wrote elbow/CMakePresets.json
    wrote elbow/ElbowTest.cpp
    wrote elbow/README.md
    wrote elbow/elbow.xml
    wrote elbow/simulator.sh

    next:
      cd elbow
      cmake --preset default
      cmake --build --preset default
      RTF_PLUGIN_PATH=build rtf run elbow.xml
    ----- stderr
    ");
    assert_snapshot!(folder.read("elbow/README.md"), @"
    # elbow

    A suite with one test, in C++, and a program that stands in for the robot.

    ```sh
    cmake --preset default
    cmake --build --preset default
    RTF_PLUGIN_PATH=build rtf run elbow.xml
    ```

    - `elbow.xml`: the suite
    - `ElbowTest.cpp`: the test
    - `CMakeLists.txt`, `CMakePresets.json`: how it is built; the presets need CMake 3.21
    - `simulator.sh`: the fixture; replace it by your simulator or driver

    `rtf show -v` prints the measurements of the last run.
    ");
    let finished = folder.rtf(&["new", "test", "-l", "lua", "knee-test", "-d", "."]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 0
    ----- stdout
    wrote ./KneeTest.lua
    wrote ./README.md

    next:
      rtf run KneeTest.lua
    ----- stderr
    ");
}

#[test]
fn nothing_is_overwritten() {
    let folder = Folder::new();
    folder.file("elbow/elbow.xml", "mine").file("elbow/notes.txt", "mine, too");
    std::os::unix::fs::symlink("gone", folder.path().join("elbow/README.md")).expect("a link");
    let finished = folder.rtf(&["new", "suite", "--language", "lua", "elbow"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: `elbow/README.md`, `elbow/elbow.xml` exist, and `rtf new` does not overwrite them
    hint: `--directory DIR` writes the project to another directory
    ");
    let mut names: Vec<_> = (folder.path().join("elbow").read_dir().expect("a folder"))
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    assert_eq!(names, ["README.md", "elbow.xml", "notes.txt"]);
    assert_eq!(folder.read("elbow/elbow.xml"), "mine");
    let twice = folder.rtf(&["new", "test", "--language", "lua", "knee"]).code;
    assert_eq!(twice, Some(0));
    assert_eq!(folder.rtf(&["new", "test", "--language", "lua", "knee"]).code, Some(2));
}

#[test]
fn what_cannot_be_written() {
    let folder = Folder::new();
    folder.file("file", "");
    let arguments: [&[&str]; 4] = [
        &["new", "test", "--language", "lua", "../knee"],
        &["new", "test", "--language", "lua", "knee", "--directory", "file/knee"],
        &["new", "test", "--language", "perl", "knee"],
        &["new", "test", "knee"],
    ];
    let shown: Vec<_> = arguments.iter().map(|args| folder.shown(&folder.rtf(args))).collect();
    assert_snapshot!(shown.join("\n"), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: `../knee` cannot be the name of a project
    hint: a name starts with a letter and contains letters, digits, `-` and `_`: `elbow`

    exit code 2
    ----- stdout
    ----- stderr
    error: `file/knee/KneeTest.lua` cannot be written: Not a directory (os error 20)

    exit code 2
    ----- stdout
    ----- stderr
    error: invalid value 'perl' for '--language <LANGUAGE>'
      [possible values: cpp, python, lua, ruby, ada]

    For more information, try '--help'.

    exit code 2
    ----- stdout
    ----- stderr
    error: the following required arguments were not provided:
      --language <LANGUAGE>

    Usage: rtf new --language <LANGUAGE> <KIND> <NAME>

    For more information, try '--help'.
    ");
}
