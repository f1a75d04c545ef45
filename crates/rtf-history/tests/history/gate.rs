//! Gates over planted results.

use rtf_history::RunSelection;
use rtf_history::answers::gate::{
    Direction, GateLimits, GateReport, GateRuns, NotJudgedReason, RegressionGate,
};
use rtf_model::Verdict::{self, Collapsed, Error, Failed, Passed, Skipped};

use crate::world::{Run, Test, World, all_tests};

/// Judges the last run against runs of `main`.
fn judge(runs: &[Run], limits: &GateLimits) -> GateReport {
    let world = World::with(runs);
    let run = world.store.runs(&RunSelection::default()).expect("runs").remove(0);
    let main = RunSelection { branch: Some("main".to_owned()), ..RunSelection::default() };
    let runs = GateRuns::new(&world.store, run, &main, 20).expect("runs");
    world.store.gate(&runs, limits, &all_tests).expect("a report")
}

fn run(day: u32, commit: &'static str, verdict: Verdict) -> Run {
    Run::new(day, commit, vec![Test::new("Moves", verdict)])
}

/// The new failures, and the failures that are not judged.
fn new_failures(baseline: &[Verdict], verdict: Verdict) -> (usize, usize) {
    let mut runs: Vec<_> = (1..).zip(baseline).map(|(day, it)| run(day, "aaaa", *it)).collect();
    runs.push(Run { branch: "arm", ..run(90, "bbbb", verdict) });
    let gate = judge(&runs, &GateLimits { max_new_failures: Some(0), ..GateLimits::default() });
    let failures = gate.new_failures.expect("the gate");
    assert_eq!((gate.passed, failures.passed), (failures.tests.is_empty(), gate.passed));
    (failures.tests.len(), failures.not_judged.len())
}

#[test]
fn a_failure_is_new_if_the_newest_result_of_the_baseline_passed() {
    assert_eq!(new_failures(&[Passed], Failed), (1, 0));
    assert_eq!(new_failures(&[Failed, Passed, Skipped], Collapsed), (1, 0));
    assert_eq!(new_failures(&[Passed, Failed], Failed), (0, 0));
    assert_eq!(new_failures(&[Passed, Error], Failed), (0, 0));
    assert_eq!(new_failures(&[Passed], Skipped), (0, 0));
    assert_eq!(new_failures(&[Skipped], Failed), (0, 1));
    assert_eq!(new_failures(&[], Failed), (0, 1));
}

#[test]
fn the_share_of_flaky_tests() {
    let tests = |moves, stops| vec![Test::new("Moves", moves), Test::new("Stops", stops)];
    let runs =
        [Run::new(1, "aaaa", tests(Passed, Passed)), Run::new(2, "aaaa", tests(Failed, Passed))];
    let limits = |max| GateLimits { max_flaky: Some(max), ..GateLimits::default() };
    let gate = judge(&runs, &limits(0.5));
    let flaky = gate.flaky.expect("the gate");
    assert_eq!((gate.passed, flaky.share, flaky.tests.len()), (true, 0.5, 1));
    assert!(!judge(&runs, &limits(0.49)).passed);
}

fn measured(day: u32, robot: &'static str, verdict: Verdict, lag: Option<f64>) -> Run {
    let test = Test { measured: vec![("lag", lag, "ms")], ..Test::new("Moves", verdict) };
    Run { robot, ..Run::new(day, "aaaa", vec![test]) }
}

/// Compares a value with those of the baseline.
fn regression(baseline: &[f64], value: Option<f64>, limit: &str) -> RegressionGate {
    let mut runs: Vec<_> =
        (1..).zip(baseline).map(|(day, lag)| measured(day, "", Passed, Some(*lag))).collect();
    // A failure, and another robot, are not the baseline.
    runs.push(measured(80, "", Failed, Some(1e9)));
    runs.push(measured(81, "robot:icub", Passed, Some(1e9)));
    runs.push(Run { branch: "arm", ..measured(90, "", Passed, value) });
    let no_regression = vec![limit.parse().expect("a limit")];
    judge(&runs, &GateLimits { no_regression, ..GateLimits::default() }).no_regression.remove(0)
}

fn passes(baseline: &[f64], value: f64, limit: &str) -> bool {
    let gate = regression(baseline, Some(value), limit);
    assert_eq!(gate.series.len(), 1, "{gate:?}");
    gate.passed
}

#[test]
fn a_regression_is_a_change_for_the_worse() {
    let baseline = [10.0, 9.0, 12.0];
    assert!(passes(&baseline, 11.0, "lag>10%"));
    assert!(!passes(&baseline, 11.01, "lag>10%"));
    assert!(passes(&baseline, 8.9, "lag>10%"), "it has an upper limit");
    assert!(passes(&baseline, 8.9, "lag>+10%"));
    assert!(!passes(&baseline, 8.9, "lag>-10%"));
    assert!(passes(&baseline, 99.0, "lag>-10%"));
    let negative = [-10.0, -10.0, -10.0];
    assert!(!passes(&negative, -8.0, "lag>+10%"));
    assert!(passes(&negative, -12.0, "lag>+10%"));
    let gate = regression(&[0.0; 3], Some(1e-9), "lag>10%");
    assert_eq!((gate.passed, gate.series[0].change), (false, None), "any change from 0");
    assert!(passes(&[0.0; 3], 0.0, "lag>0%"));
    assert_eq!(gate.series[0].worse, Direction::Higher);
}

#[test]
fn too_little_is_not_judged() {
    let gate = regression(&[10.0, 10.0], Some(99.0), "lag>10%");
    assert!(gate.passed && gate.series.is_empty());
    assert_eq!(gate.not_judged[0].reason, NotJudgedReason::FewRuns { baseline_runs: 2 });
    let gate = regression(&[10.0; 5], None, "lag>10%");
    assert_eq!(gate.not_judged[0].reason, NotJudgedReason::NotFinite);
}

#[test]
fn a_run_without_an_end_fails() {
    let runs = [run(1, "aaaa", Passed), Run { is_complete: false, ..run(2, "bbbb", Passed) }];
    let gate = judge(&runs, &GateLimits { max_new_failures: Some(0), ..GateLimits::default() });
    assert!(!gate.passed);
    assert!(gate.new_failures.expect("the gate").passed);
}
