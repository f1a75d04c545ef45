//! Invalid command lines: the error names a valid alternative.

use std::process::Output;

use insta::assert_snapshot;

use crate::bad_input::{LUA_TEST, refused};
use crate::support::{Finished, Folder};

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("EncoderTest.lua", LUA_TEST);
    folder.file("arm.xml", "<suite name=\"arm\"><test>EncoderTest.lua</test></suite>");
    folder
}

/// The first paragraph of what is printed.
fn first(args: &[&str]) -> String {
    let shown = refused(&folder(), args);
    shown.split("\n\n").next().unwrap_or_default().to_owned()
}

#[test]
fn a_test_of_what_has_none() {
    assert_snapshot!(refused(&folder(), &["run", "EncoderTest.lua::run"]), @"
    error: `EncoderTest.lua` is not a suite: `::` cannot select a test of it
     |
     = help: remove the `::`: `EncoderTest.lua`

    1 error; nothing was started
    ");
    assert_snapshot!(refused(&folder(), &["run", "amr.xml::EncoderTest"]), @"
    error: there is no file or directory `amr.xml`
     |
     = note: looked for [FOLDER]/amr.xml

    1 error; nothing was started
    ");
}

#[test]
fn numbers_and_durations() {
    let told = |option: &str, value: &str| first(&["run", "arm.xml", option, value]);
    assert_snapshot!(told("--jobs", "0"), @"error: invalid value '0' for '--jobs <N>': 0 is not in 1..=65535");
    assert_snapshot!(told("--for", "3 parsecs"), @"error: invalid value '3 parsecs' for '--for <DURATION>': not a duration like `250ms`, `90s`, `2min` or `1h 30m` (a bare number is seconds)");
    assert_snapshot!(told("--shutdown-timeout", "0"), @"error: invalid value '0' for '--shutdown-timeout <DURATION>': must be longer than zero");
}

#[test]
fn options_that_need_others() {
    assert_snapshot!(refused(&folder(), &["run", "arm.xml", "--web-allow-remote"]), @"
    error: `--web-allow-remote` has no effect without `--web`
    hint: add `--web`
    ");
    assert_snapshot!(refused(&folder(), &["run", "arm.xml", "--rerun", "failed"]), @"
    error: `arm.xml` is not a journal: line 1: this is not an event: expected value at line 1 column 1
    hint: with `--rerun`, FILE is a past run or its journal
    ");
    assert_snapshot!(first(&["run", "arm.xml", "--shuffle=x"]), @"error: invalid value 'x' for '--shuffle[=<SEED>]': expected a number, as printed by an earlier run");
}

#[test]
fn a_report_that_cannot_be_written() {
    let folder = folder();
    assert_eq!(folder.rtf(&["run", "arm.xml"]).code, Some(0));
    for format in ["junit", "json"] {
        let finished = folder.rtf(&["report", "--format", format, "-o", "arm.xml/report"]);
        assert_eq!(finished.code, Some(2));
        let hint = "hint: choose another path with `-o PATH`\n";
        assert!(finished.stderr.ends_with(hint), "{}", finished.stderr);
    }
}

/// What cannot be read has one problem, not one for each byte that follows.
#[test]
fn a_configuration_that_is_not_utf8() {
    let folder = folder();
    std::fs::write(folder.path().join("rtf.toml"), b"jobs = 2\n\xff").expect("a file");
    assert_snapshot!(refused(&folder, &["run", "arm.xml"]), @"
    error: `rtf.toml` is not encoded in UTF-8
     --> rtf.toml:2:1
      |
    2 | �
      | ^ this byte is not UTF-8
      |
      = help: save the file as UTF-8

    1 error; nothing was started
    ");
}

/// `RTF_RESULTS= rtf run` is how a shell takes a variable away.
#[test]
fn a_variable_that_is_empty_is_not_set() {
    let folder = folder();
    let rtf = |args: &[&str]| -> Output {
        let mut command = folder.command(args);
        command.env("RTF_RESULTS", "").env("RTF_PROFILE", "").env("RTF_FORK", "");
        command.output().expect("rtf runs")
    };
    for args in [&["run", "arm.xml"][..], &["show"], &["config", "show"]] {
        let finished = Finished::of(rtf(args));
        assert_eq!(finished.code, Some(0), "{args:?}: {}", finished.stderr);
    }
    assert!(folder.path().join("rtf-results/latest").exists());
}
