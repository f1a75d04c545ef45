//! Cases inside a test, tests that skip themselves, and known failures.

use crate::order::check;
use crate::record::record;
use crate::support::*;
use rtf_model::{
    AttemptCases, CaseFinished, CaseId, CaseRecord, CaseStart, CaseStarted, EventKind,
    ExpectedFailure, Message, MessageKind, Phase, Record, Significance, Source, StopCause,
    TestPlanned, Verdict,
};

fn case(number: u32, name: &str, parent: Option<u32>) -> EventKind {
    let (case, parent) = (CaseId(number), parent.map(CaseId));
    let name = name.to_owned();
    let start = CaseStart { parent, ..CaseStart::new(case, name) };
    EventKind::CaseStarted(Box::new(CaseStarted { test: TEST, start }))
}

fn case_ends(number: u32, verdict: Verdict) -> EventKind {
    case_ends_after(number, verdict, None)
}

fn case_ends_after(number: u32, verdict: Verdict, carried_after_us: Option<u64>) -> EventKind {
    let reason = verdict.is_problem().then(|| format!("{verdict} for a reason"));
    EventKind::CaseFinished(CaseFinished {
        test: TEST,
        case: CaseId(number),
        verdict,
        reason,
        decided_by: None,
        duration_us: carried_after_us,
        carried: carried_after_us.is_some(),
        rerun: false,
        episode: None,
    })
}

fn report(case: u32) -> EventKind {
    let (kind, text, case) = (MessageKind::Report, "x".to_owned(), Some(CaseId(case)));
    let message = Message {
        kind,
        text,
        location: None,
        comparison: None,
        critical: false,
        case,
        interval: None,
    };
    EventKind::Message { source: Source::Test(TEST), message, test: None }
}

fn judged() -> EventKind {
    EventKind::TestPhase { test: TEST, phase: Phase::Notify }
}

fn body(middle: impl IntoIterator<Item = EventKind>) -> Vec<EventKind> {
    let end = [finished(Verdict::Passed)];
    let all = opened(1).into_iter().chain([started(1, 1)]).chain(middle).chain(end);
    all.chain(closed()).collect()
}

#[test]
fn nested_and_overlapping_cases_are_legal() {
    let passed = Verdict::Passed;
    let nested = [
        EventKind::CasesPlanned { test: TEST, names: vec!["a".into(), "z".into()] },
        case(1, "a", None),
        case(2, "b", Some(1)),
        case(3, "c", None),
        report(2),
        case_ends(2, passed),
        case_ends(1, passed),
        report(3),
        case_ends(3, passed),
    ];
    check(&stream(body(nested))).unwrap();
}

#[test]
fn cases_out_of_order_are_illegal() {
    let passed = Verdict::Passed;
    let streams: [(&str, Vec<EventKind>); 8] = [
        ("case out of order", vec![case(2, "a", None)]),
        ("starts in a case that is not open", vec![case(1, "a", Some(7))]),
        ("case 1 is not open", vec![case_ends(1, passed)]),
        ("is not open", vec![case(1, "a", None), case_ends(1, passed), case_ends(1, passed)]),
        ("finishes before a case in it", {
            vec![case(1, "a", None), case(2, "b", Some(1)), case_ends(1, passed)]
        }),
        ("reports and is not open", vec![report(1)]),
        ("ends before its cases", vec![case(1, "a", None)]),
        ("after its verdict", vec![judged(), case(1, "a", None)]),
    ];
    for (rule, events) in streams {
        let error = check(&stream(body(events))).unwrap_err();
        assert!(error.contains(rule), "{error} is not {rule}");
    }
}

#[test]
fn the_numbers_of_cases_begin_again_with_each_attempt() {
    let attempts = [
        started(1, 1),
        case(1, "a", None),
        case_ends(1, Verdict::Failed),
        rerun(Verdict::Failed),
        started(1, 2),
        case(1, "a", None),
        case_ends(1, Verdict::Passed),
        finished(Verdict::Passed),
    ];
    let kinds: Vec<_> = opened(1).into_iter().chain(attempts).chain(closed()).collect();
    check(&stream(kinds.clone())).unwrap();
    let record = record(kinds);
    let attempts = &record.tests[0].attempts;
    assert_eq!(attempts[0].cases.of(Verdict::Failed), 1);
    assert_eq!(attempts[1].cases.of(Verdict::Passed), 1);
}

