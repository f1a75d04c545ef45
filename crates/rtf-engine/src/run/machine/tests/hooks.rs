//! Hooks: when they run, and with which outcome.

use insta::assert_snapshot;
use rtf_model::{ExitStatus, FixtureId, Phase, Source, TestId, Trigger, Verdict};

use super::world::{FIXTURE, HOOK, TEST, World, hook, suite};
use crate::run::machine::{Deadline, StopLevel};
use rtf_plan::plan::SuitePlan;

fn plan(tests: usize, on: &[Trigger]) -> SuitePlan {
    let mut plan = suite(1, tests);
    plan.hooks = vec![hook(0, on)];
    plan
}

fn fail(world: &mut World<'_>) {
    world.failure(TEST, "the arm is stuck", false);
    world.end(TEST, "failed");
    world.next_deadline();
}

#[test]
fn after_a_failure_the_hook_runs_before_the_next_test() {
    let plan = plan(2, &[Trigger::Failure]);
    let mut world = World::running(&plan);
    fail(&mut world);
    world.exit(HOOK, ExitStatus::Code(0));
    world.answer(FIXTURE, "passed");
    world.pass(1);
    world.tear_down(0);
    world.finish();
    assert_snapshot!(world.transcript(), @"
    0.0  message source={test:0}
    0.0    → close the channel
    0.2  test-finished exit={code:0} phase=run reason=the arm is stuck test=0 verdict=failed
    0.2  hook-started hook=0 reason=`test0` is failed: the arm is stuck test=0 trigger=failure
    0.2  hook-finished hook=0
    0.2  test-started attempt=1 repetition=1 test=1
    0.2  test-phase phase=setup test=1
    0.2  test-phase phase=run test=1
    0.2  test-phase phase=tear-down test=1
    0.2    → close the channel
    0.2  test-finished exit={code:0} phase=exit test=1 verdict=passed
    0.2  fixture-stopping fixture=0
    0.2    → close the channel
    0.2  fixture-stopped fixture=0
    0.2  suite-finished
    ");
    assert!(!world.record.hook_failed());
}

#[test]
fn after_a_collapse_the_hook_runs_before_anything_is_torn_down() {
    let plan = plan(1, &[Trigger::Collapse]);
    let mut world = World::running(&plan);
    world.collapse(FIXTURE, "no heartbeat");
    world.end(TEST, "interrupted");
    world.exit(HOOK, ExitStatus::Code(0));
    world.tear_down(0);
    world.finish();
    assert_snapshot!(world.transcript(), @"
    0.0  fixture-collapsed fixture=0 reason=no heartbeat
    0.0  test-stopping cause=collapse reason=fixture `fixture0` collapsed: no heartbeat test=0
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=run reason=fixture `fixture0` collapsed: no heartbeat test=0 verdict=collapsed
    0.0  hook-started hook=0 reason=fixture `fixture0` collapsed: no heartbeat test=0 trigger=collapse
    0.0  hook-finished hook=0
    0.0  fixture-stopping fixture=0
    0.0    → close the channel
    0.0  fixture-stopped fixture=0
    0.0  suite-finished
    ");
}

#[test]
fn a_failed_hook_is_reported_and_the_run_is_not_green() {
    let plan = plan(1, &[Trigger::End]);
    let mut world = World::running(&plan);
    world.phase(TEST, Phase::TearDown);
    world.end(TEST, "passed");
    world.exit(HOOK, ExitStatus::Code(3));
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Passed));
    assert!(world.record.hook_failed() && !world.record.is_green());
    let problems = world.record.suite_problems(plan.id);
    assert_eq!(problems, ["hook `hook0` on end: it ended with exit code 3"]);
}

