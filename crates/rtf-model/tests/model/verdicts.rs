//! When the final verdict of a test is known, and which attempt decides it.

use crate::record::record;
use crate::support::*;
use rtf_model::{EventKind, Record, TestId, TestPlanned, Verdict};

use Verdict::{Failed, Passed, Skipped};

fn after(repetitions: u32, kinds: impl IntoIterator<Item = EventKind>) -> Record {
    record(opened(repetitions).into_iter().chain(kinds))
}

fn verdict(record: &Record) -> Option<Verdict> {
    record.tests[0].verdict()
}

#[test]
fn a_verdict_is_final_after_the_last_attempt_of_the_last_repetition() {
    assert_eq!(verdict(&after(1, [])), None);
    assert_eq!(verdict(&after(1, [started(1, 1)])), None);
    assert_eq!(verdict(&after(1, [started(1, 1), rerun(Failed)])), None);
    assert_eq!(verdict(&after(1, [started(1, 1), finished(Failed)])), Some(Failed));
    let first = [started(1, 1), finished(Passed)];
    assert_eq!(verdict(&after(2, first.clone())), None);
    let both = first.into_iter().chain([started(2, 1), finished(Passed)]);
    assert_eq!(verdict(&after(2, both)), Some(Passed));
}

#[test]
fn a_test_that_is_repeated_for_a_time_has_no_verdict_before_its_last_repetition() {
    let mut kinds: Vec<_> = opened(1);
    for kind in &mut kinds {
        if let EventKind::TestPlanned(TestPlanned { timed, .. }) = kind {
            *timed = true;
        }
    }
    kinds.extend([started(1, 1), finished(Passed)]);
    let open = record(kinds.clone());
    assert_eq!((verdict(&open), open.tests[0].repetitions()), (None, None));
    kinds.extend([started(2, 1), finished(Passed)]);
    kinds.push(EventKind::TestRepeated { test: TEST, repetitions: 2 });
    let ended = record(kinds);
    assert_eq!((verdict(&ended), ended.tests[0].repetitions()), (Some(Passed), Some(2)));
}

#[test]
fn the_first_problem_decides_then_the_first_skip() {
    let decisive = |verdicts: [Verdict; 3]| {
        let attempts =
            (1..).zip(verdicts).flat_map(|(number, v)| [started(number, 1), finished(v)]);
        let record = after(3, attempts);
        let attempt = record.tests[0].decisive_attempt().expect("an attempt");
        (attempt.repetition, record.tests[0].verdict())
    };
    assert_eq!(decisive([Passed, Skipped, Failed]), (3, Some(Failed)));
    assert_eq!(decisive([Passed, Skipped, Passed]), (2, Some(Skipped)));
    assert_eq!(decisive([Passed, Passed, Passed]), (3, Some(Passed)));
}

#[test]
fn a_flaky_test_is_green_unless_the_run_requests_otherwise() {
    let retried = [started(1, 1), rerun(Failed), started(1, 2), finished(Passed)];
    let rows = [(retried.to_vec(), true), (vec![started(1, 1), finished(Passed)], false)];
    for (attempts, is_flaky) in rows {
        for flaky_fails in [false, true] {
            let mut kinds = opened(1);
            if let EventKind::RunStarted(run) = &mut kinds[0] {
                run.manifest.flaky_fails = flaky_fails;
            }
            let record = record(kinds.into_iter().chain(attempts.clone()));
            let test = &record.tests[0];
            assert_eq!((test.is_flaky(), record.flaky_fails()), (is_flaky, flaky_fails));
            assert_eq!(record.has_green_result(test), !(is_flaky && flaky_fails));
        }
    }
}

/// In a larger gap, the number itself is taken to be damaged.
#[test]
fn lost_plans_are_filled_up_to_a_limit() {
    let with = |id| record([run_started(), suite(0), test(0, 0, 1), test(id, 0, 1)]);
    let filled = with(1001);
    assert_eq!(filled.tests.len(), 1002);
    assert_eq!(filled.tests[1].plan.name, "unknown-test-1");
    assert_eq!(filled.tests[1001].plan.test, TestId(1001));
    assert_eq!(with(1002).tests.len(), 1);
}
