//! `rtf init`: files and lines are added once.

use insta::assert_snapshot;
use regex::Regex;

use crate::support::{Folder, root};

#[test]
fn a_second_call_changes_nothing() {
    let folder = Folder::new();
    folder.file(".gitignore", "*.pyc\n/build");
    let finished = folder.rtf(&["init"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 0
    ----- stdout
    wrote rtf.toml
    wrote .github/workflows/rtf.yml
    wrote .gitlab/rtf.yml
    wrote .gitlab-ci.yml
    added to .gitignore: rtf-results/
    ----- stderr
    ");
    assert_eq!(folder.read(".gitignore"), "*.pyc\n/build\nrtf-results/\n");
    let names = [
        "rtf.toml",
        ".gitignore",
        ".github/workflows/rtf.yml",
        ".gitlab/rtf.yml",
        ".gitlab-ci.yml",
    ];
    let before = names.map(|name| folder.read(name));
    let finished = folder.rtf(&["init", "--directory", "."]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 0
    ----- stdout
    unchanged: rtf.toml
    unchanged: .github/workflows/rtf.yml
    unchanged: .gitlab/rtf.yml
    unchanged: .gitlab-ci.yml
    unchanged: .gitignore
    nothing to do: the project has all files and lines
    ----- stderr
    ");
    assert_eq!(names.map(|name| folder.read(name)), before);
}

#[test]
fn what_is_there_stays() {
    let folder = Folder::new();
    folder.file("robot/rtf.toml", "jobs = 2\n").file("robot/.gitlab-ci.yml", "stages: [test]\n");
    let finished = folder.rtf(&["init", "--directory", "robot"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 0
    ----- stdout
    unchanged: rtf.toml
    wrote .github/workflows/rtf.yml
    wrote .gitlab/rtf.yml
    unchanged: .gitlab-ci.yml
    wrote .gitignore

    hint: .gitlab-ci.yml does not include the job; add:

    include:
      - local: .gitlab/rtf.yml

    ----- stderr
    ");
    assert_eq!(folder.read("robot/rtf.toml"), "jobs = 2\n");
    assert_eq!(folder.read("robot/.gitlab-ci.yml"), "stages: [test]\n");
    assert_snapshot!(folder.shown(&folder.rtf(&["init", "-d", "robot"])), @"
    exit code 0
    ----- stdout
    unchanged: rtf.toml
    unchanged: .github/workflows/rtf.yml
    unchanged: .gitlab/rtf.yml
    unchanged: .gitlab-ci.yml
    unchanged: .gitignore
    nothing to do: the project has all files and lines

    hint: .gitlab-ci.yml does not include the job; add:

    include:
      - local: .gitlab/rtf.yml

    ----- stderr
    ");
    let finished = folder.rtf(&["init", "--directory", "missing"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: there is no directory `missing`
    ");
}

/// The settings in comments are valid, and all but the examples have their defaults.
#[test]
fn the_settings_are_the_defaults() {
    let folder = Folder::new();
    folder.file("T.lua", "TestCase = {}\nfunction TestCase.run() end\n");
    folder.file("s.xml", "<suite><test>T.lua</test></suite>\n");
    let settings = |folder: &Folder| {
        let finished = folder.rtf(&["config", "show", "s.xml"]);
        assert_eq!(finished.code, Some(0), "{}", finished.stderr);
        let values = finished.stdout.lines().skip(1);
        let values =
            values.map(|line| line.split('#').next().unwrap_or_default().trim().to_owned());
        values.collect::<Vec<_>>()
    };
    let defaults = settings(&folder);
    assert_eq!(folder.rtf(&["init"]).code, Some(0));
    assert_eq!(settings(&folder), defaults, "everything is a comment");
    let text = folder.read("rtf.toml");
    let comment = Regex::new(r"(?m)^# (\[[a-z.]+\]|[\w.-]+ = )").expect("a pattern");
    assert_eq!(comment.find_iter(&text).count(), 17);
    folder.file("rtf.toml", &comment.replace_all(&text, "$1"));
    let changed: Vec<_> =
        settings(&folder).into_iter().filter(|line| !defaults.contains(line)).collect();
    // `5min` is `300s`; the defaults of `reports` and `retries` are not shown.
    let expected = [
        "env.ROBOT_IP = \"127.0.0.1\"",
        "param.tolerance = \"0.02\"",
        "timeouts.run = \"5min\"",
        "reports = []",
        "retries = \"0\"",
    ];
    assert_eq!(changed, expected);
}

/// The name of the wheel.
#[test]
fn the_jobs_install_the_wheel() {
    let project = std::fs::read_to_string(root().join("packaging/wheel/pyproject.toml"));
    let project = project.expect("the wheel's project");
    let name = Regex::new("(?m)^name = \"(.+)\"$").expect("a pattern");
    let wheel = &name.captures(&project).expect("a name")[1];
    let folder = Folder::new();
    assert_eq!(folder.rtf(&["init"]).code, Some(0));
    for file in [".github/workflows/rtf.yml", ".gitlab/rtf.yml"] {
        let text = folder.read(file);
        assert!(text.contains(&format!("pip install {wheel}\n")), "{file}: {text}");
    }
}
