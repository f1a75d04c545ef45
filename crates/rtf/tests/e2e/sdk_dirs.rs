//! `rtf cmake-dir`, `rtf ament-dir` and `rtf ada-dir`, in the source tree and where rtf is installed.

use std::path::Path;
use std::process::Command;

use insta::assert_snapshot;

use crate::support::{Finished, Folder};

const RTF: &str = env!("CARGO_BIN_EXE_rtf");

fn run(program: &Path, verb: &str) -> Finished {
    Finished::of(Command::new(program).arg(verb).output().expect("rtf runs"))
}

#[test]
fn in_the_source_tree() {
    let folder = Folder::new();
    let shown =
        ["cmake-dir", "ament-dir", "ada-dir"].map(|verb| folder.shown(&folder.rtf(&[verb])));
    assert_snapshot!(shown.concat(), @"
    exit code 0
    ----- stdout
    [ROOT]/sdk/cpp/cmake
    ----- stderr
    exit code 0
    ----- stdout
    [ROOT]/packaging/ament
    ----- stderr
    exit code 0
    ----- stdout
    [ROOT]/sdk/ada
    ----- stderr
    ");
}

#[test]
fn in_a_prefix() {
    let folder = Folder::new();
    std::fs::create_dir_all(folder.path().join("usr/bin")).expect("a folder");
    let program = folder.path().join("usr/bin/rtf");
    // The prefix may be on another file system.
    let linked = std::fs::hard_link(RTF, &program);
    linked.or_else(|_| std::fs::copy(RTF, &program).map(drop)).expect("a copy");
    let missing =
        ["cmake-dir", "ament-dir", "ada-dir"].map(|verb| folder.shown(&run(&program, verb)));
    assert_snapshot!(missing.concat(), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: `[FOLDER]/usr/bin/rtf` has no CMake packages
    hint: `make install` and the package `rtf-dev` install them
    exit code 2
    ----- stdout
    ----- stderr
    error: `[FOLDER]/usr/bin/rtf` has no package for ament
    hint: `make install` and the package `rtf-dev` install them
    exit code 2
    ----- stdout
    ----- stderr
    error: `[FOLDER]/usr/bin/rtf` has no Ada SDK
    hint: `make install` and the package `rtf-dev` install them
    ");
    folder.file("usr/lib/cmake/rtf/rtf-config.cmake", "");
    folder.file("usr/share/rtf/ament/ament_cmake_rtf/package.xml", "");
    folder.file("usr/share/rtf/ada/robottestingframework.gpr", "");
    let shown =
        ["cmake-dir", "ament-dir", "ada-dir"].map(|verb| folder.shown(&run(&program, verb)));
    assert_snapshot!(shown.concat(), @"
    exit code 0
    ----- stdout
    [FOLDER]/usr/lib/cmake
    ----- stderr
    exit code 0
    ----- stdout
    [FOLDER]/usr/share/rtf/ament
    ----- stderr
    exit code 0
    ----- stdout
    [FOLDER]/usr/share/rtf/ada
    ----- stderr
    ");
}
