//! Limits: what happens, and in which order, when something takes too long.

use insta::assert_snapshot;
use rtf_model::{ExitStatus, FixtureId, Phase, Source, TestId, Verdict};

use super::world::{SECOND, World, suite};
use crate::run::machine::{Deadline, HostInput, TestTimer};

const FIXTURE: Source = Source::Fixture(FixtureId(0));
const TEST: Source = Source::Test(TestId(0));

#[test]
fn a_test_that_hangs_is_dumped_asked_terminated_and_killed() {
    let plan = suite(0, 1);
    let mut world = World::new(&plan);
    world.start();
    world.phase(TEST, Phase::Run);
    assert_eq!(world.next_deadline(), Deadline::Test(TestTimer::Slow));
    world.next_deadline();
    world.input(TEST, HostInput::StackTaken("#0 pause".to_owned()));
    world.next_deadline();
    world.next_deadline();
    world.exit(TEST, ExitStatus::Signal(9));
    world.finish();
    assert_snapshot!(world.story(), @"
    0.0  suite-started
    0.0  test-started attempt=1 repetition=1 test=0
    0.0  test-phase phase=run test=0
    2.0  test-slow test=0
    5.0  test-stopping cause=timeout reason=run did not end within 5s test=0
    5.0    → take a stack dump
    5.0  stack-dumped source={test:0} text=#0 pause
    6.0    → signal 15
    7.0    → kill the tree
    7.0  test-finished exit={signal:9} phase=run reason=run did not end within 5s test=0 verdict=timed-out
    7.0  suite-finished
    ");
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::TimedOut));
    assert_eq!(world.record.tests[0].attempts[0].stacks, ["#0 pause"]);
}

#[test]
fn each_phase_has_its_own_limit() {
    for (phases, reason) in [
        (&[][..], "the plug-in was not loaded within 10s"),
        (&[Phase::Setup], "set-up did not end within 10s"),
        (&[Phase::Setup, Phase::Run], "run did not end within 5s"),
        (&[Phase::Setup, Phase::Run, Phase::TearDown], "tear-down did not end within 3s"),
    ] {
        let plan = suite(0, 1);
        let mut world = World::new(&plan);
        world.start();
        phases.iter().for_each(|phase| world.phase(TEST, *phase));
        while world.next_deadline() != Deadline::Test(TestTimer::Limit) {}
        world.exit(TEST, ExitStatus::Code(0));
        world.finish();
        assert_eq!(world.record.tests[0].reason(), Some(reason));
    }
}

#[test]
fn a_fixture_that_is_not_ready_in_time_is_broken_and_torn_down() {
    let plan = suite(1, 1);
    let mut world = World::new(&plan);
    world.start();
    world.next_deadline();
    world.next_deadline();
    world.next_deadline();
    world.exit(FIXTURE, ExitStatus::Signal(9));
    world.finish();
    assert_snapshot!(world.story(), @"
     0.0  suite-started
     0.0  fixture-starting attempt=1 fixture=0
    10.0    → take a stack dump
    10.0  fixture-broken fixture=0 reason=set-up failed: it was not ready within 10s
    10.0  fixture-stopping fixture=0
    13.0    → signal 15
    14.0    → kill the tree
    14.0  fixture-stopped fixture=0 problem=set-up failed: it was not ready within 10s
    14.0  test-skipped reason=fixture `fixture0` is broken: set-up failed: it was not ready within 10s test=0
    14.0  suite-finished
    ");
}

#[test]
fn a_check_that_hangs_is_a_collapse() {
    let plan = suite(1, 1);
    let mut world = World::new(&plan);
    world.start();
    world.answer(FIXTURE, "passed");
    world.next_deadline();
    assert_eq!(world.record.fixtures[0].collapses[0].1, "check did not answer within 1s");
    world.exit(FIXTURE, ExitStatus::Code(1));
    world.answer(FIXTURE, "passed");
    world.answer(FIXTURE, "passed");
    world.pass(0);
    world.tear_down(0);
    world.finish();
}

#[test]
fn checks_are_asked_for_while_a_test_runs() {
    let mut plan = suite(1, 1);
    plan.fixtures[0].check_every = Some(SECOND);
    let mut world = World::new(&plan);
    world.start();
    world.answer(FIXTURE, "passed");
    world.answer(FIXTURE, "passed");
    world.phase(TEST, Phase::Run);
    world.next_deadline();
    world.answer(FIXTURE, "failed");
    world.answer(TEST, "interrupted");
    world.exit(TEST, ExitStatus::Code(0));
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed));
}

#[test]
fn the_limit_of_the_suite_ends_it_with_tear_down() {
    let mut plan = suite(1, 2);
    plan.timeout = Some(SECOND);
    let mut world = World::new(&plan);
    world.start();
    world.answer(FIXTURE, "passed");
    world.answer(FIXTURE, "passed");
    world.phase(TEST, Phase::Run);
    world.next_deadline();
    world.exit(TEST, ExitStatus::Code(0));
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::TimedOut));
    assert_eq!(world.record.tests[1].reason(), Some("the suite did not end within 1s"));
}
