//! Which streams of events are legal.

use crate::support::*;
use proptest::prelude::*;
use rtf_model::{
    Diagnostic, Event, EventKind, FixtureProvided, OrderChecker, Samples, Source, SuiteId,
    SuitePrepared, TestId, Trigger, Verdict,
};

pub fn check(events: &[Event]) -> Result<(), String> {
    let mut checker = OrderChecker::default();
    for event in events {
        checker.check(event).map_err(|error| error.to_string())?;
    }
    checker.finish().map_err(|error| error.to_string())
}

pub fn check_body(
    repetitions: u32,
    body: impl IntoIterator<Item = EventKind>,
) -> Result<(), String> {
    check(&stream(opened(repetitions).into_iter().chain(body).chain(closed())))
}

pub fn starting(attempt: u32) -> EventKind {
    EventKind::FixtureStarting { fixture: SIMULATOR, attempt }
}

pub fn ready() -> EventKind {
    EventKind::FixtureReady { fixture: SIMULATOR }
}

fn collapsed() -> EventKind {
    let reason = "gone".into();
    EventKind::FixtureCollapsed { fixture: SIMULATOR, reason, log_tail: Vec::new() }
}

pub fn stopping() -> EventKind {
    EventKind::FixtureStopping { fixture: SIMULATOR }
}

pub fn stopped() -> EventKind {
    EventKind::FixtureStopped { fixture: SIMULATOR, problem: None, log_tail: Vec::new() }
}

fn broken() -> EventKind {
    EventKind::FixtureBroken { fixture: SIMULATOR, reason: "gone".into() }
}

pub fn left(source: Source) -> EventKind {
    EventKind::ProcessesLeaked { source, processes: Vec::new() }
}

#[test]
fn a_run_with_a_collapse_and_a_rerun_is_legal() {
    let body = [
        starting(1),
        ready(),
        started(1, 1),
        collapsed(),
        rerun(Verdict::Collapsed),
        stopping(),
        stopped(),
        starting(2),
        ready(),
        started(1, 2),
        finished(Verdict::Passed),
        stopping(),
        stopped(),
    ];
    assert_eq!(check_body(1, body), Ok(()));
}

#[test]
fn a_fixture_that_breaks_and_a_test_that_is_skipped_are_legal() {
    let body = [starting(1), stopping(), stopped(), broken(), skipped(0)];
    assert_eq!(check_body(1, body), Ok(()));
    let breaks_early =
        [starting(1), ready(), collapsed(), broken(), stopping(), stopped(), skipped(0)];
    assert_eq!(check_body(1, breaks_early), Ok(()));
}

#[test]
fn what_is_left_of_the_repetitions_may_be_skipped() {
    let once = [started(1, 1), finished(Verdict::Failed), skipped(0)];
    assert_eq!(check_body(3, once), Ok(()));
    let rerun_is_skipped = [started(1, 1), rerun(Verdict::Collapsed), skipped(0)];
    assert_eq!(check_body(1, rerun_is_skipped), Ok(()));
}

#[test]
fn a_timed_test_is_repeated_until_it_is_told_to_be_over() {
    let timed = |body: Vec<EventKind>| {
        let mut kinds = opened(1);
        if let Some(EventKind::TestPlanned(plan)) = kinds.iter_mut().rev().nth(1) {
            plan.timed = true;
        }
        check(&stream(kinds.into_iter().chain(body).chain(closed())))
    };
    let over = |repetitions| EventKind::TestRepeated { test: TestId(0), repetitions };
    let passed = || finished(Verdict::Passed);
    let twice = || vec![started(1, 1), passed(), started(2, 1), passed()];
    let and = |mut body: Vec<EventKind>, more: &[EventKind]| {
        body.extend_from_slice(more);
        timed(body)
    };
    assert_eq!(and(twice(), &[over(2)]), Ok(()));
    assert_eq!(timed(twice()), Err("event 9: test 0 has no verdict".to_owned()));
    let wrong = and(twice(), &[over(3)]);
    assert_eq!(wrong, Err("event 9: test 0 was not repeated 3 times".to_owned()));
    let ends_here = |seq| Err(format!("event {seq}: test 0 cannot end here"));
    assert_eq!(and(twice(), &[over(2), over(2)]), ends_here(10));
    assert_eq!(timed(vec![started(1, 1), over(1)]), ends_here(6));
    assert_eq!(timed(vec![started(1, 1), rerun(Verdict::Failed), over(1)]), ends_here(7));
    assert_eq!(check_body(2, [started(1, 1), passed(), over(1)]), ends_here(7));
    let again = "event 10: test 0 started although it was skipped or has ended";
    assert_eq!(and(twice(), &[over(2), started(3, 1)]), Err(again.to_owned()));
}

