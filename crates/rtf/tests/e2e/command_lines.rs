//! Command lines that cannot be right are told with what would be.

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
    error: `EncoderTest.lua` is no suite of which `::` could name a test
     |
     = help: leave `::` away: `EncoderTest.lua`

    1 error; nothing was started
    ");
    assert_snapshot!(refused(&folder(), &["run", "amr.xml::EncoderTest"]), @"
    error: there is no file or folder `amr.xml`
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
