//! Processes outlive the one that the runner started: the grace of a stop is theirs, too.

use std::sync::Arc;

use insta::assert_snapshot;
use rtf_model::{ExitStatus, LeakedProcess, Phase, Stream, Trigger};

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
    assert_snapshot!(world.transcript(), @"
    0.0  test-phase phase=setup test=0
    0.0  test-phase phase=run test=0
    0.0  test-phase phase=tear-down test=0
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=exit test=0 verdict=passed
    0.0  fixture-stopping fixture=0
    0.0    → signal 2
    0.0    → signal 2 to left
    0.0  fixture-stopped fixture=0
    0.0  suite-finished
    ");
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
    assert_snapshot!(world.transcript(), @"
    0.0  test-phase phase=setup test=0
    0.0  test-phase phase=run test=0
    0.0  test-phase phase=tear-down test=0
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=exit test=0 verdict=passed
    0.0  fixture-stopping fixture=0
    0.0    → signal 2
    2.0    → signal 2 to left
    2.0    → signal 2 to left
    4.0    → kill the tree
    4.0  fixture-stopped fixture=0 problem=it did not stop within 4s and was killed; `arm` still ran and was killed
    4.0  suite-finished
    ");
}

#[test]
fn the_reason_of_a_process_that_leaves_others_has_the_line_that_says_why() {
    let plan = process();
    for is_ready in [false, true] {
        let mut world = World::started(&plan);
        if is_ready {
            world.input(FIXTURE, ProcessEvent::ProbesPassed);
            world.phase(TEST, Phase::Run);
        }
        let line = b"sim: joint.so: cannot open shared object file\n".to_vec();
        world.input(FIXTURE, ProcessEvent::Printed(Stream::Stderr, line));
        world.input(FIXTURE, leader_ended(ExitStatus::Code(127)));
        if is_ready {
            world.exit(TEST, ExitStatus::Code(0));
        }
        world.exit(FIXTURE, ExitStatus::Code(127));
        world.finish();
        let transcript = world.transcript();
        let broken = transcript.lines().find(|line| line.contains("fixture-broken"));
        let reason = broken.expect("a reason");
        assert!(reason.contains("joint.so: cannot open shared object file"), "{reason}");
    }
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
    // The order in an object depends on the crates that are built with this one.
    let transcript = world.transcript().replace("pid:7,command:arm", "command:arm,pid:7");
    assert_snapshot!(transcript, @"
    0.0  processes-leaked processes=[{command:arm,pid:7}] source={fixture:0}
    0.0  fixture-collapsed fixture=0 reason=its process ended with exit code 1
    0.0  test-stopping cause=collapse reason=fixture `fixture0` collapsed: its process ended with exit code 1 test=0
    0.0  fixture-broken fixture=0 reason=its process ended with exit code 1
    0.0  test-finished exit={code:0} phase=run reason=fixture `fixture0` collapsed: its process ended with exit code 1 test=0 verdict=collapsed
    0.0  fixture-stopping fixture=0
    0.0    → signal 2 to tree
    0.0  fixture-stopped fixture=0
    0.0  suite-finished
    ");
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
    assert_snapshot!(world.transcript(), @"
    0.0    → close the channel
    1.0    → signal 15 to left
    1.0  fixture-stopped fixture=0
    1.0  suite-finished
    ");
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
    assert_snapshot!(world.transcript(), @"
    2.0  test-slow test=0
    5.0  test-stopping cause=timeout reason=run did not end within 5s test=0
    5.0    → take a stack dump
    5.0  stack-dumped source={test:0} text=#0 pause
    5.0    → close the channel
    6.0    → signal 15 to tree
    7.0    → kill the tree
    7.0  test-finished exit={code:0} phase=run reason=run did not end within 5s; `arm` still ran and was killed test=0 verdict=timed-out
    7.0  suite-finished
    ");
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
    assert_snapshot!(world.transcript(), @"
    4.0    → signal 15 to tree
    5.0    → kill the tree
    5.0  hook-finished hook=0 problem=it did not end within 4s; `arm` still ran and was killed
    5.0  suite-finished
    ");
}