#[test]
fn a_suite_does_not_finish_before_each_test_has_its_last_word() {
    let wanted = Err("event 7: test 0 has no verdict".to_owned());
    assert_eq!(check_body(3, [started(1, 1), finished(Verdict::Passed)]), wanted);
    assert_eq!(check_body(1, [started(1, 1), rerun(Verdict::Collapsed)]), wanted);
    assert_eq!(check_body(1, []), Err("event 5: test 0 has no verdict".to_owned()));
    assert_eq!(check_body(1, [started(1, 1)]), Err("event 6: test 0 still runs".to_owned()));
}

#[test]
fn attempts_and_repetitions_follow_what_the_last_end_announced() {
    let wrong = |repetitions, next: EventKind, end: EventKind| {
        check_body(repetitions, [started(1, 1), end, next]).expect_err("out of order")
    };
    let out_of_order = "event 7: test 0: repetition or attempt out of order";
    assert_eq!(wrong(2, started(1, 2), finished(Verdict::Failed)), out_of_order);
    assert_eq!(wrong(2, started(2, 1), rerun(Verdict::Collapsed)), out_of_order);
    assert_eq!(wrong(3, started(3, 1), finished(Verdict::Passed)), out_of_order);
    assert_eq!(
        wrong(1, started(2, 1), finished(Verdict::Passed)),
        "event 7: test 0: more repetitions than planned"
    );
}

#[test]
fn a_fixture_goes_through_its_states_in_order() {
    let wrong = |body: &[EventKind]| check_body(1, body.to_vec()).expect_err("out of order");
    assert_eq!(wrong(&[ready()]), "event 5: fixture 0 goes from Stopped to Ready");
    assert_eq!(
        wrong(&[starting(1), collapsed()]),
        "event 6: fixture 0 goes from Starting to Collapsed"
    );
    assert_eq!(
        wrong(&[starting(1), stopped()]),
        "event 6: fixture 0 goes from Starting to Stopped"
    );
    assert_eq!(wrong(&[starting(2)]), "event 5: fixture 0: attempt out of order");
    assert_eq!(wrong(&[starting(1), starting(2)]), "event 6: fixture 0 started twice");
    assert_eq!(wrong(&[broken(), starting(1)]), "event 6: fixture 0 started although broken");
    assert_eq!(wrong(&[broken(), broken()]), "event 6: fixture 0 broke twice");
    assert_eq!(wrong(&[starting(1), skipped(0)]), "event 7: fixture 0 still runs",);
}

#[test]
fn a_fixture_provides_each_value_once_in_each_set_up() {
    let wrong = |body: &[EventKind]| check_body(1, body.to_vec()).expect_err("out of order");
    let provided = |name: &str| {
        let (fixture, name) = (SIMULATOR, name.to_owned());
        let (value, secret) = (Some(1.into()), false);
        EventKind::FixtureProvided(FixtureProvided { fixture, name, value, secret })
    };
    let twice = [starting(1), provided("port"), provided("pid"), provided("port")];
    assert_eq!(wrong(&twice), "event 8: fixture 0 provided `port` twice");
    let late = [starting(1), ready(), provided("port")];
    assert_eq!(wrong(&late), "event 7: fixture 0 is not being set up");
    let restarted = [
        starting(1),
        provided("port"),
        ready(),
        stopping(),
        stopped(),
        starting(2),
        provided("port"),
        ready(),
        provided("pid"),
    ];
    assert_eq!(wrong(&restarted), "event 13: fixture 0 is not being set up");
}

