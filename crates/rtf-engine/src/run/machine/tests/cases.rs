//! Cases inside a test: their verdicts, and those that a test leaves open.

use insta::assert_snapshot;
use rtf_model::protocol::Notification;
use rtf_model::{
    CaseId, CaseRecord, CaseStart, ExitStatus, Message, MessageKind, Outcome, Phase, Verdict,
};
use rtf_plan::plan::SuitePlan;

use super::world::{TEST, World, suite};
use crate::run::machine::{ProcessEvent, StopLevel};

impl World<'_> {
    pub(super) fn notified(&mut self, notification: Notification) {
        self.input(TEST, ProcessEvent::Notified(notification));
    }

    pub(super) fn case(&mut self, case: u32, name: &str, parent: Option<u32>) {
        let (case, parent) = (CaseId(case), parent.map(CaseId));
        let name = name.to_owned();
        let start = CaseStart { parent, ..CaseStart::new(case, name) };
        self.notified(Notification::CaseStarted(start));
    }

    pub(super) fn case_ends(&mut self, case: u32) {
        self.case_ends_with(case, None, None);
    }

    pub(super) fn case_ends_with(
        &mut self,
        case: u32,
        outcome: Option<Outcome>,
        reason: Option<&str>,
    ) {
        let reason = reason.map(str::to_owned);
        self.notified(Notification::CaseFinished {
            case: CaseId(case),
            outcome,
            reason,
            duration_us: None,
            rerun: false,
            episode: None,
        });
    }

    /// A case ends with this outcome, and its framework runs it again.
    pub(super) fn case_is_rerun(&mut self, case: u32, outcome: Outcome) {
        let (case, outcome, reason) = (CaseId(case), Some(outcome), Some("no".to_owned()));
        let (duration_us, rerun) = (None, true);
        let end =
            Notification::CaseFinished { case, outcome, reason, duration_us, rerun, episode: None };
        self.notified(end);
    }

    pub(super) fn message_in(&mut self, case: u32, kind: MessageKind, text: &str) {
        let (text, case) = (text.to_owned(), Some(CaseId(case)));
        let (location, comparison) = (None, None);
        let message =
            Message { kind, text, location, comparison, critical: false, case, interval: None };
        self.notified(Notification::Message(message));
    }

    pub(super) fn plan_cases(&mut self, names: &[&str]) {
        let names = names.iter().map(|name| (*name).to_owned()).collect();
        self.notified(Notification::CasesPlanned { names });
    }

    pub(super) fn verdict(&self) -> (Verdict, Option<&str>) {
        let test = &self.record.tests[0];
        (test.final_verdict(), test.reason())
    }

    pub(super) fn over(&mut self) {
        self.end(TEST, "passed");
        self.finish();
    }
}

fn one_test() -> SuitePlan {
    suite(0, 1)
}