/// Two attempts, the first of which a collapse interrupts.
fn rerun_with(second: impl IntoIterator<Item = EventKind>) -> Vec<EventKind> {
    let passed = Verdict::Passed;
    let first = [
        started(1, 1),
        case(1, "a", None),
        case_ends(1, passed),
        rerun(Verdict::Collapsed),
        started(1, 2),
    ];
    let attempts = first.into_iter().chain(second).chain([finished(passed)]);
    opened(1).into_iter().chain(attempts).chain(closed()).collect()
}

#[test]
fn carried_cases_keep_their_durations() {
    let passed = Verdict::Passed;
    let second = [
        case(1, "a", None),
        case_ends_after(1, passed, Some(700_000)),
        case(2, "b", None),
        case_ends(2, passed),
    ];
    let kinds = rerun_with(second);
    check(&stream(kinds.clone())).unwrap();
    let record = record(kinds);
    let cases = &record.tests[0].attempts[1].cases;
    let durations = cases.kept().iter().map(|case| case.duration().unwrap().as_millis());
    assert_eq!(durations.collect::<Vec<_>>(), [700, 1]);
    let carried: Vec<_> = cases.kept().iter().map(CaseRecord::is_carried).collect();
    assert_eq!((carried, cases.total()), (vec![true, false], 2));
}

#[test]
fn carried_cases_out_of_order_are_illegal() {
    let passed = Verdict::Passed;
    let carried = || [case(1, "a", None), case_ends_after(1, passed, Some(1))];
    let late = [
        case(1, "b", None),
        case_ends(1, passed),
        case(2, "a", None),
        case_ends_after(2, passed, Some(1)),
    ];
    for kinds in [body(carried()), rerun_with(late)] {
        let error = check(&stream(kinds)).unwrap_err();
        assert!(error.contains("of an earlier attempt is out of order"), "{error}");
    }
}

#[test]
fn a_record_knows_paths_durations_and_cases_that_did_not_run() {
    let events = [
        EventKind::CasesPlanned { test: TEST, names: vec!["a/b".into(), "lost".into()] },
        case(1, "a/b", None),
        case(2, "c", Some(1)),
        case_ends(2, Verdict::Failed),
        case_ends(1, Verdict::Passed),
    ];
    let record = record(body(events));
    let cases = &record.tests[0].attempts[0].cases;
    let inner = cases.get(CaseId(2)).unwrap();
    assert_eq!((&*inner.path, inner.verdict()), ("a/b/c", Some(Verdict::Failed)));
    assert_eq!(inner.reason(), Some("failed for a reason"));
    assert_eq!(inner.duration(), Some(std::time::Duration::from_millis(1)));
    assert_eq!(cases.not_run().names().collect::<Vec<_>>(), ["lost"]);
    assert_eq!(cases.total(), 3);
}

/// The name of a case may contain a slash.
#[test]
fn the_depth_of_a_case_is_the_number_of_cases_around_it() {
    let events = [
        case(1, "a/b", None),
        case(2, "c", Some(1)),
        case(3, "d/e", Some(2)),
        case_ends(3, Verdict::Passed),
        case_ends(2, Verdict::Passed),
        case_ends(1, Verdict::Passed),
    ];
    let record = record(body(events));
    let depth = |id| record.tests[0].attempts[0].cases.get(CaseId(id)).unwrap().depth();
    // The slash in the name of the first one counts for the cases in it.
    assert_eq!([1, 2, 3].map(depth), [0, 2, 3]);
}

#[test]
fn cases_are_counted_by_verdict_and_state() {
    let names = vec!["a".into(), "b".into(), "c".into(), "d".into(), "never".into()];
    let mut events = vec![EventKind::CasesPlanned { test: TEST, names }];
    let verdicts = [Verdict::Passed, Verdict::Failed, Verdict::Skipped, Verdict::Crashed];
    for ((number, name), verdict) in (1..).zip(["a", "b", "c", "d"]).zip(verdicts) {
        events.extend([case(number, name, None), case_ends(number, verdict)]);
    }
    let with_plan = record(body(events.clone()));
    let cases = &with_plan.tests[0].attempts[0].cases;
    assert_eq!((cases.problems(), cases.total(), cases.not_run().len()), (2, 5, 1));
    assert!(!cases.not_run().is_empty());
    let all_ran = record(body(events.split_off(1)));
    let cases = &all_ran.tests[0].attempts[0].cases;
    assert_eq!((cases.problems(), cases.total()), (2, 4));
    assert!(cases.not_run().is_empty());
}

#[test]
fn skipped_cases_are_noticed() {
    let has = |verdict| {
        let record = record(body([case(1, "a", None), case_ends(1, verdict)]));
        record.tests[0].has_skipped_cases()
    };
    assert_eq!([Verdict::Passed, Verdict::Skipped].map(has), [false, true]);
}

