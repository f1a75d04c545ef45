//! A fixture plug-in in C++ with a watchdog thread.

use std::path::PathBuf;

use rtf_model::{TestId, Verdict};

use crate::support::{Folder, build_cpp, nothing_left, root};

fn plugins() -> PathBuf {
    build_cpp(&root().join("crates/rtf/tests/e2e/cpp"), "e2e-cpp")
}

fn run(fixture_param: &str, tests: &str) -> Folder {
    let plugins = plugins();
    let folder = Folder::new();
    let fixture = plugins.join("Driver.so");
    let test = plugins.join("Probe.so");
    let tests = tests.replace("PROBE", &test.display().to_string());
    let fixture = format!("<fixture param='{fixture_param}'>{}</fixture>", fixture.display());
    folder.file("s.xml", &format!("<suite name='s'>\n  {fixture}\n  {tests}\n</suite>\n"));
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    folder
}

#[test]
fn a_collapse_from_another_thread_stops_the_test_which_still_tears_down() {
    let folder = run(
        "",
        "<test name='first' param='--wait'>PROBE</test>\n  <test name='second'>PROBE</test>",
    );
    let record = folder.journal().record;
    assert_eq!(record.verdict(TestId(0)), Some(Verdict::Collapsed));
    assert_eq!(
        record.tests[0].reason(),
        Some("fixture `Driver` collapsed: the watchdog lost the motor")
    );
    let attempt = &record.tests[0].attempts[0];
    assert!(attempt.messages.iter().any(|message| message.text == "the arm is at rest"));
    assert_eq!(record.verdict(TestId(1)), Some(Verdict::Passed));
    assert_eq!(record.fixtures[0].starts, 2);
    let torn_down = std::fs::read_to_string(folder.path().join("torn-down")).expect("a file");
    assert_eq!(torn_down, "xx", "each start is torn down once");
    assert!(nothing_left(&folder));
}

#[test]
fn a_check_that_returns_false_is_a_collapse() {
    let folder = run("--check", "<test>PROBE</test>");
    let record = folder.journal().record;
    assert_eq!(record.verdict(TestId(0)), Some(Verdict::Passed));
    assert_eq!(record.fixtures[0].collapses[0].1, "check failed: check returned false");
}
