//! Requests of a user: stop a test, skip the rest of a suite.

use insta::assert_snapshot;
use rtf_model::{ExitStatus, TestId, Trigger, Verdict};

use super::world::{FIXTURE, HOOK, TEST, World, hook, suite};
use crate::run::machine::Input;
use rtf_plan::plan::SuitePlan;

fn plan(repetitions: u32) -> SuitePlan {
    let mut plan = suite(1, 2);
    plan.tests[0].settings.repetitions = repetitions;
    plan.hooks = vec![hook(0, &[Trigger::Interrupt])];
    plan
}

fn stop(world: &mut World<'_>, test: u32) {
    world.feed(Input::StopTest(TestId(test), "a user".to_owned()));
}

fn unwind(world: &mut World<'_>) {
    world.end(TEST, "interrupted");
}

#[test]
fn a_test_is_stopped_and_the_suite_continues() {
    let plan = plan(3);
    let mut world = World::running(&plan);
    stop(&mut world, 0);
    stop(&mut world, 0);
    unwind(&mut world);
    world.exit(HOOK, ExitStatus::Code(0));
    world.answer(FIXTURE, "passed");
    world.pass(1);
    world.tear_down(0);
    world.finish();
    assert_snapshot!(world.transcript(), @"
    0.0  test-stopping cause=interrupt reason=stopped by a user test=0
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=run reason=stopped by a user test=0 verdict=interrupted
    0.0  test-skipped reason=stopped by a user test=0
    0.0  hook-started hook=0 reason=stopped by a user test=0 trigger=interrupt
    0.0  hook-finished hook=0
    0.0  test-started attempt=1 repetition=1 test=1
    0.0  test-phase phase=setup test=1
    0.0  test-phase phase=run test=1
    0.0  test-phase phase=tear-down test=1
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=exit test=1 verdict=passed
    0.0  fixture-stopping fixture=0
    0.0    → close the channel
    0.0  fixture-stopped fixture=0
    0.0  suite-finished
    ");
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Interrupted));
    assert_eq!(world.record.verdict(TestId(1)), Some(Verdict::Passed));
    assert!(!world.record.is_green());
}

#[test]
fn a_test_that_does_not_run_is_not_stopped() {
    let plan = plan(1);
    let mut world = World::running(&plan);
    stop(&mut world, 1);
    world.end(TEST, "passed");
    stop(&mut world, 0);
    world.answer(FIXTURE, "passed");
    world.pass(1);
    world.tear_down(0);
    world.finish();
    assert!(world.record.is_green(), "{}", world.transcript());
}

#[test]
fn a_stopped_test_that_also_collapses_is_not_rerun() {
    let mut plan = plan(2);
    plan.tests[0].settings.after_collapse = rtf_plan::plan::AfterCollapse::Rerun;
    let mut world = World::running(&plan);
    world.exit(FIXTURE, ExitStatus::Signal(11));
    stop(&mut world, 0);
    unwind(&mut world);
    world.exit(HOOK, ExitStatus::Code(0));
    world.ready(1);
    world.pass(1);
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.tests[0].attempts.len(), 1);
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed));
}

#[test]
fn the_rest_of_a_suite_is_skipped() {
    let plan = plan(1);
    let mut world = World::running(&plan);
    world.feed(Input::Skip("a user".to_owned()));
    unwind(&mut world);
    world.exit(HOOK, ExitStatus::Code(0));
    world.tear_down(0);
    world.finish();
    assert_snapshot!(world.transcript(), @"
    0.0  test-stopping cause=interrupt reason=skipped by a user test=0
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=run reason=skipped by a user test=0 verdict=interrupted
    0.0  hook-started hook=0 reason=skipped by a user test=0 trigger=interrupt
    0.0  hook-finished hook=0
    0.0  fixture-stopping fixture=0
    0.0    → close the channel
    0.0  fixture-stopped fixture=0
    0.0  test-skipped reason=skipped by a user test=1
    0.0  suite-finished
    ");
}

#[test]
fn a_suite_that_was_skipped_before_it_starts_starts_nothing() {
    let plan = plan(1);
    let mut world = World::new(&plan);
    world.feed(Input::Skip("a user".to_owned()));
    world.start();
    world.finish();
    assert_snapshot!(world.transcript(), @"
    0.0  suite-started
    0.0  test-skipped reason=skipped by a user test=0
    0.0  test-skipped reason=skipped by a user test=1
    0.0  suite-finished
    ");
}