/// A case that failed only because of a case in it has no problem of its own.
#[test]
fn a_case_has_a_problem_of_its_own_or_that_of_a_case_in_it() {
    let failure = |case| {
        let EventKind::Message { source, mut message, test } = report(case) else { panic!() };
        message.kind = MessageKind::Failure;
        EventKind::Message { source, message, test }
    };
    let decided_by = |number: u32, by: u32| {
        let EventKind::CaseFinished(end) = case_ends(number, Verdict::Failed) else { panic!() };
        EventKind::CaseFinished(CaseFinished { decided_by: Some(CaseId(by)), ..end })
    };
    let events = [
        case(1, "by another", None),
        case(2, "inner", Some(1)),
        failure(2),
        case_ends(2, Verdict::Failed),
        decided_by(1, 2),
        case(3, "both", None),
        case(4, "inner", Some(3)),
        case_ends(4, Verdict::Failed),
        failure(3),
        decided_by(3, 4),
        case(5, "passed", None),
        report(5),
        case_ends(5, Verdict::Passed),
        case(6, "open", None),
        case(7, "open inside", Some(6)),
    ];
    let record = record(body(events));
    let attempt = &record.tests[0].attempts[0];
    let own = attempt.cases.kept().iter().map(|case| attempt.has_own_problem(case));
    let expected = [false, true, true, true, false, false, true];
    assert_eq!(own.collect::<Vec<_>>(), expected);
    let reported = (1..=5).map(|id| attempt.has_reported_problem(Some(CaseId(id))));
    assert_eq!(reported.collect::<Vec<_>>(), [false, true, true, false, false]);
    assert!(!attempt.has_reported_problem(None));
}

/// A host does not know the numbers that the runner adds to names that repeat.
#[test]
fn a_case_is_selected_by_the_name_that_its_host_knows() {
    let rows = [
        ("joint", "joint"),
        ("joint#2", "joint"),
        ("joint#12", "joint"),
        ("other#2", "other#2"),
        ("joint#", "joint#"),
        ("joint#2b", "joint#2b"),
        ("joint#2/arm", "joint/arm"),
        ("joint#2/arm#3", "joint/arm"),
        ("joint#2/leg#3", "joint/leg#3"),
        ("joint#2#3", "joint"),
    ];
    let events = (1..).zip(rows).flat_map(|(number, (name, _))| {
        [case(number, name, None), case_ends(number, Verdict::Passed)]
    });
    let record = record(body(events));
    let cases = &record.tests[0].attempts[0].cases;
    let selectable: Vec<_> =
        cases.kept().iter().map(|case| (&*case.path, cases.selectable_path(case))).collect();
    for ((path, selectable), (name, expected)) in selectable.iter().zip(rows) {
        assert_eq!((*path, selectable.as_str()), (name, expected));
    }
}

/// Memory stays bounded; nothing that did not pass is lost.
#[test]
fn passed_cases_beyond_a_limit_are_only_counted() {
    let mut record = Record::default();
    for event in stream(opened(1).into_iter().chain([started(1, 1)])) {
        record.apply(&event);
    }
    let most = u32::try_from(AttemptCases::PASSED_KEPT).unwrap();
    let events = (1..=most + 10).flat_map(|number| {
        let verdict = if number > most + 5 { Verdict::Failed } else { Verdict::Passed };
        [case(number, "pose", None), case_ends(number, verdict)]
    });
    stream(events).iter().for_each(|event| record.apply(event));
    let cases = &record.tests[0].attempts[0].cases;
    assert_eq!((cases.of(Verdict::Passed), cases.of(Verdict::Failed)), (100_005, 5));
    assert_eq!((cases.kept().len(), cases.omitted(), cases.total()), (100_005, 5, 100_010));
}

fn marked(expected: Option<ExpectedFailure>, verdict: Verdict) -> Record {
    let mut kinds = body([]);
    for kind in &mut kinds {
        if let EventKind::TestPlanned(TestPlanned { expected: mark, .. }) = kind {
            *mark = expected.clone().map(Box::new);
        }
        if let EventKind::TestFinished(end) = kind {
            end.verdict = verdict;
        }
    }
    record(kinds)
}

