//! After a collapse, finished cases are carried to the next attempt, and the others run.

mod random;

use insta::assert_snapshot;
use rtf_model::protocol::{CaseSelector, Reply, Request};
use rtf_model::{AttemptRecord, MessageKind, Outcome, Phase, Verdict};
use rtf_plan::plan::{AfterCollapse, CasesInPrograms, SuitePlan};
use rtf_process::codec::INITIALIZE;
use serde_json::json;

use super::world::{FIXTURE, SECOND, TEST, World, suite};
use crate::run::machine::ProcessEvent;

fn rerun() -> SuitePlan {
    let mut plan = suite(1, 1);
    plan.fixtures[0].restarts = 20;
    plan.tests[0].settings.after_collapse = AfterCollapse::Rerun;
    plan.tests[0].cases_in_programs = Some(Box::new(CasesInPrograms::default()));
    plan
}

impl<'p> World<'p> {
    /// The first attempt runs, and its host can select cases.
    fn running_cases(plan: &'p SuitePlan) -> Self {
        let mut world = Self::running(plan);
        world.initialized(true);
        world
    }

    fn initialized(&mut self, selects_cases: bool) {
        let value = json!({ "protocol": 1, "host": "scratch 1", "selects_cases": selects_cases });
        self.input(TEST, ProcessEvent::Replied(INITIALIZE, Reply::Result(value)));
    }

    /// A case passes, long before anything else happens.
    fn passes(&mut self, case: u32, name: &str) {
        self.case(case, name, None);
        self.case_ends(case);
        self.now += SECOND;
    }

    /// The fixture collapses, the test stops, and the next attempt is about to run cases.
    fn collapse_and_rerun(&mut self) {
        self.collapse_and_restart();
        self.initialized(true);
        self.phase(TEST, Phase::Run);
    }

    fn collapse_and_restart(&mut self) {
        self.collapse(FIXTURE, "gone");
        self.end(TEST, "interrupted");
        self.restart_fixture();
    }

    fn restart_fixture(&mut self) {
        self.tear_down(0);
        while self.hosts.is_empty() {
            self.next_deadline();
        }
        self.ready(1);
    }

    fn end_suite(&mut self, outcome: &str) {
        self.end_attempt(outcome);
        self.tear_down(0);
        self.finish();
    }

    /// The test ends. One that did not pass waits for a collapse.
    fn end_attempt(&mut self, outcome: &str) {
        self.end(TEST, outcome);
        while self.last_attempt().finished.is_none() {
            self.next_deadline();
        }
    }

    /// The paths that the last attempt selects, as `equals`.
    fn selected(&self) -> Vec<&str> {
        let mut plugins = self.sent.iter().filter_map(|(_, _, request)| match request {
            Request::RunTest(plugin) => Some(plugin),
            _ => None,
        });
        let cases = plugins.next_back().map(|plugin| plugin.cases.iter()).expect("a request");
        cases
            .map(|selector| match selector {
                CaseSelector::Equals(path) => path.as_str(),
                CaseSelector::Contains(_) => panic!("not by text"),
            })
            .collect()
    }

    fn last_attempt(&self) -> &AttemptRecord {
        self.record.tests[0].attempts.last().expect("an attempt")
    }

    /// The paths of the cases of the last attempt; carried ones in parentheses.
    fn paths(&self) -> Vec<String> {
        let kept = self.last_attempt().cases.kept().iter();
        kept.map(|case| match case.is_carried() {
            true => format!("({})", case.path),
            false => case.path.clone(),
        })
        .collect()
    }
}

