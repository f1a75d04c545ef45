//! Which tests and hooks of a suite may run at the same time.

use rtf_model::{EventKind, HookId, Phase, SuiteId, TestFinished, TestId, Trigger, Verdict};

use crate::order::check;
use crate::support::{closed, hook, run_started, runner_died, stream, suite, test};

fn planned(parallel: u32) -> Vec<EventKind> {
    let mut planned = suite(0);
    if let EventKind::SuitePlanned(plan) = &mut planned {
        plan.parallel = parallel;
    }
    let suite = SuiteId(0);
    let kinds = [run_started(), planned, hook(0, 0), test(0, 0, 1), test(1, 0, 1), test(2, 0, 1)];
    kinds.into_iter().chain([EventKind::SuiteStarted { suite }]).collect()
}

fn start(test: u32) -> EventKind {
    EventKind::TestStarted { test: TestId(test), repetition: 1, attempt: 1 }
}

fn finish(test: u32) -> EventKind {
    let (verdict, phase) = (Verdict::Passed, Phase::Run);
    let (test, reason, exit, rerun) = (TestId(test), None, None, false);
    EventKind::TestFinished(TestFinished {
        test,
        verdict,
        reason,
        phase,
        exit,
        rerun,
        decided_by: None,
    })
}

fn park(starts: bool) -> EventKind {
    let hook = HookId(0);
    if !starts {
        return EventKind::HookFinished { hook, problem: None };
    }
    let (trigger, reason) = (Trigger::Failure, String::new());
    EventKind::HookStarted { hook, trigger, reason, test: None }
}

fn all(parallel: u32, body: Vec<EventKind>) -> Result<(), String> {
    check(&stream(planned(parallel).into_iter().chain(body).chain(closed())))
}

#[test]
fn as_many_tests_run_at_once_as_the_suite_says() {
    let two = || vec![start(0), start(1), finish(1), start(2), finish(0), finish(2)];
    assert_eq!(all(2, two()), Ok(()));
    let error = all(1, two()).unwrap_err();
    assert_eq!(error, "event 14: 2 tests of suite 0 run at the same time, at most 1 may");
    let three = vec![start(0), start(1), start(2), finish(1), finish(0), finish(2)];
    let error = all(2, three).unwrap_err();
    assert!(error.ends_with("3 tests of suite 0 run at the same time, at most 2 may"), "{error}");
}

#[test]
fn no_test_runs_next_to_a_hook() {
    let rest = || [start(1), finish(1), start(2), finish(2)];
    let after = [start(0), finish(0), park(true), park(false)];
    assert_eq!(all(2, after.into_iter().chain(rest()).collect()), Ok(()));
    for other in [
        [start(0), park(true), park(false), finish(0)],
        [park(true), start(0), finish(0), park(false)],
        [park(true), start(0), park(false), finish(0)],
    ] {
        let error = all(2, other.into_iter().chain(rest()).collect()).unwrap_err();
        assert!(
            error.ends_with("a hook of suite 0 runs next to a test or another hook"),
            "{error}"
        );
    }
}

/// The robot is parked while fixtures are notified of a verdict.
#[test]
fn a_hook_runs_next_to_a_test_that_is_judged() {
    let judged = || EventKind::TestPhase { test: TestId(0), phase: Phase::Notify };
    let rest = || [start(1), finish(1), start(2), finish(2)];
    for body in [
        vec![start(0), judged(), park(true), park(false), finish(0)],
        vec![start(0), judged(), park(true), finish(0), park(false)],
    ] {
        assert_eq!(all(1, body.into_iter().chain(rest()).collect()), Ok(()));
    }
    for body in [
        vec![start(0), park(true), judged(), park(false), finish(0), start(1), finish(1)],
        vec![start(0), judged(), park(true), start(1), park(false), finish(0), finish(1)],
        vec![start(0), start(1), judged(), park(true), park(false), finish(0), finish(1)],
    ] {
        let error = all(2, body.into_iter().chain([start(2), finish(2)]).collect()).unwrap_err();
        assert!(
            error.ends_with("a hook of suite 0 runs next to a test or another hook"),
            "{error}"
        );
    }
    let error = all(1, vec![start(0), judged(), judged()]).unwrap_err();
    assert_eq!(error, "event 9: test 0 is judged twice");
}

/// The guard's hooks run while the journal does not know the tests' ends.
#[test]
fn when_the_runner_died_what_ran_stays_open() {
    let body = [start(0), start(1), park(true), park(false), runner_died()];
    assert_eq!(check(&stream(planned(2).into_iter().chain(body))), Ok(()));
}
