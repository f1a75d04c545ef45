//! Known failures in suites, and quarantines in `rtf.toml`.

use std::fmt::Write as _;

use insta::assert_snapshot;
use jiff::civil::date;
use rtf_plan::plan::PlanOutcome;

use crate::bench::Bench;

fn bench(suite: &str, config: &str) -> Bench {
    let mut bench = Bench::new();
    bench.options.today = date(2027, 1, 15);
    for file in ["cell/A.lua", "cell/B.lua"] {
        bench.file(file, "");
    }
    bench.file("cell/s.xml", suite);
    bench.file("cell/t.xml", "<suite name='t'><test>A.lua</test></suite>");
    bench.file("cell/rtf.toml", config);
    bench
}

/// Formats the marks of all tests, then the problems.
fn shown(outcome: &PlanOutcome) -> String {
    let mut out = String::new();
    let suites = outcome.plan.iter().flat_map(|plan| &plan.suites);
    for test in suites.flat_map(|suite| &suite.tests) {
        let mark = test.expected.as_ref().map(|mark| serde_json::to_string(mark).unwrap());
        writeln!(out, "{} {}", test.name, mark.unwrap_or_default()).unwrap();
    }
    for found in &outcome.diagnostics {
        let label = &found.labels[0];
        let more: String =
            found.notes.iter().chain(&found.hint).map(|it| format!("; {it}")).collect();
        let at = format!("{}:{}:{}", label.file, label.line, label.column);
        let text = if label.text.is_empty() { String::new() } else { format!(" ({})", label.text) };
        writeln!(out, "{at}: {}{text}{more}", found.message).unwrap();
    }
    out
}

fn marked(attributes: &str) -> String {
    let bench = bench(&format!("<suite><test {attributes}>A.lua</test></suite>"), "");
    shown(&bench.build(&["s.xml"]))
}