#[test]
fn a_failure_in_a_case_fails_the_case_and_the_test() {
    let plan = one_test();
    let mut world = World::running(&plan);
    world.case(1, "joint 0", None);
    world.case_ends(1);
    world.case(2, "joint 1", None);
    world.message_in(2, MessageKind::Failure, "joint 1 moves");
    world.message_in(2, MessageKind::Failure, "a second one");
    world.case_ends(2);
    world.case(3, "joint 2", None);
    world.case_ends(3);
    world.end(TEST, "failed");
    world.finish();
    assert_snapshot!(world.transcript(), @"
    0.0  case-started case=1 name=joint 0 test=0
    0.0  case-finished case=1 test=0 verdict=passed
    0.0  case-started case=2 name=joint 1 test=0
    0.0  message source={test:0}
    0.0  message source={test:0}
    0.0  case-finished case=2 reason=joint 1 moves test=0 verdict=failed
    0.0  case-started case=3 name=joint 2 test=0
    0.0  case-finished case=3 test=0 verdict=passed
    0.0    → close the channel
    0.0  test-finished decided_by=2 exit={code:0} phase=run reason=case `joint 1`: joint 1 moves test=0 verdict=failed
    0.0  suite-finished
    ");
}

#[test]
fn a_case_is_as_bad_as_the_worst_case_in_it() {
    let plan = one_test();
    let mut world = World::running(&plan);
    world.case(1, "Arm", None);
    world.message_in(1, MessageKind::Failure, "not calibrated");
    world.case(2, "Moves", Some(1));
    world.message_in(2, MessageKind::Error, "no encoder");
    world.case_ends(2);
    world.case_ends(1);
    world.over();
    let cases = world.record.tests[0].attempts[0].cases.kept();
    let results: Vec<_> = cases.iter().map(|c| (&*c.path, c.verdict(), c.reason())).collect();
    assert_eq!(
        results,
        [
            ("Arm", Some(Verdict::Error), Some("case `Arm/Moves`: no encoder")),
            ("Arm/Moves", Some(Verdict::Error), Some("no encoder")),
        ]
    );
    assert_eq!(world.verdict(), (Verdict::Error, Some("case `Arm/Moves`: no encoder")));
}

#[test]
fn between_equal_verdicts_the_problem_of_the_test_decides() {
    let plan = one_test();
    let mut world = World::running(&plan);
    world.case(1, "arm", None);
    world.message_in(1, MessageKind::Failure, "it moves");
    world.case_ends(1);
    world.failure(TEST, "the robot is warm", false);
    world.over();
    assert_eq!(world.verdict(), (Verdict::Failed, Some("the robot is warm")));
}

#[test]
fn a_skipped_case_leaves_the_test_passed() {
    let plan = one_test();
    let mut world = World::running(&plan);
    world.case(1, "gripper", None);
    world.case_ends_with(1, Some(Outcome::Skipped), Some("no gripper"));
    world.over();
    assert_eq!(world.verdict(), (Verdict::Passed, None));
    assert!(world.record.is_green());
    assert_eq!(world.record.tests[0].attempts[0].cases.of(Verdict::Skipped), 1);
}

#[test]
fn a_test_that_skips_itself_is_green() {
    let plan = one_test();
    let mut world = World::running(&plan);
    world.end(TEST, "skipped");
    world.finish();
    assert_eq!(world.verdict(), (Verdict::Skipped, Some("says skipped")));
    assert!(world.record.is_green());
}

#[test]
fn a_failure_has_precedence_over_a_skip() {
    let plan = one_test();
    let mut world = World::running(&plan);
    world.failure(TEST, "the gripper is open", false);
    world.end(TEST, "skipped");
    world.finish();
    assert_eq!(world.verdict(), (Verdict::Failed, Some("the gripper is open")));
}

#[test]
fn a_crash_closes_the_open_cases_and_leaves_planned_ones_not_run() {
    let plan = one_test();
    let mut world = World::running(&plan);
    world.plan_cases(&["a", "b", "c", "b"]);
    world.case(1, "a", None);
    world.case_ends(1);
    world.case(2, "b", None);
    world.case(3, "inner", Some(2));
    world.exit(TEST, ExitStatus::Signal(11));
    world.finish();
    let cases = &world.record.tests[0].attempts[0].cases;
    let reason = "the test's process ended in case `b/inner` with signal 11 (SIGSEGV) before the test was over";
    let results: Vec<_> =
        cases.kept().iter().map(|c| (&*c.path, c.verdict(), c.reason())).collect();
    let crashed = (Some(Verdict::Crashed), Some(reason));
    assert_eq!(
        results,
        [
            ("a", Some(Verdict::Passed), None),
            ("b", crashed.0, crashed.1),
            ("b/inner", crashed.0, crashed.1),
        ]
    );
    assert_eq!(world.verdict(), (Verdict::Crashed, Some(reason)));
    assert_eq!(cases.not_run().names().collect::<Vec<_>>(), ["c", "b#2"]);
    let decided_by = |case: &CaseRecord| case.finished.as_ref().and_then(|(_, end)| end.decided_by);
    let inner = Some(CaseId(3));
    assert_eq!(cases.kept().iter().map(decided_by).collect::<Vec<_>>(), [None, inner, None]);
    let (_, finished) = world.record.tests[0].attempts[0].finished.as_ref().unwrap();
    assert_eq!(finished.decided_by, inner);
}

#[test]
fn a_stopped_test_closes_its_cases_with_the_verdict() {
    let plan = one_test();
    let mut world = World::running(&plan);
    world.case(1, "a", None);
    world.stop(StopLevel::TearDown);
    world.message_in(1, MessageKind::Failure, "stopped in the middle");
    world.end(TEST, "interrupted");
    world.finish();
    let case = &world.record.tests[0].attempts[0].cases.kept()[0];
    assert_eq!(case.verdict(), Some(Verdict::Interrupted));
}

#[test]
fn a_test_that_ends_before_its_case_is_an_error() {
    let plan = one_test();
    let mut world = World::running(&plan);
    world.case(1, "a", None);
    world.over();
    let reason = "case `a`: the test ended before the case";
    assert_eq!(world.verdict(), (Verdict::Error, Some(reason)));
}

#[test]
fn planned_cases_that_did_not_run_are_an_error_of_a_test_that_would_pass() {
    let plan = one_test();
    let mut world = World::running(&plan);
    world.plan_cases(&["a", "b", "c", "d", "e"]);
    world.case(1, "b", None);
    world.case_ends(1);
    world.over();
    let reason = "4 of 5 planned cases did not run: `a`, `c`, `d`, …";
    assert_eq!(world.verdict(), (Verdict::Error, Some(reason)));
}

#[test]
fn a_second_case_with_a_name_gets_a_number_and_a_warning() {
    let plan = one_test();
    let mut world = World::running(&plan);
    for case in 1..=3 {
        world.case(case, "pose", None);
        world.case_ends(case);
    }
    world.over();
    let cases = world.record.tests[0].attempts[0].cases.kept();
    let paths: Vec<_> = cases.iter().map(|case| &*case.path).collect();
    assert_eq!(paths, ["pose", "pose#2", "pose#3"]);
    assert_eq!(world.record.warnings.len(), 2);
    assert!(world.record.is_green());
}

#[test]
fn a_report_in_a_case_that_is_not_open_belongs_to_the_test() {
    let plan = one_test();
    let mut world = World::running(&plan);
    world.case(1, "a", None);
    world.case_ends(1);
    world.message_in(1, MessageKind::Failure, "too late");
    world.message_in(7, MessageKind::Failure, "never started");
    world.over();
    assert_eq!(world.verdict(), (Verdict::Failed, Some("too late")));
    let cases = world.record.tests[0].attempts[0].cases.kept();
    assert_eq!(cases[0].verdict(), Some(Verdict::Passed));
}

#[test]
fn wrong_numbers_of_cases_are_protocol_errors() {
    let plan = one_test();
    type Step = fn(&mut World<'_>);
    let steps: [(&str, Step); 5] = [
        ("started case 2 after case 0", |world| world.case(2, "b", None)),
        ("finished case 1, which is not open", |world| world.case_ends(1)),
        ("finished case 1 before a case that it contains", |world| {
            world.case(1, "a", None);
            world.case(2, "b", Some(1));
            world.case_ends(1);
        }),
        ("started the case `a` in exit", |world| {
            world.answer(TEST, "passed");
            world.case(1, "a", None);
        }),
        ("started the case `a` in tear-down", |world| {
            world.phase(TEST, Phase::TearDown);
            world.case(1, "a", None);
        }),
    ];
    for (what, step) in steps {
        let mut world = World::running(&plan);
        step(&mut world);
        world.exit(TEST, ExitStatus::Signal(15));
        world.finish();
        let reason = format!("the host broke the protocol: {what}");
        assert_eq!(world.verdict(), (Verdict::Error, Some(&*reason)));
    }
}

#[test]
fn the_last_attempt_of_a_case_decides() {
    let plan = one_test();
    let mut world = World::running(&plan);
    world.plan_cases(&["a", "b"]);
    world.case(1, "a", None);
    world.message_in(1, MessageKind::Failure, "too slow");
    world.case_is_rerun(1, Outcome::Failed);
    world.case(2, "a", None);
    world.case_ends(2);
    world.case(3, "b", None);
    world.case_ends(3);
    world.over();
    assert_eq!(world.verdict(), (Verdict::Passed, None));
    assert!(world.record.tests[0].is_flaky());
    assert_snapshot!(world.transcript(), @"
    0.0  case-started case=1 name=a test=0
    0.0  message source={test:0}
    0.0  case-finished case=1 reason=too slow rerun=true test=0 verdict=failed
    0.0  case-started case=2 earlier_attempts=1 name=a test=0
    0.0  case-finished case=2 test=0 verdict=passed
    0.0  case-started case=3 name=b test=0
    0.0  case-finished case=3 test=0 verdict=passed
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=exit test=0 verdict=passed
    0.0  suite-finished
    ");
}

#[test]
fn a_case_that_fails_in_all_attempts_fails() {
    let plan = one_test();
    let mut world = World::running(&plan);
    world.case(1, "a", None);
    world.case_is_rerun(1, Outcome::Failed);
    world.case(2, "a", None);
    world.case_ends_with(2, Some(Outcome::Failed), Some("still no"));
    world.end(TEST, "failed");
    world.finish();
    assert_eq!(world.verdict(), (Verdict::Failed, Some("case `a`: still no")));
    assert_eq!(world.record.tests[0].attempts[0].cases.problems(), 1);
}

#[test]
fn a_case_whose_next_attempt_does_not_start_is_no_pass() {
    let plan = one_test();
    let mut world = World::running(&plan);
    world.case(1, "a", None);
    world.case_is_rerun(1, Outcome::Failed);
    world.over();
    let reason = "case `a`: the test ended before the next attempt of the case; the last one: \
                  case `a`: no";
    assert_eq!(world.verdict(), (Verdict::Error, Some(reason)));
    assert_eq!(world.record.tests[0].attempts[0].cases.total(), 1);
}