#[test]
fn finished_cases_are_carried_and_the_others_run_again() {
    let plan = rerun();
    let mut world = World::running_cases(&plan);
    world.plan_cases(&["a", "b", "c"]);
    world.case(1, "a", None);
    world.now += SECOND;
    world.case_ends(1);
    world.now += SECOND;
    world.case(2, "b", None);
    world.restart_transcript();
    world.collapse_and_rerun();
    assert_eq!(world.selected(), ["b", "c"]);
    world.plan_cases(&["b", "c"]);
    world.case(1, "b", None);
    world.message_in(1, MessageKind::Check, "moves");
    world.case_ends(1);
    world.passes(2, "c");
    world.end(TEST, "passed");
    assert_snapshot!(world.transcript(), @"
    2.0  fixture-collapsed fixture=0 reason=gone
    2.0  test-stopping cause=collapse reason=fixture `fixture0` collapsed: gone test=0
    2.0    → close the channel
    2.0  case-finished case=2 reason=fixture `fixture0` collapsed: gone test=0 verdict=collapsed
    2.0  test-finished decided_by=2 exit={code:0} phase=run reason=fixture `fixture0` collapsed: gone rerun=true test=0 verdict=collapsed
    2.0  fixture-stopping fixture=0
    2.0    → close the channel
    2.0  fixture-stopped fixture=0
    2.0  fixture-starting attempt=2 fixture=0
    2.0  fixture-ready fixture=0
    2.0  test-started attempt=2 repetition=1 test=0
    2.0  case-started case=1 name=a test=0
    2.0  case-finished carried=true case=1 duration_us=1000000 test=0 verdict=passed
    2.0  test-phase phase=run test=0
    2.0  case-started case=2 name=b test=0
    2.0  message source={test:0}
    2.0  case-finished case=2 test=0 verdict=passed
    2.0  case-started case=3 name=c test=0
    2.0  case-finished case=3 test=0 verdict=passed
    3.0    → close the channel
    3.0  test-finished exit={code:0} phase=exit test=0 verdict=passed
    3.0  fixture-stopping fixture=0
    ");
    assert_eq!(world.paths(), ["(a)", "b", "c"]);
    assert_eq!(world.last_attempt().cases.kept()[0].duration(), Some(SECOND));
    assert_eq!(world.last_attempt().cases.total(), 3);
    world.tear_down(0);
    world.finish();
    assert_eq!(world.verdict(), (Verdict::Passed, None));
}

#[test]
fn a_carried_problem_decides_the_verdict() {
    let plan = rerun();
    let mut world = World::running_cases(&plan);
    world.plan_cases(&["a", "b"]);
    world.case(1, "a", None);
    world.message_in(1, MessageKind::Failure, "the elbow sticks");
    world.case_ends(1);
    world.now += SECOND;
    world.case(2, "b", None);
    world.collapse_and_rerun();
    assert_eq!(world.selected(), ["b"]);
    world.passes(1, "b");
    world.end_suite("passed");
    assert_eq!(world.verdict(), (Verdict::Failed, Some("case `a`: the elbow sticks")));
    let (_, finished) = world.last_attempt().finished.as_ref().unwrap();
    assert_eq!(finished.decided_by, Some(rtf_model::CaseId(1)));
}

/// A connection breaks before the kernel reports the death at its other end, and a case may
/// pass without the fixture.
#[test]
fn a_case_just_before_the_collapse_is_not_carried() {
    let plan = rerun();
    let (failed, times) = (Some(Outcome::Failed), [(200, &["b", "c"][..]), (201, &["c"])]);
    let cases = [failed, None].into_iter().flat_map(|outcome| times.map(|time| (outcome, time)));
    for (outcome, (millis, selected)) in cases {
        let mut world = World::running_cases(&plan);
        world.plan_cases(&["a", "b", "c"]);
        world.passes(1, "a");
        world.case(2, "b", None);
        world.case_ends_with(2, outcome, Some("no connection"));
        world.now += std::time::Duration::from_millis(millis);
        world.collapse_and_rerun();
        assert_eq!(world.selected(), selected, "{outcome:?}, {millis} ms");
    }
}

#[test]
fn if_all_cases_have_finished_the_last_one_runs_again() {
    let plan = rerun();
    let mut world = World::running_cases(&plan);
    world.plan_cases(&["a", "b", "c"]);
    world.passes(1, "a");
    world.case(2, "b", None);
    world.case(3, "c", None);
    world.case_ends(3);
    world.case_ends(2);
    world.now += SECOND;
    world.hides_liveness = true;
    world.end(TEST, "passed");
    world.collapse(FIXTURE, "gone");
    world.hides_liveness = false;
    world.restart_fixture();
    assert_eq!(world.selected(), ["b"]);
    assert_eq!(world.paths(), ["(a)", "(c)"]);
    world.phase(TEST, Phase::Run);
    world.passes(1, "b");
    world.end_suite("passed");
    assert_eq!(world.verdict(), (Verdict::Passed, None));
}

#[test]
fn all_cases_run_again_if_names_do_not_identify_those_that_are_left() {
    type Step = fn(&mut World<'_>);
    let steps: [(&str, Step); 7] = [
        ("no plan", |world| world.passes(1, "a")),
        ("an unplanned case", |world| {
            world.plan_cases(&["a", "b"]);
            world.passes(1, "a");
            world.case(2, "x", None);
        }),
        ("a late plan", |world| {
            world.plan_cases(&["a"]);
            world.passes(1, "a");
            world.plan_cases(&["b"]);
        }),
        ("a name planned twice", |world| {
            world.plan_cases(&["a", "b", "b"]);
            world.passes(1, "a");
        }),
        ("a name that started twice", |world| {
            world.plan_cases(&["a", "b"]);
            world.passes(1, "a");
            world.passes(2, "a");
        }),
        ("a name that looks like that of an inner case", |world| {
            world.plan_cases(&["a", "a/b", "c"]);
            world.passes(1, "a");
        }),
        ("a name that looks like that of an outer case", |world| {
            world.plan_cases(&["a/b/c", "a/b"]);
            world.passes(1, "a/b/c");
        }),
    ];
    let plan = rerun();
    for (what, step) in steps {
        let mut world = World::running_cases(&plan);
        step(&mut world);
        world.collapse_and_rerun();
        assert_eq!((world.selected(), world.paths()), (vec![], vec![]), "{what}");
    }
}

#[test]
fn other_tests_run_all_cases_again() {
    let mut without_programs = rerun();
    without_programs.tests[0].cases_in_programs = None;
    for (plan, selects_cases) in [(&without_programs, true), (&rerun(), false)] {
        let mut world = World::running(plan);
        world.initialized(selects_cases);
        world.plan_cases(&["a", "b"]);
        world.passes(1, "a");
        world.collapse_and_rerun();
        assert_eq!((world.selected(), world.paths()), (vec![], vec![]));
    }
}

#[test]
fn inner_cases_are_carried_with_new_numbers() {
    let plan = rerun();
    let mut world = World::running_cases(&plan);
    world.plan_cases(&["a", "b", "c"]);
    world.case(1, "a", None);
    world.case(2, "b", None);
    world.case(3, "in b", Some(2));
    world.case(4, "in a", Some(1));
    world.case(5, "c", None);
    world.case(6, "deep", Some(3));
    world.message_in(6, MessageKind::Failure, "too deep");
    for case in [4, 6, 3, 2] {
        world.case_ends(case);
    }
    world.now += SECOND;
    world.collapse_and_rerun();
    assert_eq!(world.selected(), ["a", "c"]);
    assert_eq!(world.paths(), ["(b)", "(b/in b)", "(b/in b/deep)"]);
    let ids = world.last_attempt().cases.kept().iter().map(|case| {
        let (_, end) = case.finished.as_ref().unwrap();
        (end.case.0, end.decided_by.map(|case| case.0), case.start.parent.map(|case| case.0))
    });
    assert_eq!(
        ids.collect::<Vec<_>>(),
        [(1, Some(3), None), (2, Some(3), Some(1)), (3, None, Some(2))]
    );
    world.case(1, "a", None);
    world.case(2, "in a", Some(1));
    world.message_in(2, MessageKind::Report, "hello");
    world.case_ends(2);
    world.case_ends(1);
    world.passes(3, "c");
    world.end_suite("passed");
    assert_eq!(world.paths()[3..], ["a", "a/in a", "c"]);
    assert_eq!(world.last_attempt().messages[0].case, Some(rtf_model::CaseId(5)));
    assert_eq!(world.verdict(), (Verdict::Failed, Some("case `b/in b/deep`: too deep")));
}

#[test]
fn cases_stay_carried_through_further_collapses() {
    let plan = rerun();
    let mut world = World::running_cases(&plan);
    world.plan_cases(&["a", "b", "c"]);
    world.case(1, "a", None);
    world.now += SECOND;
    world.case_ends(1);
    world.now += SECOND;
    // The second one comes before the host has done anything.
    world.collapse_and_restart();
    world.collapse_and_rerun();
    assert_eq!(world.selected(), ["b", "c"]);
    world.plan_cases(&["b", "c"]);
    world.passes(1, "b");
    world.collapse_and_rerun();
    assert_eq!(world.selected(), ["c"]);
    world.passes(1, "c");
    world.end_suite("passed");
    assert_eq!(world.paths(), ["(a)", "(b)", "c"]);
    assert_eq!(world.last_attempt().cases.kept()[0].duration(), Some(SECOND));
    assert_eq!(world.verdict(), (Verdict::Passed, None));
}

#[test]
fn a_retry_after_a_failure_runs_all_cases() {
    let mut plan = rerun();
    plan.tests[0].settings.retries.count = 1;
    let mut world = World::running_cases(&plan);
    world.plan_cases(&["a", "b"]);
    world.passes(1, "a");
    world.collapse_and_rerun();
    world.case(1, "b", None);
    world.case_ends_with(1, Some(Outcome::Failed), Some("slow"));
    world.end_attempt("failed");
    world.answer(FIXTURE, "passed");
    assert_eq!(world.last_attempt().attempt, 3);
    assert_eq!((world.selected(), world.paths()), (vec![], vec![]));
}

#[test]
fn a_test_whose_last_cases_are_skipped_has_passed_if_a_carried_one_has() {
    let plan = rerun();
    for (outcome, verdict) in [(None, Verdict::Passed), (Some(Outcome::Skipped), Verdict::Skipped)]
    {
        let mut world = World::running_cases(&plan);
        world.plan_cases(&["a", "b"]);
        world.case(1, "a", None);
        world.case_ends_with(1, outcome, None);
        world.now += SECOND;
        world.collapse_and_rerun();
        world.case(1, "b", None);
        world.case_ends_with(1, Some(Outcome::Skipped), Some("no gripper"));
        world.end_suite("skipped");
        assert_eq!(world.verdict().0, verdict);
    }
}

#[test]
fn a_host_that_no_longer_selects_cases_is_an_error() {
    let plan = rerun();
    let mut world = World::running_cases(&plan);
    world.plan_cases(&["a", "b"]);
    world.passes(1, "a");
    world.collapse_and_restart();
    world.initialized(false);
    world.end_suite("interrupted");
    assert_eq!(world.verdict(), (Verdict::Error, Some("scratch 1 cannot select cases")));
}
