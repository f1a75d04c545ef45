//! What reports ask a record for: names, numbers of tests, damage.

use crate::order::{ready, starting};
use crate::record::{message, record};
use crate::reports::attached;
use crate::support::*;
use rtf_model::{
    AttemptCounts, Damage, EventKind, FixtureId, HookId, Measurement, MessageKind, Micros, Phase,
    Record, Samples, Source, StopCause, SuiteId, TestId, Verdict,
};

/// Two suites with a test and a hook each, and a fixture in the second one.
fn two_suites(jobs: Option<u32>) -> Vec<EventKind> {
    let mut kinds = vec![
        run_started(),
        suite(0),
        hook(0, 0),
        test(0, 0, 1),
        suite(1),
        fixture(0, 1),
        hook(1, 1),
        test(1, 1, 1),
        test(2, 1, 1),
    ];
    if let EventKind::RunStarted(run) = &mut kinds[0] {
        run.manifest.jobs = jobs;
    }
    kinds
}

#[test]
fn names_contain_those_of_their_suites() {
    let record = record(two_suites(None));
    assert_eq!(record.full_name(TestId(1)), "suite-1/test-1");
    assert_eq!(record.full_name(TestId(7)), "test 7");
    assert_eq!(record.full_hook_name(HookId(1)), "suite-1/hook-1");
    assert_eq!(record.full_hook_name(HookId(7)), "hook 7");
    assert_eq!(record.fixture(FixtureId(0)).map(|it| &*it.plan.name), Some("fixture-0"));
    assert!(record.fixture(FixtureId(1)).is_none());
    for source in [Source::Test(TestId(2)), Source::Fixture(FixtureId(0)), Source::Hook(HookId(1))]
    {
        assert_eq!(record.suite_of(source), Some(SuiteId(1)), "{source:?}");
    }
    assert_eq!(record.suite_of(Source::Hook(HookId(0))), Some(SuiteId(0)));
    assert_eq!(record.suite_of(Source::Test(TestId(7))), None);
}

/// Only where suites run side by side, a fixture's name alone does not say which one is meant.
#[test]
fn the_name_of_a_fixture_contains_its_suite_if_suites_run_in_parallel() {
    let name = |jobs| record(two_suites(jobs)).fixture_name(FixtureId(0));
    assert_eq!(name(Some(2)), "suite-1/fixture-0");
    assert_eq!(name(Some(1)), "fixture-0");
    assert_eq!(name(None), "fixture-0");
    assert_eq!(record(two_suites(None)).fixture_name(FixtureId(1)), "?");
    assert!(record(two_suites(Some(2))).runs_suites_in_parallel());
    assert!(!record(two_suites(Some(1))).runs_suites_in_parallel());
}

#[test]
fn tests_are_counted_by_state() {
    let begins = |suite| EventKind::SuiteStarted { suite: SuiteId(suite) };
    let mut kinds = two_suites(None);
    kinds.extend([begins(0), started(1, 1), finished(Verdict::Failed), begins(1), skipped(1)]);
    let start = EventKind::TestStarted { test: TestId(2), repetition: 1, attempt: 1 };
    let before = record(kinds.clone()).totals();
    assert_eq!((before.planned, before.pending, before.running, before.done()), (3, 1, 0, 2));
    kinds.push(start);
    let record = record(kinds);
    let all = record.totals();
    assert_eq!((all.planned, all.pending, all.running, all.done()), (3, 0, 1, 2));
    let count = |totals: rtf_model::TestTotals| Verdict::ALL.map(|verdict| totals.of(verdict));
    let with = |verdicts: &[Verdict]| {
        Verdict::ALL.map(|verdict| verdicts.iter().filter(|it| **it == verdict).count() as u32)
    };
    assert_eq!(count(all), with(&[Verdict::Failed, Verdict::Skipped]));
    let second = record.suite_totals(SuiteId(1));
    assert_eq!((second.planned, second.running), (2, 1));
    assert_eq!(count(second), with(&[Verdict::Skipped]));
    assert_eq!(record.suite_totals(SuiteId(2)), rtf_model::TestTotals::default());
    // If the run had ended now, the test that runs would have been interrupted.
    let last = record.final_totals();
    assert_eq!(last.planned, 3);
    assert_eq!(count(last), with(&[Verdict::Failed, Verdict::Skipped, Verdict::Interrupted]));
}

#[test]
fn a_record_counts_events_and_knows_the_time_of_the_last_one() {
    let mut kinds = opened(1);
    kinds.extend([starting(1), ready()]);
    let count = kinds.len() as u64;
    let record = record(kinds);
    assert_eq!(record.events, count);
    assert!(record.last_at > Micros::default());
    assert!(record.suites[0].started.is_some() && record.suites[0].finished.is_none());
}