#[test]
fn what_a_test_or_fixture_says_lies_between_its_start_and_its_end() {
    let wrong = |body: &[EventKind]| check_body(1, body.to_vec()).expect_err("out of order");
    assert_eq!(wrong(&[left(Source::Test(TEST))]), "event 5: test 0 is not running");
    assert_eq!(wrong(&[left(Source::Fixture(SIMULATOR))]), "event 5: fixture 0 is not running");
    let late = [started(1, 1), finished(Verdict::Passed), left(Source::Test(TEST))];
    assert_eq!(wrong(&late), "event 7: test 0 is not running");
    let after = [skipped(0), started(1, 1)];
    assert_eq!(wrong(&after), "event 6: test 0 started although it was skipped or has ended");
    assert_eq!(wrong(&[skipped(0), skipped(0)]), "event 6: test 0 skipped twice, or after its end");
    assert_eq!(wrong(&[started(1, 1), skipped(0)]), "event 6: test 0 skipped while it runs");
}

#[test]
fn plans_come_first_and_in_order() {
    let wrong = |kinds: &[EventKind]| check(&stream(kinds.to_vec())).expect_err("out of order");
    assert_eq!(wrong(&[suite(0)]), "event 0: run-started comes first and only once");
    assert_eq!(
        wrong(&[run_started(), run_started()]),
        "event 1: run-started comes first and only once"
    );
    assert_eq!(wrong(&[run_started(), suite(1)]), "event 1: suite 1 out of order");
    assert_eq!(wrong(&[run_started(), suite(0), test(1, 0, 1)]), "event 2: test 1 out of order");
    assert_eq!(
        wrong(&[run_started(), suite(0), suite(1), test(0, 0, 1)]),
        "event 3: suite 0 is not the one planned last"
    );
    let mut late = opened(1);
    late.push(suite(1));
    assert_eq!(wrong(&late), "event 5: plans precede the start of the first suite");
}

#[test]
fn the_end_is_the_end() {
    let [suite_finished, run_finished] = closed();
    let wrong = |kinds: &[EventKind]| check(&stream(kinds.to_vec())).expect_err("out of order");
    assert_eq!(
        wrong(&[run_started(), suite(0), run_finished.clone()]),
        "event 2: suite 0 did not finish"
    );
    assert_eq!(
        wrong(&[run_started()]),
        "event 1: the stream ends with neither run-finished nor runner-died"
    );
    assert_eq!(
        wrong(&[run_started(), run_finished.clone(), run_finished]),
        "event 2: nothing follows run-finished or runner-died"
    );
    assert_eq!(wrong(&[run_started(), suite_finished]), "event 1: suite 0 is not running");
}

#[test]
fn numbers_have_no_gaps_and_time_does_not_run_backwards() {
    let mut events = stream([run_started(), suite(0)]);
    events[1].seq = 2;
    assert_eq!(check(&events), Err("event 2: expected number 1".to_owned()));
    let mut events = stream([run_started(), suite(0)]);
    events[0].at.0 = 5000;
    assert_eq!(check(&events), Err("event 1: time runs backwards".to_owned()));
}

fn sampled() -> EventKind {
    let name = "elbow".to_owned();
    let (unit, low, high, location, points) = (String::new(), None, None, None, Vec::new());
    EventKind::Sampled {
        test: TEST,
        samples: Samples { name, unit, low, high, location, points, case: None, since: None },
    }
}

#[test]
fn a_test_samples_while_it_runs() {
    let mut kinds = opened(1);
    let early = [kinds.clone(), vec![sampled()]].concat();
    assert_eq!(check(&stream(early)), Err("event 5: test 0 is not running".to_owned()));
    kinds.extend([started(1, 1), sampled(), finished(Verdict::Passed)]);
    kinds.extend(closed());
    assert_eq!(check(&stream(kinds)), Ok(()));
}