#[test]
fn a_mark_covers_verdicts_until_a_day() {
    let days = ["2027-01-14", "2027-01-15", "2027-01-16", "2027-01-29", "2027-01-30"];
    let shown = days.map(|day| marked(&format!("expect='failed' issue='#7' until='{day}'")));
    assert_snapshot!(shown.concat(), @r##"
    A {"verdicts":["failed"],"issue":"#7","until":"2027-01-14","expired":true}
    s.xml:1:48: this known failure expired after 2027-01-14: the verdict counts (#7); fix the test, or choose a later `until`
    A {"verdicts":["failed"],"issue":"#7","until":"2027-01-15"}
    s.xml:1:48: this known failure expires after today (#7); fix the test, or choose a later `until`
    A {"verdicts":["failed"],"issue":"#7","until":"2027-01-16"}
    s.xml:1:48: this known failure expires after tomorrow (#7); fix the test, or choose a later `until`
    A {"verdicts":["failed"],"issue":"#7","until":"2027-01-29"}
    s.xml:1:48: this known failure expires in 14 days (#7); fix the test, or choose a later `until`
    A {"verdicts":["failed"],"issue":"#7","until":"2027-01-30"}
    "##);
    assert_snapshot!(marked("expect='error crashed, timed-out collapsed error'"), @r##"A {"verdicts":["error","crashed","timed-out","collapsed"]}"##);
}

#[test]
fn invalid_marks_are_errors() {
    let shown = [
        "expect='passed'",
        "expect='faild'",
        "expect='skipped'",
        "expect=' '",
        "expect='failed' until='tomorrow'",
        "expect='failed' until='2027-02-30'",
        "expect='failed' until='20270131'",
        "issue='#7'",
        "until='2027-01-31'",
    ]
    .map(marked);
    assert_snapshot!(shown.concat(), @r##"
    s.xml:1:22: `passed` is not a verdict that can be expected; the verdicts are `failed`, `error`, `crashed`, `timed-out`, `collapsed`; without a mark, a test is expected to pass
    s.xml:1:22: `faild` is not a verdict that can be expected; the verdicts are `failed`, `error`, `crashed`, `timed-out`, `collapsed`; did you mean `failed`?
    s.xml:1:22: `skipped` is not a verdict that can be expected; the verdicts are `failed`, `error`, `crashed`, `timed-out`, `collapsed`
    s.xml:1:22: `expect` is empty
    s.xml:1:37: `until` is not a date: `tomorrow`; write it like `2027-01-31`
    s.xml:1:37: `until` is not a date: `2027-02-30`; write it like `2027-01-31`
    s.xml:1:37: `until` is not a date: `20270131`; write it like `2027-01-31`
    s.xml:1:21: `issue` has no effect without `expect`; add `expect="failed"`
    s.xml:1:21: `until` has no effect without `expect`; add `expect="failed"`
    "##);
}

#[test]
fn a_mark_of_a_matrix_is_warned_about_once() {
    let test =
        "<test expect='failed' until='2027-01-20'>A.lua<matrix name='n' values='0 1'/></test>";
    let bench = bench(&format!("<suite>{test}</suite>"), "");
    assert_snapshot!(shown(&bench.build(&["s.xml"])), @r##"
    A[n=0] {"verdicts":["failed"],"until":"2027-01-20"}
    A[n=1] {"verdicts":["failed"],"until":"2027-01-20"}
    s.xml:1:37: this known failure expires in 5 days; fix the test, or choose a later `until`
    "##);
}

const TWO_TESTS: &str = "<suite name='s'><test tags='flaky'>A.lua</test>\
                         <test expect='failed' issue='#1'>B.lua</test></suite>";

#[test]
fn a_quarantine_marks_all_tests_that_match() {
    let config = "[[quarantine]]\nfilter = 'tag(flaky) | name(=B)'\nissue = '#2'\n\
                  reason = 'the gripper slips'\nuntil = 2027-01-31\nverdicts = ['failed', 'error']\n";
    let outcome = bench(TWO_TESTS, config).build(&["s.xml", "t.xml"]);
    assert_snapshot!(shown(&outcome), @r##"
    A {"verdicts":["failed","error"],"issue":"#2","reason":"the gripper slips","until":"2027-01-31","quarantined":true}
    B {"verdicts":["failed","error"],"issue":"#2","reason":"the gripper slips","until":"2027-01-31","quarantined":true}
    A
    "##);
}

#[test]
fn an_expired_quarantine_replaces_no_other_mark() {
    let config = "[[quarantine]]\nfilter = 'all()'\nuntil = '2027-01-14'\n\
                  [[quarantine]]\nfilter = 'name(=A)'\nissue = '#3'\n";
    assert_snapshot!(shown(&bench(TWO_TESTS, config).build(&["s.xml"])), @r##"
    A {"verdicts":["failed"],"issue":"#3","quarantined":true}
    B {"verdicts":["failed"],"issue":"#1"}
    rtf.toml:3:9: this known failure expired after 2027-01-14: the verdict counts; fix the test, or choose a later `until`
    "##);
}

#[test]
fn quarantines_of_the_profile_come_first() {
    let config = "[[quarantine]]\nfilter = 'name(=A)'\nissue = 'file'\n\
                  [[profile.sim.quarantine]]\nfilter = 'name(=A)'\nissue = 'profile'\n";
    let mut bench = bench("<suite><test>A.lua</test></suite>", config);
    assert!(shown(&bench.build(&["s.xml"])).contains("file"));
    bench.options.config_request.profile = Some("sim".to_owned());
    assert!(shown(&bench.build(&["s.xml"])).contains("profile"));
}

/// One `rtf.toml` serves all suites of a repository, of which a run often has only one.
#[test]
fn a_quarantine_without_a_test_is_warned_about_unless_it_is_about_another_suite() {
    let config = "[[quarantine]]\nfilter = 'suite(=t)'\n[[quarantine]]\nfilter = 'name(Gone)'\n\
                  [[quarantine]]\nfilter = '!file(s.xml) & name(Gone)'\n\
                  [[quarantine]]\nfilter = 'suite(=s) & name(Gone)'\n";
    let bench = bench(TWO_TESTS, config);
    assert_snapshot!(shown(&bench.build(&["s.xml"])), @r##"
    A 
    B {"verdicts":["failed"],"issue":"#1"}
    rtf.toml:4:10: this quarantine matches no test
    rtf.toml:8:10: this quarantine matches no test
    "##);
    assert_snapshot!(shown(&bench.build(&["t.xml"])), @r##"
    A {"verdicts":["failed"],"quarantined":true}
    rtf.toml:4:10: this quarantine matches no test
    rtf.toml:6:10: this quarantine matches no test
    "##);
}

#[test]
fn invalid_quarantines_are_errors() {
    let shown = [
        "quarantine = 3",
        "quarantine = [3]",
        "[[quarantine]]\nreason = 'x'",
        "[[quarantine]]\nfilter = 3",
        "[[quarantine]]\nfilter = 'tag(a) & nmae(x)'",
        "[[quarantine]]\nfilter = \"name(\\u0041) & nmae(x)\"",
        "[[quarantine]]\nfilter = 'case(x)'",
        "[[quarantine]]\nfilter = 'all()'\nuntil = 'soon'",
        "[[quarantine]]\nfilter = 'all()'\nuntil = 2027-01-31T10:00:00Z",
        "[[quarantine]]\nfilter = 'all()'\nuntil = 3",
        "[[quarantine]]\nfilter = 'all()'\nverdicts = []",
        "[[quarantine]]\nfilter = 'all()'\nverdicts = 'failed'",
        "[[quarantine]]\nfilter = 'all()'\nverdicts = ['passed', 'faild']",
        "[[quarantine]]\nfilter = 'all()'\nisue = '#3'",
    ]
    .map(|config| shown(&bench(TWO_TESTS, config).build(&["s.xml"])));
    assert_snapshot!(shown.concat(), @r##"
    rtf.toml:1:14: `quarantine` has to be tables: `[[quarantine]]`
    rtf.toml:1:15: `quarantine` has to be tables: `[[quarantine]]`
    rtf.toml:1:1: a `[[quarantine]]` needs a `filter`; for example `filter = "name(=Grasp)"`
    rtf.toml:2:10: `quarantine.filter` has to be a text
    rtf.toml:2:20: invalid filter (there is no condition `nmae`); did you mean `name`?
    rtf.toml:2:10: invalid filter (there is no condition `nmae`); did you mean `name`?
    rtf.toml:2:10: cases cannot be quarantined (`case` selects cases); quarantine their test
    rtf.toml:3:9: `quarantine.until` has to be a date: `"2027-01-31"`
    rtf.toml:3:9: `quarantine.until` has to be a date: `"2027-01-31"`
    rtf.toml:3:9: `quarantine.until` has to be a date: `"2027-01-31"`
    rtf.toml:3:12: `quarantine.verdicts` has to be a list of verdicts: `["failed", "error"]`
    rtf.toml:3:12: `quarantine.verdicts` has to be a list of verdicts: `["failed", "error"]`
    rtf.toml:3:13: `passed` is not a verdict that can be expected; the verdicts are `failed`, `error`, `crashed`, `timed-out`, `collapsed`; without a mark, a test is expected to pass
    rtf.toml:3:23: `faild` is not a verdict that can be expected; the verdicts are `failed`, `error`, `crashed`, `timed-out`, `collapsed`; did you mean `failed`?
    rtf.toml:3:1: unknown key `quarantine.isue`; the keys are `filter`, `issue`, `reason`, `until`, `verdicts`; did you mean `issue`?
    "##);
}