#[test]
fn a_hanging_hook_is_killed() {
    let plan = plan(1, &[Trigger::Failure]);
    let mut world = World::running(&plan);
    fail(&mut world);
    assert_eq!(world.next_deadline(), Deadline::Hook);
    assert_eq!(world.next_deadline(), Deadline::Hook);
    world.exit(HOOK, ExitStatus::Signal(9));
    world.tear_down(0);
    world.finish();
    let problems = world.record.suite_problems(plan.id);
    assert_eq!(problems, ["hook `hook0` on failure: it did not end within 4s"]);
}

#[test]
fn the_end_does_not_repeat_a_hook_that_ran_since_the_last_test() {
    let plan = plan(1, &[Trigger::Failure, Trigger::End]);
    let mut world = World::running(&plan);
    fail(&mut world);
    world.exit(HOOK, ExitStatus::Code(0));
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.hooks[0].runs.len(), 1);
}

#[test]
fn the_first_signal_triggers_the_hook_and_the_second_leaves_it_running() {
    let plan = plan(1, &[Trigger::Interrupt]);
    let mut world = World::running(&plan);
    world.stop(StopLevel::TearDown);
    world.end(TEST, "interrupted");
    world.stop(StopLevel::Kill);
    world.exit(FIXTURE, ExitStatus::Signal(9));
    world.exit(HOOK, ExitStatus::Code(0));
    world.finish();
    assert_snapshot!(world.transcript(), @"
    0.0  test-stopping cause=interrupt reason=stopped by SIGINT test=0
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=run reason=stopped by SIGINT test=0 verdict=interrupted
    0.0  hook-started hook=0 reason=stopped by SIGINT test=0 trigger=interrupt
    0.0  fixture-stopping fixture=0
    0.0    → kill the tree
    0.0  fixture-stopped fixture=0
    0.0  hook-finished hook=0
    0.0  suite-finished
    ");
}

#[test]
fn a_broken_fixture_triggers_its_hook_before_the_others_are_torn_down() {
    let mut plan = suite(2, 1);
    plan.hooks = vec![hook(0, &[Trigger::FixtureBroken])];
    let mut world = World::started(&plan);
    world.answer(FIXTURE, "passed");
    world.answer(Source::Fixture(FixtureId(1)), "error");
    world.exit(HOOK, ExitStatus::Code(0));
    world.tear_down(1);
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.hooks[0].runs[0].trigger, Trigger::FixtureBroken);
}

#[test]
fn a_kill_request_without_a_first_request_runs_the_interrupt_hooks() {
    let plan = plan(1, &[Trigger::Interrupt]);
    let mut world = World::running(&plan);
    world.stop(StopLevel::Kill);
    world.exit(TEST, ExitStatus::Signal(9));
    world.exit(FIXTURE, ExitStatus::Signal(9));
    world.exit(HOOK, ExitStatus::Code(0));
    world.finish();
    let triggers: Vec<_> = world.record.hooks[0].runs.iter().map(|run| run.trigger).collect();
    assert_eq!(triggers, [Trigger::Interrupt]);
    assert!(!world.record.hook_failed(), "{}", world.transcript());
}

#[test]
fn the_third_request_kills_the_hook_and_drops_queued_ones() {
    let mut plan = plan(1, &[Trigger::Interrupt]);
    plan.hooks.push(hook(1, &[Trigger::Interrupt]));
    plan.hooks.push(hook(2, &[Trigger::End]));
    let mut world = World::running(&plan);
    world.stop(StopLevel::TearDown);
    world.end(TEST, "interrupted");
    world.stop(StopLevel::Kill);
    world.exit(FIXTURE, ExitStatus::Signal(9));
    world.stop(StopLevel::KillHooks);
    world.exit(HOOK, ExitStatus::Signal(9));
    world.finish();
    let problems = world.record.suite_problems(plan.id);
    assert_eq!(
        problems,
        [
            "hook `hook0` on interrupt: it was killed by the third request to end the run",
            "hook `hook1` on interrupt: it did not run: the end of the run was requested three times",
            "hook `hook2` on end: it did not run: the end of the run was requested three times",
        ]
    );
}
