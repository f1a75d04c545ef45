//! Processes outlive the one that the runner started: the grace of a stop is theirs, too.

use std::sync::Arc;

use insta::assert_snapshot;
use rtf_model::{ExitStatus, LeakedProcess, Phase, Trigger};

use super::world::{FIXTURE, HOOK, SECOND, TEST, World, hook, suite};
use crate::run::machine::ProcessEvent;
use rtf_plan::plan::{FixtureBody, ProbePlans, ProcessPlan, SuitePlan};

fn process() -> SuitePlan {
    let mut plan = suite(1, 1);
    let process = ProcessPlan {
        command: vec!["sim".to_owned()],
        probes: ProbePlans::default(),
        stop_signal: 2,
        stop_grace: 4 * SECOND,
        stop_codes: Vec::new(),
        remote: None,
    };
    plan.fixtures[0].body = FixtureBody::Process(Arc::new(process));
    plan.fixtures[0].restarts = 0;
    plan
}

fn left() -> Vec<LeakedProcess> {
    vec![LeakedProcess { pid: 7, command: "arm".to_owned(), owner: None }]
}

fn leader_ended(status: ExitStatus) -> ProcessEvent {
    ProcessEvent::LeaderEnded(status, left())
}

/// The suite has passed, and its fixture is being stopped.
fn stopping(plan: &SuitePlan) -> World<'_> {
    let mut world = World::started(plan);
    world.input(FIXTURE, ProcessEvent::ProbesPassed);
    world.restart_transcript();
    world.pass(0);
    world
}

#[test]
fn a_fixture_has_stopped_when_its_last_process_has() {
    let plan = process();
    let mut world = stopping(&plan);
    world.input(FIXTURE, leader_ended(ExitStatus::Signal(2)));
    assert!(!world.done);
    world.exit(FIXTURE, ExitStatus::Signal(2));
    world.finish();
    assert!(world.record.is_green());
    assert_snapshot!(world.transcript(), @"");
}

#[test]
fn processes_that_remain_are_asked_and_then_killed() {
    let plan = process();
    let mut world = stopping(&plan);
    world.next_deadline();
    world.input(FIXTURE, leader_ended(ExitStatus::Signal(2)));
    world.next_deadline();
    world.input(FIXTURE, ProcessEvent::Exited(ExitStatus::Signal(2), left()));
    world.finish();
    assert!(!world.record.is_green());
    assert_snapshot!(world.transcript(), @"");
}

#[test]
fn the_remains_of_a_fixture_that_ends_by_itself_are_leaked_and_asked_to_stop() {
    let plan = process();
    let mut world = World::started(&plan);
    world.input(FIXTURE, ProcessEvent::ProbesPassed);
    world.phase(TEST, Phase::Run);
    world.restart_transcript();
    world.input(FIXTURE, leader_ended(ExitStatus::Code(1)));
    world.exit(TEST, ExitStatus::Code(0));
    world.exit(FIXTURE, ExitStatus::Code(1));
    world.finish();
    assert_snapshot!(world.transcript(), @"");
}

#[test]
fn the_processes_of_a_plug_in_may_end_by_themselves_before_they_are_asked() {
    let plan = suite(1, 1);
    let mut world = World::started(&plan);
    world.ready(1);
    world.pass(0);
    world.restart_transcript();
    world.answer(FIXTURE, "passed");
    world.input(FIXTURE, leader_ended(ExitStatus::Code(0)));
    world.next_deadline();
    world.exit(FIXTURE, ExitStatus::Code(0));
    world.finish();
    assert!(world.record.is_green());
    assert_snapshot!(world.transcript(), @"");
}

#[test]
fn the_processes_of_a_test_have_the_rest_of_its_grace() {
    let plan = suite(0, 1);
    let mut world = World::running(&plan);
    world.next_deadline();
    world.next_deadline();
    world.input(TEST, ProcessEvent::StackDumped("#0 pause".to_owned()));
    world.answer(TEST, "failed");
    world.input(TEST, leader_ended(ExitStatus::Code(0)));
    world.next_deadline();
    world.next_deadline();
    world.input(TEST, ProcessEvent::Exited(ExitStatus::Code(0), left()));
    world.finish();
    assert_snapshot!(world.transcript(), @"");
}

#[test]
fn the_processes_of_a_hook_have_the_grace_after_its_limit() {
    let mut plan = suite(0, 1);
    plan.hooks = vec![hook(0, &[Trigger::End])];
    let mut world = World::started(&plan);
    world.pass(0);
    world.restart_transcript();
    world.next_deadline();
    world.input(HOOK, leader_ended(ExitStatus::Signal(15)));
    world.next_deadline();
    world.input(HOOK, ProcessEvent::Exited(ExitStatus::Signal(15), left()));
    world.finish();
    assert_snapshot!(world.transcript(), @"");
}
