//! What other programs read from the JUnit report.

use crate::golden;
use crate::support::*;
use junit_parser::{TestCase, TestStatus, TestSuites};
use rtf_model::{Record, Verdict};

fn parsed(xml: &str) -> TestSuites {
    junit_parser::from_reader(xml.as_bytes()).unwrap()
}

fn cases(suites: &TestSuites) -> impl Iterator<Item = &TestCase> {
    suites.suites.iter().flat_map(|suite| &suite.cases)
}

fn case<'a>(suites: &'a TestSuites, name: &str) -> &'a TestCase {
    cases(suites).find(|case| case.original_name == name).unwrap()
}

/// What a server must count: tests, failures, errors, skipped; by hand for the streams
/// whose tests have cases or known failures.
fn wanted(name: &str, record: &Record) -> (u64, u64, u64, u64) {
    match name {
        // By test: its cases without containers, and its own result, if it has one.
        "cases" => return (40 + 4 + (2 + 1) + 2 + 2 + (3 + 1) + (1 + 1) + (1 + 1), 6, 2, 37),
        "carried-cases" => return (4, 1, 0, 1),
        "known-failures" => return golden::totals(),
        _ => {}
    }
    let totals = record.final_totals();
    let broken_fixtures = record.fixtures.iter().filter(|fixture| {
        let suite = &record.suites[fixture.plan.suite.index()];
        !fixture.problems(suite.plan.tolerates_collapse).is_empty()
    });
    let cut_short = !record.is_complete() || record.interrupted().is_some();
    let run = u64::from(cut_short || record.tests.is_empty());
    let hooks = record.hooks.iter().flat_map(|hook| &hook.runs);
    let (failed, done): (Vec<_>, Vec<_>) = hooks.partition(|run| run.problem().is_some());
    let problems = broken_fixtures.count() as u64 + run + failed.len() as u64;
    let benign = [Verdict::Passed, Verdict::Failed, Verdict::Skipped];
    let errors = Verdict::ALL.iter().filter(|v| !benign.contains(v)).map(|v| totals.of(*v));
    (
        record.tests.len() as u64 + problems + done.len() as u64,
        u64::from(totals.of(Verdict::Failed)),
        u64::from(errors.sum::<u32>()) + problems,
        u64::from(totals.of(Verdict::Skipped)),
    )
}

#[test]
fn there_is_a_case_for_each_declared_test_and_each_problem_beside_them() {
    for name in names() {
        let record = record(&name);
        let junit = parsed(&junit(&name));
        let told = (junit.tests, junit.failures, junit.errors, junit.skipped);
        assert_eq!(told, wanted(&name, &record), "{name}: the totals");
        let counted = |is: fn(&TestStatus) -> bool| {
            cases(&junit).filter(|case| is(&case.status)).count() as u64
        };
        let all = cases(&junit).count() as u64;
        let of_cases = (
            all,
            counted(TestStatus::is_failure),
            counted(TestStatus::is_error),
            counted(TestStatus::is_skipped),
        );
        assert_eq!(of_cases, wanted(&name, &record), "{name}: the cases");
        let is_green = all > 0 && counted(TestStatus::is_success) == all;
        assert_eq!(is_green, record.is_green(), "{name}: green");
    }
}

/// The predecessor's report had one constant message and no times.
#[test]
fn a_failure_tells_its_message_its_place_and_its_numbers() {
    let junit = parsed(&junit("verdicts"));
    let gripper = case(&junit, "GripperTest");
    let failure = gripper.status.failure_as_ref();
    assert_eq!((&*failure.message, &*failure.failure_type), ("the gripper is open", "failed"));
    for part in
        ["GripperTest.cpp:12", "at index 1", "measured position error = 0.7 rad, outside ≤ 0.5"]
    {
        assert!(failure.text.contains(part), "`{part}` in {}", failure.text);
    }
    assert_eq!(gripper.classname.as_deref(), Some("arm"));
    assert!(gripper.time > 0.0);
    assert!(
        gripper.system_out.as_deref().is_some_and(|out| out.contains("motor current too high"))
    );
}

