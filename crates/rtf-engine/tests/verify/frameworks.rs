//! Hosts that list the cases of tests of other frameworks.

use std::time::Duration;

use crate::bench::Bench;
use crate::{Checked, only};

/// A bench with the test `arm_test`, whose host runs `script`.
fn bench(test: &str, script: &str) -> Checked {
    let bench = Bench::new();
    bench.program("bin/rtf-host-framework", script);
    bench.program("cell/arm_test", "exit 0");
    bench.file("cell/s.xml", &format!("<suite>\n{test}\n</suite>"));
    Checked { bench, limit: Duration::from_secs(20) }
}

const GTEST: &str = "<test type='gtest'>arm_test</test>";

#[test]
fn the_arguments_of_the_test_follow_the_files() {
    let test = "<test type='gtest' param='-v &quot;a b&quot;'>arm_test</test>";
    let script = "printf '%s\\n' \"$@\" > called\n\
                  printf '{\"file\":\"%s\",\"ok\":true,\"cases\":[]}\\n' \"$3\"";
    let bench = bench(test, script);
    bench.plan(&["s.xml"]);
    let called = std::fs::read_to_string(bench.root.join("cell/called")).unwrap();
    let file = bench.path("cell/arm_test");
    let expected = ["gtest", "--check", &file, "--", "-v", "a b"];
    assert_eq!(called.lines().collect::<Vec<_>>(), expected);
}

#[test]
fn long_lists_of_cases_are_read() {
    let script = "awk -v file=\"$3\" 'BEGIN { printf \"{\\\"file\\\":\\\"%s\\\",\\\"ok\\\":true,\\\"cases\\\":[\", file;\n\
                  for (n = 0; n < 50000; n++) printf \"%s{\\\"name\\\":\\\"Suite/Arm.Reaches/%060d\\\",\\\"tags\\\":[\\\"slow\\\"]}\", n ? \",\" : \"\", n;\n\
                  print \"]}\" }'";
    let plan = bench(GTEST, script).plan(&["s.xml"]);
    let cases = plan.suites[0].tests[0].cases_in_programs.as_ref().unwrap();
    let listed = cases.listed.as_ref().unwrap();
    assert_eq!(listed.len(), 50_000);
    assert!(listed[49_999].name.ends_with("49999") && listed[0].tags == ["slow"]);
}

#[test]
fn a_program_of_another_framework_is_reported_at_its_line() {
    let script = "printf '{\"file\":\"%s\",\"ok\":false,\"message\":\"it lists no tests\\\\nUsage: arm_test\"}\\n' \"$3\"";
    let checked = bench(GTEST, script);
    let outcome = checked.build(&["s.xml"]);
    let found = only(&outcome);
    let message = "`arm_test` cannot be run as a test of type `gtest`: it lists no tests";
    assert_eq!((found.code.as_str(), found.message.as_str()), ("plugin-not-loadable", message));
    assert_eq!(found.notes[0], "Usage: arm_test");
    assert_eq!((found.labels[0].line, found.labels[0].column), (2, 20));
}

#[test]
fn a_check_that_hangs_is_reported() {
    let test = "<test type='program'>arm_test</test>";
    let mut checked = bench(test, "exec sleep 1000");
    checked.limit = Duration::from_millis(500);
    let outcome = checked.build(&["s.xml"]);
    assert_eq!(only(&outcome).message, "checking `arm_test` takes longer than 500ms");
}
