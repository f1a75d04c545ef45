//! Processes that a host of programs killed, which are a problem of the case that left them.

use rtf_model::protocol::Notification;
use rtf_model::{CaseId, LeakedProcess, Outcome, Verdict};
use rtf_plan::plan::{Leaks, SuitePlan};

use super::world::{World, suite};

impl World<'_> {
    fn left(&mut self, case: Option<u32>, commands: &[&str]) {
        let process =
            |command: &&str| LeakedProcess { pid: 1, command: (*command).to_owned(), owner: None };
        let processes = commands.iter().map(process).collect();
        self.notified(Notification::ProcessesLeft { case: case.map(CaseId), processes });
    }

    fn case_results(&self) -> Vec<(Verdict, Option<&str>)> {
        let cases = self.record.tests[0].attempts[0].cases.kept();
        cases.iter().filter_map(|case| Some((case.verdict()?, case.reason()))).collect()
    }
}

fn one_test(leaks: Leaks) -> SuitePlan {
    let mut plan = suite(0, 1);
    plan.tests[0].settings.leaks = leaks;
    plan
}

fn run(world: &mut World<'_>) {
    world.case(1, "moves", None);
    world.left(Some(1), &["sleep 1"]);
    world.case_ends(1);
    world.case(2, "grasps", None);
    world.left(Some(2), &["sleep 2", "sleep 3"]);
    world.case_ends_with(2, Some(Outcome::Failed), Some("the gripper is open"));
    world.over();
}

#[test]
fn a_case_that_would_pass_is_an_error_by_what_it_left() {
    let plan = one_test(Leaks::Fail);
    let mut world = World::running(&plan);
    run(&mut world);
    let leak = "it left a process behind: sleep 1";
    let failed = (Verdict::Failed, Some("the gripper is open"));
    assert_eq!(world.case_results(), [(Verdict::Error, Some(leak)), failed]);
    let reason = format!("case `moves`: {leak}");
    assert_eq!(world.verdict(), (Verdict::Error, Some(reason.as_str())));
    assert_eq!(world.record.tests[0].attempts[0].leaked.len(), 3);
}

#[test]
fn what_a_case_left_is_a_message_of_the_case() {
    let plan = one_test(Leaks::Report);
    let mut world = World::running(&plan);
    run(&mut world);
    let failed = (Verdict::Failed, Some("the gripper is open"));
    assert_eq!(world.case_results(), [(Verdict::Passed, None), failed]);
    let messages = &world.record.tests[0].attempts[0].messages;
    let shown: Vec<_> = messages.iter().map(|it| (it.case, it.text.as_str())).collect();
    let expected = [
        (Some(CaseId(1)), "it left a process behind: sleep 1"),
        (Some(CaseId(2)), "it left 2 processes behind, first: sleep 2"),
    ];
    assert_eq!(shown, expected);
}

#[test]
fn what_no_case_alone_left_is_an_error_of_the_test() {
    let plan = one_test(Leaks::Fail);
    let mut world = World::running(&plan);
    world.case(1, "moves", None);
    world.case_ends(1);
    world.left(None, &["sleep 1"]);
    world.left(Some(1), &["sleep 2"]);
    world.over();
    assert_eq!(world.case_results(), [(Verdict::Passed, None)]);
    let reason = "it left 2 processes behind, first: sleep 1";
    assert_eq!(world.verdict(), (Verdict::Error, Some(reason)));
}