#[test]
fn known_failures_decide_which_verdicts_are_green() {
    use Significance::{Counts, Expected, Quarantined, SkippedItself, UnexpectedPass};
    use Verdict::{Crashed, Failed, Passed, Skipped};
    let expected = ExpectedFailure { verdicts: vec![Failed], ..ExpectedFailure::default() };
    let quarantined = ExpectedFailure { quarantined: true, ..expected.clone() };
    let expired = ExpectedFailure { expired: true, ..quarantined.clone() };
    let rows = [
        (None, [Counts, Counts, Counts], [true, false, false]),
        (Some(expected), [UnexpectedPass, Expected, Counts], [false, true, false]),
        (Some(quarantined), [Quarantined, Quarantined, Counts], [true, true, false]),
        (Some(expired), [Counts, Counts, Counts], [true, false, false]),
    ];
    for (mark, significances, greens) in rows {
        for (index, verdict) in [Passed, Failed, Crashed].into_iter().enumerate() {
            let record = marked(mark.clone(), verdict);
            assert_eq!(record.tests[0].significance(), significances[index], "{mark:?} {verdict}");
            assert_eq!(record.is_green(), greens[index], "{mark:?} {verdict}");
        }
        let record = marked(mark, Skipped);
        assert_eq!((record.tests[0].significance(), record.is_green()), (SkippedItself, true));
    }
}

#[test]
fn skips_are_red_where_the_suite_or_the_run_requests_it() {
    let skipped_case = [case(1, "a", None), case_ends(1, Verdict::Skipped)];
    for in_suite in [false, true] {
        let mut kinds = body(skipped_case.clone());
        assert!(record(kinds.clone()).is_green());
        for kind in &mut kinds {
            match kind {
                EventKind::SuitePlanned(plan) => plan.skips_fail = in_suite,
                EventKind::RunStarted(run) => run.manifest.no_skips = !in_suite,
                _ => {}
            }
        }
        assert!(!record(kinds).is_green());
    }
}

/// With `after-collapse="skip"`, the runner skips an attempt that it has stopped.
#[test]
fn a_test_that_the_runner_skips_is_not_green() {
    let (cause, reason) = (StopCause::Collapse, "gone".to_owned());
    let mut kinds = body([EventKind::TestStopping { test: TEST, cause, reason }]);
    for kind in &mut kinds {
        if let EventKind::TestFinished(end) = kind {
            end.verdict = Verdict::Skipped;
        }
    }
    let record = record(kinds);
    assert_eq!(record.tests[0].significance(), Significance::Counts);
    assert!(!record.is_green());
}

fn next_attempt(number: u32, name: &str, earlier_attempts: u32) -> EventKind {
    let start = CaseStart { earlier_attempts, ..CaseStart::new(CaseId(number), name.to_owned()) };
    EventKind::CaseStarted(Box::new(CaseStarted { test: TEST, start }))
}

fn is_rerun(number: u32, verdict: Verdict) -> EventKind {
    let EventKind::CaseFinished(end) = case_ends(number, verdict) else { panic!() };
    EventKind::CaseFinished(CaseFinished { rerun: true, ..end })
}

/// A case in a failed attempt, and another one.
fn retried() -> Vec<EventKind> {
    vec![
        case(1, "a", None),
        case(2, "subtest", Some(1)),
        case_ends(2, Verdict::Failed),
        is_rerun(1, Verdict::Failed),
        next_attempt(3, "a", 1),
        case_ends(3, Verdict::Passed),
        case(4, "b", None),
        case_ends(4, Verdict::Passed),
    ]
}

#[test]
fn the_last_attempt_of_a_case_counts() {
    check(&stream(body(retried()))).unwrap();
    let record = record(body(retried()));
    let test = &record.tests[0];
    let cases = &test.attempts[0].cases;
    let counts = [Verdict::Passed, Verdict::Failed].map(|verdict| cases.of(verdict));
    assert_eq!((counts, cases.problems(), cases.total(), cases.flaky()), ([2, 0], 0, 2, 1));
    let decisive: Vec<_> = cases.decisive().map(|case| case.start.case.0).collect();
    assert_eq!(decisive, [3, 4]);
    let flaky = cases.get(CaseId(3)).unwrap();
    let earlier: Vec<_> = cases.earlier_attempts(flaky).map(|case| case.start.case.0).collect();
    assert_eq!((flaky.is_flaky(), earlier), (true, vec![1]));
    assert!(test.is_flaky(), "although the runner did not retry the test");
}

#[test]
fn attempts_of_a_case_follow_one_another() {
    let twice = [case(1, "a", None), case_ends(1, Verdict::Failed), next_attempt(2, "a", 1)];
    assert!(check(&stream(body(twice))).unwrap_err().contains("not the next attempt"));
    let inner = [case(1, "a", None), case(2, "b", Some(1)), is_rerun(2, Verdict::Failed)];
    assert!(check(&stream(body(inner))).unwrap_err().contains("has another attempt"));
}