#[test]
fn errors_of_the_bench_are_no_failures_of_the_robot() {
    let junit = parsed(&junit("verdicts"));
    let kind = |name| &*case(&junit, name).status.error_as_ref().error_type;
    assert_eq!(kind("RateTest"), "error");
    assert_eq!(kind("SegvTest"), "crashed");
    assert_eq!(kind("HangTest"), "timed-out");
    assert_eq!(kind("MoveTest"), "collapsed");
    let hang = &case(&junit, "HangTest").status.error_as_ref().text;
    assert!(hang.contains("hang.py") && hang.contains("4711 sleep 1000"), "{hang}");
    let collapsed = &case(&junit, "MoveTest").status.error_as_ref().text;
    assert!(collapsed.contains("| step 1001"), "{collapsed}");
}

/// The predecessor's report of a run in which a fixture collapsed was all green.
#[test]
fn a_collapse_is_seen_although_each_test_passed() {
    let junit = parsed(&junit("collapse-restart"));
    assert!(case(&junit, "MoveTest").status.is_success());
    let fixture = case(&junit, "fixture simulator").status.error_as_ref();
    assert_eq!(
        fixture.message,
        "fixture `simulator` collapsed: the process ended with exit code 3"
    );
    assert!(fixture.text.contains("physics diverged"));
}

#[test]
fn a_killed_runner_leaves_a_case_for_each_test() {
    let junit = parsed(&junit("killed"));
    assert!(case(&junit, "EncoderTest").status.is_success());
    let begun = case(&junit, "MoveTest").status.error_as_ref();
    assert_eq!(begun.message, "the run ended before the test did");
    assert!(begun.text.contains("joint 3 does not move"));
    let not_begun = case(&junit, "GripperTest").status.skipped_as_ref();
    assert_eq!(not_begun.message, "the run ended before the test started");
}

/// All tests passed, but the robot may not be in a safe state.
#[test]
fn each_run_of_a_hook_is_a_case_and_one_that_failed_is_an_error() {
    let junit = parsed(&junit("hooks"));
    let parked = case(&junit, "hook park (collapse)");
    assert!(parked.status.is_success());
    assert_eq!(parked.system_out.as_deref(), Some("moving to the rest position\nparked\n"));
    let brakes = case(&junit, "hook brakes (collapse)");
    let error = brakes.status.error_as_ref();
    assert_eq!((&*error.message, &*error.error_type), ("joint 22 is not locked", "hook"));
    for part in ["brakes.py:31", "4715 candump can0", "reason: fixture `simulator` collapsed"] {
        assert!(error.text.contains(part), "`{part}` in {}", error.text);
    }
    let hung = &case(&junit, "hook park (failure)").status.error_as_ref().text;
    assert!(hung.contains("Arm::waitUntilParked"), "{hung}");
    assert!(case(&junit, "hook park (end)").status.is_success());
}

#[test]
fn a_runner_that_died_is_an_error_with_what_it_left() {
    let junit = parsed(&junit("runner-died"));
    let run = case(&junit, "run").status.error_as_ref();
    assert_eq!(run.message, "the runner died: signal 9 (SIGKILL)");
    assert!(run.text.contains("4650 gzserver arm.world (fixture arm/simulator)"), "{}", run.text);
    assert!(case(&junit, "hook park (interrupt)").status.is_success());
}

#[test]
fn a_test_that_passed_and_left_processes_behind_names_them() {
    let junit = parsed(&junit("leaked"));
    let encoder = case(&junit, "EncoderTest");
    assert!(encoder.status.is_success());
    let err = encoder.system_err.as_deref();
    assert!(err.is_some_and(|err| err.contains("4711 sleep 1000")), "{err:?}");
}

#[test]
fn attachments_and_measurements_are_found() {
    let junit = parsed(&junit("verdicts"));
    let encoder = case(&junit, "EncoderTest");
    let out = encoder.system_out.as_deref().unwrap();
    let path = "rtf-results/run/attachments/EncoderTest-trajectory.csv";
    assert!(out.contains(&format!("[[ATTACHMENT|{path}]]")), "{out}");
    let rate = encoder.properties.hashmap.get("measurement.rate").map(String::as_str);
    assert_eq!(rate, Some("99.5 Hz (≥ 95)"));
}

#[test]
fn there_is_nothing_that_xml_forbids() {
    for name in names() {
        let xml = junit(&name);
        let allowed = |c: char| matches!(c, '\t' | '\n' | '\u{20}'..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{10000}'..);
        let forbidden: Vec<_> = xml.chars().filter(|c| !allowed(*c)).collect();
        assert!(forbidden.is_empty(), "{name}: {forbidden:?}");
    }
}
