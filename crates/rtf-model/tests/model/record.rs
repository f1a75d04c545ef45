//! What a record knows after a stream of events.

use std::time::Duration;

use crate::support::*;
use rtf_model::{
    AttemptRecord, EventKind, FixtureLife, FixtureState, Measurement, Message, MessageKind, Output,
    Record, Source, Stream, TestId, Verdict,
};

pub fn record(kinds: impl IntoIterator<Item = EventKind>) -> Record {
    let mut record = Record::default();
    for event in stream(kinds) {
        record.apply(&event);
    }
    record
}

fn run(repetitions: u32, body: impl IntoIterator<Item = EventKind>) -> Record {
    record(opened(repetitions).into_iter().chain(body).chain(closed()))
}

pub fn message(kind: MessageKind) -> EventKind {
    let message = Message {
        kind,
        text: "x".into(),
        location: None,
        comparison: None,
        critical: false,
        case: None,
        interval: None,
    };
    EventKind::Message { source: Source::Test(TEST), message, test: None }
}

fn printed(text: &str, omitted_bytes: u64) -> EventKind {
    let source = Source::Test(TEST);
    EventKind::Output(Output { source, stream: Stream::Stdout, omitted_bytes, text: text.into() })
}

/// What was reported is counted in both, and kept by one.
#[test]
fn a_lean_record_counts_what_it_does_not_keep() {
    let body = [
        started(1, 1),
        message(MessageKind::Report),
        message(MessageKind::Failure),
        printed("four", 3),
        finished(Verdict::Failed),
    ];
    let mut lean = Record::lean();
    let events = stream(opened(1).into_iter().chain(body.clone()).chain(closed()));
    events.iter().for_each(|event| lean.apply(event));
    let full = run(1, body);
    let [lean, full] = [&lean, &full].map(|record| &record.tests[0].attempts[0]);
    assert_eq!((lean.counts.messages, lean.counts.failures), (2, 1));
    assert_eq!(lean.counts.output_bytes, 4);
    assert_eq!(lean.counts, full.counts);
    assert_eq!((lean.messages.len(), full.messages.len()), (0, 2));
    assert_eq!((lean.output.len(), full.output.is_empty()), (0, false));
    assert_eq!(lean.finished, full.finished);
}

#[test]
fn each_life_of_a_fixture_is_known() {
    let fixture = SIMULATOR;
    let gone =
        || EventKind::FixtureCollapsed { fixture, reason: "gone".to_owned(), log_tail: Vec::new() };
    let life = |attempt, collapsed: bool| {
        let mut life = vec![
            EventKind::FixtureStarting { fixture, attempt },
            EventKind::FixtureReady { fixture },
        ];
        life.extend(collapsed.then(gone));
        life.push(EventKind::FixtureStopping { fixture });
        life.push(EventKind::FixtureStopped { fixture, problem: None, log_tail: Vec::new() });
        life
    };
    let record = run(1, [life(1, true), life(2, false), vec![skipped(0)]].concat());
    let lives = &record.fixtures[0].lives;
    let reasons: Vec<_> = lives.iter().map(|life| life.collapsed.as_ref().map(|c| &*c.1)).collect();
    assert_eq!(reasons, [Some("gone"), None]);
    let order =
        |life: &FixtureLife| Some(life.starting) < life.ready && life.stopping < life.stopped;
    assert!(lives.iter().all(order), "{lives:?}");
}

#[test]
fn only_a_complete_run_of_passed_tests_is_green() {
    assert!(run(1, [started(1, 1), finished(Verdict::Passed)]).is_green());
    assert!(!run(1, [started(1, 1), finished(Verdict::Failed)]).is_green());
    assert!(!run(1, [skipped(0)]).is_green());
    assert!(!record([run_started(), EventKind::RunFinished { interrupted: None }]).is_green());
    let torn = opened(1).into_iter().chain([started(1, 1), finished(Verdict::Passed)]);
    assert!(!record(torn).is_green());
}