#[test]
fn the_first_damages_of_a_journal_are_kept() {
    let mut record = Record::default();
    assert!(!record.is_damaged());
    for line in 1..=2 * Damage::KEPT as u64 {
        record.add_damage(Damage { line, problem: "it is not JSON".to_owned() });
        assert!(record.is_damaged());
    }
    assert_eq!(record.damages.len(), Damage::KEPT);
    assert_eq!(record.damages.last().map(|damage| damage.line), Some(Damage::KEPT as u64));
}

fn measured(value: f64, high: f64) -> EventKind {
    let measurement = Measurement {
        name: "lag".to_owned(),
        value: Some(value),
        unit: "s".to_owned(),
        low: None,
        high: Some(high),
        learned: false,
        location: None,
        case: None,
    };
    EventKind::Measured { test: TEST, fixture: None, measurement }
}

fn sampled(values: [f64; 3], high: f64) -> EventKind {
    let samples = Samples {
        name: "elbow".to_owned(),
        unit: String::new(),
        low: None,
        high: Some(high),
        location: None,
        points: [0.0, 0.1, 0.2].into_iter().zip(values.map(Some)).collect(),
        case: None,
        since: None,
    };
    EventKind::Sampled { test: TEST, samples }
}

#[test]
fn the_reports_of_an_attempt_are_counted() {
    let reports = [
        message(MessageKind::Report),
        message(MessageKind::Failure),
        message(MessageKind::Error),
        measured(0.1, 0.2),
        measured(0.2, 0.2),
        measured(0.3, 0.2),
        sampled([0.5, 1.5, 2.5], 1.0),
        attached(None),
        attached(None),
    ];
    let attempt = [started(1, 1)].into_iter().chain(reports).chain([finished(Verdict::Failed)]);
    let record = record(opened(1).into_iter().chain(attempt).chain(closed()));
    let expected = AttemptCounts {
        messages: 3,
        failures: 2,
        measurements: 3,
        samples: 3,
        violations: 3,
        attachments: 2,
        output_bytes: 0,
    };
    let attempt = &record.tests[0].attempts[0];
    assert_eq!(attempt.counts, expected);
    let violations: Vec<_> = attempt.violations().map(|it| it.value).collect();
    assert_eq!(violations, [Some(0.3)]);
}

#[test]
fn a_measurement_outside_its_limits_is_a_problem() {
    let has = |value| {
        let events = [started(1, 1), measured(value, 0.2), finished(Verdict::Passed)];
        let record = record(opened(1).into_iter().chain(events));
        record.tests[0].attempts[0].has_reported_problem(None)
    };
    assert_eq!([0.1, 0.3].map(has), [false, true]);
}

#[test]
fn counts_of_attempts_are_added() {
    let counts = |unit: u64| AttemptCounts {
        messages: unit,
        failures: 2 * unit,
        measurements: 3 * unit,
        samples: 4 * unit,
        violations: 5 * unit,
        attachments: 6 * unit,
        output_bytes: 7 * unit,
    };
    let mut sum = counts(1);
    sum += counts(10);
    assert_eq!(sum, counts(11));
}

#[test]
fn an_attempt_keeps_what_explains_it() {
    let (cause, reason) = (StopCause::Timeout, "run did not end within 1s".to_owned());
    let events = [
        started(1, 1),
        EventKind::TestPhase { test: TEST, phase: Phase::Setup },
        EventKind::TestPhase { test: TEST, phase: Phase::Run },
        measured(0.1, 0.2),
        attached(None),
        EventKind::TestSlow { test: TEST },
        EventKind::StackDumped { source: Source::Test(TEST), text: "main.cpp:7".to_owned() },
        EventKind::TestStopping { test: TEST, cause, reason },
        EventKind::ProcessesLeaked {
            source: Source::Test(TEST),
            processes: vec![process(7, None)],
        },
        finished(Verdict::TimedOut),
    ];
    let record = record(opened(1).into_iter().chain(events));
    let test = &record.tests[0];
    let attempt = &test.attempts[0];
    let phases: Vec<_> = attempt.phases.iter().map(|(phase, _)| *phase).collect();
    assert_eq!(phases, [Phase::Setup, Phase::Run]);
    assert!(attempt.phases[0].1 > attempt.started);
    assert_eq!((attempt.measurements.len(), attempt.attachments.len()), (1, 1));
    assert_eq!((attempt.slow, attempt.stopped), (true, true));
    assert!(!attempt.has_reported_problem(None));
    assert_eq!((&attempt.stacks[..], attempt.leaked.len()), (&["main.cpp:7".to_owned()][..], 1));
    assert_eq!(test.reason(), Some("timed-out for a reason"));
    assert_eq!(test.duration(), std::time::Duration::from_millis(9));
}
