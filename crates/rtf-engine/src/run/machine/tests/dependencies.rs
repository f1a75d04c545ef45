//! Dependent and independent fixtures, and delayed restarts.

use insta::assert_snapshot;
use rtf_model::{ExitStatus, FixtureId, Source, TestId, Verdict};

use super::world::{SECOND, World, suite};
use crate::run::machine::{Deadline, FixtureTimer, StopLevel};

fn fixture(number: u32) -> Source {
    Source::Fixture(FixtureId(number))
}

#[test]
fn independent_fixtures_are_set_up_and_torn_down_in_parallel() {
    let mut plan = suite(3, 1);
    plan.fixtures[1].depends.clear();
    plan.fixtures[2].depends = vec![0, 1];
    let mut world = World::started(&plan);
    world.answer(fixture(1), "passed");
    world.answer(fixture(0), "passed");
    world.answer(fixture(2), "passed");
    (0..3).for_each(|number| world.answer(fixture(number), "passed"));
    world.pass(0);
    world.tear_down(2);
    world.tear_down(0);
    world.tear_down(1);
    world.finish();
    assert_snapshot!(world.transcript(), @"
    0.0  suite-started
    0.0  fixture-starting attempt=1 fixture=0
    0.0  fixture-starting attempt=1 fixture=1
    0.0  fixture-ready fixture=1
    0.0  fixture-ready fixture=0
    0.0  fixture-starting attempt=1 fixture=2
    0.0  fixture-ready fixture=2
    0.0  test-started attempt=1 repetition=1 test=0
    0.0  test-phase phase=setup test=0
    0.0  test-phase phase=run test=0
    0.0  test-phase phase=tear-down test=0
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=exit test=0 verdict=passed
    0.0  fixture-stopping fixture=2
    0.0    → close the channel
    0.0  fixture-stopped fixture=2
    0.0  fixture-stopping fixture=1
    0.0  fixture-stopping fixture=0
    0.0    → close the channel
    0.0  fixture-stopped fixture=0
    0.0    → close the channel
    0.0  fixture-stopped fixture=1
    0.0  suite-finished
    ");
}

#[test]
fn a_collapse_restarts_only_the_fixture_and_its_dependents() {
    let mut plan = suite(3, 1);
    plan.fixtures[1].depends.clear();
    plan.fixtures[2].depends = vec![1];
    let mut world = World::started(&plan);
    (0..3).for_each(|number| world.answer(fixture(number), "passed"));
    world.exit(fixture(1), ExitStatus::Signal(9));
    world.tear_down(2);
    world.answer(fixture(1), "passed");
    world.answer(fixture(2), "passed");
    (0..3).for_each(|number| world.answer(fixture(number), "passed"));
    world.pass(0);
    (0..3).rev().for_each(|number| world.tear_down(number));
    world.finish();
    let starts: Vec<u32> = world.record.fixtures.iter().map(|fixture| fixture.starts).collect();
    assert_eq!(starts, [1, 2, 2]);
}

#[test]
fn the_delay_doubles_with_each_restart() {
    let mut plan = suite(1, 1);
    plan.fixtures[0].restarts = 5;
    plan.fixtures[0].restart_delay = 3 * SECOND;
    let mut world = World::started(&plan);
    world.answer(fixture(0), "passed");
    let mut waited = Vec::new();
    for _ in 0..4 {
        world.exit(fixture(0), ExitStatus::Code(1));
        let before = world.now;
        assert_eq!(world.next_deadline(), Deadline::Fixture(0, FixtureTimer::RestartDue));
        waited.push((world.now - before).as_secs());
        world.answer(fixture(0), "passed");
    }
    assert_eq!(waited, [3, 6, 10, 10]);
}

#[test]
fn stability_resets_the_restart_delay_but_not_the_count() {
    let mut plan = suite(1, 1);
    plan.fixtures[0].restarts = 4;
    plan.fixtures[0].restart_delay = SECOND;
    let mut world = World::started(&plan);
    world.answer(fixture(0), "passed");
    let mut waited = Vec::new();
    // Seconds for which it is ready before each collapse.
    for ready in [29, 29, 30, 0] {
        world.now += ready * SECOND;
        world.exit(fixture(0), ExitStatus::Code(1));
        let before = world.now;
        assert_eq!(world.next_deadline(), Deadline::Fixture(0, FixtureTimer::RestartDue));
        waited.push((world.now - before).as_secs());
        world.answer(fixture(0), "passed");
    }
    assert_eq!(waited, [1, 2, 1, 2]);
    world.now += 100 * SECOND;
    world.exit(fixture(0), ExitStatus::Code(1));
    world.finish();
    assert!(world.record.fixtures[0].broken.is_some(), "its restarts are used up");
}

#[test]
fn a_long_set_up_does_not_count_as_stability() {
    let mut plan = suite(1, 1);
    plan.fixtures[0].restarts = 3;
    plan.fixtures[0].restart_delay = SECOND;
    plan.fixtures[0].limits.setup = 100 * SECOND;
    let mut world = World::started(&plan);
    world.answer(fixture(0), "passed");
    world.exit(fixture(0), ExitStatus::Code(1));
    world.next_deadline();
    world.now += 60 * SECOND;
    world.exit(fixture(0), ExitStatus::Code(1));
    let before = world.now;
    assert_eq!(world.next_deadline(), Deadline::Fixture(0, FixtureTimer::RestartDue));
    assert_eq!(world.now - before, 2 * SECOND);
}

#[test]
fn a_stop_during_the_restart_delay_starts_nothing() {
    let mut plan = suite(1, 1);
    plan.fixtures[0].restart_delay = SECOND;
    let mut world = World::started(&plan);
    world.answer(fixture(0), "passed");
    world.exit(fixture(0), ExitStatus::Code(1));
    world.stop(StopLevel::TearDown);
    world.finish();
    assert_eq!(world.record.fixtures[0].starts, 1);
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Skipped));
}