#[test]
fn an_interrupted_run_is_not_green_although_each_test_passed() {
    let interrupted = Some("SIGINT".to_owned());
    let end = [closed()[0].clone(), EventKind::RunFinished { interrupted }];
    let body = [started(1, 1), finished(Verdict::Passed)];
    let record = record(opened(1).into_iter().chain(body).chain(end));
    assert!(!record.is_green());
    assert_eq!(record.interrupted(), Some("SIGINT"));
}

/// The predecessor turned a failing suite green when `repetition` was given.
#[test]
fn one_failing_repetition_decides_the_test() {
    let body = [
        started(1, 1),
        finished(Verdict::Passed),
        started(2, 1),
        finished(Verdict::Failed),
        started(3, 1),
        finished(Verdict::Passed),
    ];
    let record = run(3, body);
    assert_eq!(record.verdict(TEST), Some(Verdict::Failed));
    assert_eq!(record.tests[0].decisive_attempt().map(|a| a.repetition), Some(2));
    assert_eq!(record.tests[0].reason(), Some("failed for a reason"));
    assert_eq!(record.tests[0].duration(), Duration::from_millis(3));
}

#[test]
fn a_rerun_replaces_the_attempt_before_it() {
    let body = [started(1, 1), rerun(Verdict::Collapsed), started(1, 2), finished(Verdict::Passed)];
    let record = run(1, body);
    assert_eq!(record.verdict(TEST), Some(Verdict::Passed));
    assert_eq!(record.tests[0].attempts.len(), 2);
    assert_eq!(record.tests[0].reason(), None);
}

#[test]
fn a_rerun_that_never_came_leaves_the_verdict_of_the_first_attempt() {
    let record = run(1, [started(1, 1), rerun(Verdict::Collapsed), skipped(0)]);
    assert_eq!(record.verdict(TEST), Some(Verdict::Collapsed));
    assert_eq!(record.totals().of(Verdict::Collapsed), 1);
}

#[test]
fn a_run_that_was_killed_leaves_interrupted_and_skipped_tests() {
    let mut kinds = vec![run_started(), suite(0), test(0, 0, 1), test(1, 0, 1)];
    kinds.extend([EventKind::SuiteStarted { suite: SUITE }, started(1, 1)]);
    let record = record(kinds);
    assert_eq!(record.verdict(TEST), None);
    assert_eq!((record.totals().running, record.totals().pending), (1, 1));
    assert_eq!(record.final_verdict(TEST), Verdict::Interrupted);
    assert_eq!(record.final_verdict(TestId(1)), Verdict::Skipped);
    assert_eq!(record.final_totals().done(), 2);
    assert!(!record.is_complete());
}

#[test]
fn messages_are_kept_up_to_a_limit_for_each_kind_and_then_counted() {
    let reports = std::iter::repeat_with(|| message(MessageKind::Report));
    let many = AttemptRecord::MESSAGES_KEPT as usize + 7;
    let body = [started(1, 1)].into_iter().chain(reports.take(many));
    let end = [message(MessageKind::Failure), finished(Verdict::Failed)];
    let record = run(1, body.chain(end));
    let attempt = &record.tests[0].attempts[0];
    assert_eq!(attempt.messages_omitted, 7);
    assert_eq!(attempt.failures().count(), 1);
}

#[test]
fn output_is_kept_with_the_number_of_bytes_left_out_unless_the_test_passed() {
    let body = |verdict| [started(1, 1), printed("a\n", 0), printed("z\n", 26), finished(verdict)];
    let failed = run(1, body(Verdict::Failed));
    let wanted = "a\n\n[… 26 bytes left out …]\nz\n";
    assert_eq!(failed.tests[0].attempts[0].output, wanted);
    assert_eq!(run(1, body(Verdict::Passed)).tests[0].attempts[0].output, "");
}

#[test]
fn a_broken_fixture_stays_broken_and_tells_its_first_cause_once() {
    let reason = "no display".to_owned();
    let fixture = SIMULATOR;
    let body = [
        EventKind::FixtureStarting { fixture, attempt: 1 },
        EventKind::FixtureBroken { fixture, reason: reason.clone() },
        EventKind::FixtureStopping { fixture },
        EventKind::FixtureStopped { fixture, problem: Some(reason), log_tail: vec!["x".into()] },
        skipped(0),
    ];
    let record = run(1, body);
    assert_eq!(record.fixtures[0].state, FixtureState::Broken);
    assert_eq!(record.fixtures[0].log_tail, ["x"]);
    assert_eq!(record.suite_problems(SUITE), ["fixture `fixture-0` is broken: no display"]);
}

