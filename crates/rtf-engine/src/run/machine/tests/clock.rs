//! Limits in simulated time.

use std::time::Duration;

use insta::assert_snapshot;
use rtf_model::{ExitStatus, Phase, Source, TestId, Verdict};

use super::world::{SECOND, World, suite};
use crate::run::machine::{Deadline, Input, ProcessEvent, TestTimer};
use rtf_plan::plan::{ClockPlan, SuitePlan};

const TEST: Source = Source::Test(TestId(0));

fn plan(tests: usize) -> SuitePlan {
    let clock = Some(ClockPlan { backstop: 10 });
    SuitePlan { clock, ..suite(0, tests) }
}

fn set_clock(world: &mut World<'_>, tenths: u64) {
    world.feed(Input::Clock(Duration::from_millis(100 * tenths)));
}

fn dump_and_end(world: &mut World<'_>) {
    world.input(TEST, ProcessEvent::StackDumped("#0 pause".to_owned()));
    world.answer(TEST, "interrupted");
    world.exit(TEST, ExitStatus::Code(0));
    world.finish();
}

#[test]
fn a_phase_times_out_by_the_simulated_clock() {
    let plan = plan(1);
    let mut world = World::started(&plan);
    assert!(!world.machine.follows_clock(), "the limit of loading is wall-clock time");
    world.phase(TEST, Phase::Setup);
    world.phase(TEST, Phase::Run);
    assert!(world.machine.follows_clock());
    for (seconds, tenths) in [(10, 1000), (20, 1019), (21, 1020), (30, 1049), (31, 1050)] {
        world.now = seconds * SECOND;
        set_clock(&mut world, tenths);
    }
    assert!(!world.machine.follows_clock(), "it was asked to stop");
    dump_and_end(&mut world);
    assert_snapshot!(world.transcript(), @"
     0.0  suite-started
     0.0  test-started attempt=1 repetition=1 test=0
     0.0  test-phase phase=setup test=0
     0.0  test-phase phase=run test=0
    21.0  test-slow test=0
    31.0  test-stopping cause=timeout reason=run did not end within 5s of simulated time, which took 31s test=0
    31.0    → take a stack dump
    31.0  stack-dumped source={test:0} text=#0 pause
    31.0    → close the channel
    31.0  test-finished exit={code:0} phase=run reason=run did not end within 5s of simulated time, which took 31s test=0 verdict=timed-out
    31.0  suite-finished
    ");
}

#[test]
fn a_stopped_clock_times_out_by_the_wall_clock() {
    let plan = plan(1);
    let mut world = World::started(&plan);
    world.phase(TEST, Phase::Run);
    set_clock(&mut world, 30);
    world.now = SECOND;
    set_clock(&mut world, 35);
    let limit = Deadline::Test(TestId(0), TestTimer::Limit);
    assert_eq!(world.deadlines, [(limit, 50 * SECOND)].into());
    world.next_deadline();
    dump_and_end(&mut world);
    let reason = "run did not end within 5s of simulated time, nor within 50s: \
                  the clock advanced by 500ms, then stood at 3.5s for 49s";
    assert_eq!(world.record.tests[0].reason(), Some(reason));
}

#[test]
fn each_phase_is_measured_from_its_start() {
    let plan = plan(1);
    let mut world = World::started(&plan);
    for (phase, tenths) in [(Phase::Setup, 99), (Phase::Run, 49), (Phase::TearDown, 29)] {
        world.phase(TEST, phase);
        set_clock(&mut world, 0);
        set_clock(&mut world, tenths);
    }
    world.answer(TEST, "passed");
    set_clock(&mut world, 1_000_000);
    assert_eq!(world.deadlines.values().copied().collect::<Vec<_>>(), [3 * SECOND]);
    world.exit(TEST, ExitStatus::Code(0));
    world.finish();
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Passed));
}

/// The clock's file may change after the end of the test.
#[test]
fn the_clock_is_not_read_between_tests() {
    let plan = plan(2);
    let mut world = World::started(&plan);
    world.phase(TEST, Phase::Run);
    world.exit(TEST, ExitStatus::Signal(11));
    assert!(!world.machine.follows_clock());
    set_clock(&mut world, 1_000_000);
    world.pass(1);
    world.finish();
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Crashed));
}