fn any_kind() -> impl Strategy<Value = EventKind> {
    let (id, number) = (0..3_u32, 1..4_u32);
    prop_oneof![
        Just(run_started()),
        id.clone().prop_map(suite),
        (id.clone(), id.clone()).prop_map(|(f, s)| fixture(f, s)),
        (id.clone(), id.clone(), number.clone()).prop_map(|(t, s, n)| test(t, s, n)),
        (number.clone(), number).prop_map(|(r, a)| started(r, a)),
        Just(finished(Verdict::Passed)),
        Just(rerun(Verdict::Collapsed)),
        Just(sampled()),
        id.clone().prop_map(skipped),
        Just(EventKind::SuiteStarted { suite: SUITE }),
        Just(starting(1)),
        Just(collapsed()),
        Just(stopped()),
        (id.clone(), id.clone()).prop_map(|(h, s)| hook(h, s)),
        Just(hook_started(Trigger::Collapse)),
        Just(hook_finished(Some("no power"))),
        Just(left(Source::Hook(PARK))),
        Just(runner_died()),
        Just(closed()[0].clone()),
        Just(closed()[1].clone()),
    ]
}

proptest! {
    /// A damaged journal may hold anything: neither the checker nor the record gives up.
    #[test]
    fn no_stream_makes_the_checker_or_the_record_panic(
        kinds in proptest::collection::vec(any_kind(), 0..40),
    ) {
        let mut checker = OrderChecker::default();
        let mut record = rtf_model::Record::default();
        for event in stream(kinds) {
            let _verdict_on_the_order = checker.check(&event);
            record.apply(&event);
        }
        let totals = record.final_totals();
        prop_assert_eq!(totals.done() as usize, record.tests.len());
        prop_assert!(!record.is_green() || record.is_complete());
    }
}

fn prepared(suite: u32) -> EventKind {
    EventKind::SuitePrepared(SuitePrepared {
        suite: SuiteId(suite),
        network: None,
        ports: Vec::new(),
        variables: Vec::new(),
        join_command: String::new(),
    })
}

#[test]
fn a_suite_is_prepared_once_and_before_anything_of_it() {
    let warning = || EventKind::Warning { diagnostic: Diagnostic::warning("w", "careful") };
    let test = || [started(1, 1), finished(Verdict::Passed)];
    let legal = [warning(), prepared(0), warning()].into_iter().chain(test());
    assert_eq!(check_body(1, legal), Ok(()));
    let rule = |body: Vec<EventKind>| check_body(1, body).unwrap_err();
    for body in [
        vec![prepared(0), prepared(0)],
        vec![prepared(1)],
        [vec![starting(1)], vec![prepared(0)]].concat(),
        [test().to_vec(), vec![prepared(0)]].concat(),
    ] {
        let told = rule(body);
        assert!(told.ends_with("is prepared once, before anything else of it"), "{told}");
    }
}

#[test]
fn suites_may_run_side_by_side() {
    let [first, second] = [0, 1].map(SuiteId);
    let plans = || [run_started(), suite(0), test(0, 0, 1), suite(1), test(1, 1, 1)];
    let both = |suite| EventKind::SuiteStarted { suite };
    let end = |suite| EventKind::SuiteFinished { suite };
    let over = || EventKind::RunFinished { interrupted: None };
    let test = || [started(1, 1), finished(Verdict::Passed)];
    let check_body =
        |body: Vec<EventKind>| check(&stream(plans().into_iter().chain(body).chain([over()])));
    let starts = || vec![both(first), both(second)];
    let legal = [
        starts(),
        // Each is prepared before its other events.
        vec![prepared(1), prepared(0)],
        test().to_vec(),
        vec![skipped(1), end(second), end(first)],
    ];
    assert_eq!(check_body(legal.concat()), Ok(()));
    let late = [starts(), test().to_vec(), vec![prepared(1), prepared(0)]];
    let told = check_body(late.concat()).unwrap_err();
    assert!(told.ends_with("suite 0 is prepared once, before anything else of it"), "{told}");
    let open = [starts(), test().to_vec(), vec![end(first), skipped(1)]];
    let told = check_body(open.concat()).unwrap_err();
    assert!(told.ends_with("suite 1 did not finish"), "{told}");
    let early = [vec![both(first)], test().to_vec(), vec![skipped(1)]];
    let told = check_body(early.concat()).unwrap_err();
    assert!(told.ends_with("suite 1 is not running"), "{told}");
}