#[test]
fn a_collapse_speaks_against_a_suite_unless_it_tolerates_that() {
    let fixture = SIMULATOR;
    let body = [
        EventKind::FixtureStarting { fixture, attempt: 1 },
        EventKind::FixtureReady { fixture },
        started(1, 1),
        finished(Verdict::Passed),
        EventKind::FixtureCollapsed { fixture, reason: "gone".into(), log_tail: Vec::new() },
        EventKind::FixtureStopping { fixture },
        EventKind::FixtureStopped { fixture, problem: None, log_tail: Vec::new() },
    ];
    let strict = run(1, body.clone());
    assert_eq!(strict.suite_problems(SUITE), ["fixture `fixture-0` collapsed: gone"]);
    assert!(!strict.is_green());
    let mut planned = opened(1);
    if let EventKind::SuitePlanned(plan) = &mut planned[1] {
        plan.tolerates_collapse = true;
    }
    assert!(record(planned.into_iter().chain(body).chain(closed())).is_green());
}

#[test]
fn a_lost_plan_does_not_shift_what_is_known_of_the_tests_after_it() {
    let kinds = [run_started(), suite(0), test(0, 0, 1), test(2, 0, 1)];
    let skip = [EventKind::SuiteStarted { suite: SUITE }, skipped(2)];
    let record = record(kinds.into_iter().chain(skip));
    assert_eq!(record.full_name(TestId(2)), "suite-0/test-2");
    assert_eq!(record.full_name(TestId(1)), "suite-0/unknown-test-1");
    assert_eq!(record.verdict(TestId(2)), Some(Verdict::Skipped));
    assert_eq!(record.suites[0].tests, [TestId(0), TestId(1), TestId(2)]);
}

#[test]
fn a_number_that_cannot_be_true_is_not_believed() {
    let record = record([run_started(), suite(0), test(4_000_000_000, 0, 1), test(0, 0, 1)]);
    assert_eq!(record.tests.len(), 1);
}

#[test]
fn numbers_are_short() {
    let shown = [0.0, 0.5, -98.25, 1e308, 2e-7, f64::NAN].map(rtf_model::format_number);
    assert_eq!(shown, ["0", "0.5", "-98.25", "1e308", "2e-7", "NaN"]);
}

/// Text that is read with less care is off by the last bit.
#[test]
fn a_measured_value_is_the_same_after_the_journal() {
    for value in [0.026_000_000_000_000_002, 0.1 + 0.2, 1e-308, f64::MAX] {
        let text = serde_json::to_string(&value).unwrap();
        let read: f64 = serde_json::from_str(&text).unwrap();
        assert_eq!(read.to_bits(), value.to_bits(), "{text}");
    }
}

/// A value within its limits is rounded for people; one outside is shown to its last
/// digit, lest it look as if it were inside.
#[test]
fn a_measurement_is_rounded_unless_it_is_outside_its_limits() {
    let measured = |value, high| Measurement {
        learned: false,
        name: "error".to_owned(),
        value: Some(value),
        unit: "deg".to_owned(),
        low: Some(12.999_999_999_999_998),
        high: Some(high),
        location: None,
        case: None,
    };
    let shown = measured(14.993_230_922_134_464, 20.0).for_display();
    assert_eq!(shown, ("14.9932 deg".to_owned(), "13 … 20".to_owned()));
    let shown = measured(20.000_000_1, 20.0).for_display();
    assert_eq!(shown, ("20.0000001 deg".to_owned(), "12.999999999999998 … 20".to_owned()));
    assert_eq!(rtf_model::format_rounded(-2.345_678_9e-7), "-2.34568e-7");
    assert_eq!(rtf_model::format_rounded(1e308), "1e308");
}
