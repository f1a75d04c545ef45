//! Limits: the steps that follow when something takes too long.

use insta::assert_snapshot;
use rtf_model::{ExitStatus, FixtureId, HookId, Phase, Source, TestId, Trigger, Verdict};

use super::world::{FIXTURE, HOOK, SECOND, TEST, World, hook, suite};
use crate::run::machine::{Deadline, ProcessEvent, StopLevel, TestTimer};

#[test]
fn a_hanging_test_is_dumped_interrupted_terminated_and_killed() {
    let plan = suite(0, 1);
    let mut world = World::running(&plan);
    assert_eq!(world.next_deadline(), Deadline::Test(TestId(0), TestTimer::Slow));
    world.next_deadline();
    world.input(TEST, ProcessEvent::StackDumped("#0 pause".to_owned()));
    world.next_deadline();
    world.next_deadline();
    world.exit(TEST, ExitStatus::Signal(9));
    world.finish();
    assert_snapshot!(world.transcript(), @"
    2.0  test-slow test=0
    5.0  test-stopping cause=timeout reason=run did not end within 5s test=0
    5.0    → take a stack dump
    5.0  stack-dumped source={test:0} text=#0 pause
    6.0    → signal 15 to tree
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
        let mut world = World::started(&plan);
        phases.iter().for_each(|phase| world.phase(TEST, *phase));
        while world.next_deadline() != Deadline::Test(TestId(0), TestTimer::Limit) {}
        world.exit(TEST, ExitStatus::Code(0));
        world.finish();
        assert_eq!(world.record.tests[0].reason(), Some(reason));
    }
}

#[test]
fn a_fixture_that_is_not_ready_in_time_is_broken_and_torn_down() {
    let plan = suite(1, 1);
    let mut world = World::started(&plan);
    world.next_deadline();
    world.next_deadline();
    world.next_deadline();
    world.exit(FIXTURE, ExitStatus::Signal(9));
    world.finish();
    assert_snapshot!(world.transcript(), @"
     0.0  suite-started
     0.0  fixture-starting attempt=1 fixture=0
    10.0    → take a stack dump
    10.0  fixture-broken fixture=0 reason=set-up failed: it was not ready within 10s
    10.0  fixture-stopping fixture=0
    13.0    → signal 15 to tree
    14.0    → kill the tree
    14.0  fixture-stopped fixture=0 problem=set-up failed: it was not ready within 10s
    14.0  test-skipped reason=fixture `fixture0` is broken: set-up failed: it was not ready within 10s test=0
    14.0  suite-finished
    ");
}

#[test]
fn a_check_that_hangs_is_a_collapse() {
    let plan = suite(1, 1);
    let mut world = World::started(&plan);
    world.answer(FIXTURE, "passed");
    world.next_deadline();
    assert_eq!(world.record.fixtures[0].collapses[0].1, "check did not answer within 1s");
    world.exit(FIXTURE, ExitStatus::Code(1));
    world.ready(1);
    world.pass(0);
    world.tear_down(0);
    world.finish();
}

#[test]
fn check_is_called_while_a_test_runs() {
    let mut plan = suite(1, 1);
    plan.fixtures[0].check_every = Some(SECOND);
    let mut world = World::running(&plan);
    world.next_deadline();
    world.answer(FIXTURE, "failed");
    world.end(TEST, "interrupted");
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed));
}

#[test]
fn the_limit_of_the_suite_ends_it_with_tear_down() {
    let mut plan = suite(1, 2);
    plan.settings.timeout = Some(SECOND);
    let mut world = World::running(&plan);
    world.next_deadline();
    world.exit(TEST, ExitStatus::Code(0));
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::TimedOut));
    assert_eq!(world.record.tests[1].reason(), Some("the suite did not end within 1s"));
}

/// Each step is within its limit, but all together exceed that of the shutdown.
#[test]
fn a_shutdown_that_takes_too_long_kills_fixtures_and_hooks_still_run() {
    let mut plan = suite(2, 1);
    plan.hooks = vec![hook(0, &[Trigger::Interrupt]), hook(1, &[Trigger::End])];
    plan.hooks[0].timeout = 15 * SECOND;
    plan.fixtures[1].limits.teardown = 100 * SECOND;
    let mut world = World::started(&plan);
    world.answer(FIXTURE, "passed");
    world.answer(Source::Fixture(FixtureId(1)), "passed");
    (0..2).for_each(|number| world.answer(Source::Fixture(FixtureId(number)), "passed"));
    world.now = SECOND;
    world.stop(StopLevel::TearDown);
    world.end(TEST, "interrupted");
    world.now = 12 * SECOND;
    world.exit(HOOK, ExitStatus::Code(0));
    world.exit(Source::Hook(HookId(1)), ExitStatus::Code(0));
    assert_eq!(world.next_deadline(), Deadline::Shutdown);
    (0..2).rev().for_each(|number| {
        world.exit(Source::Fixture(FixtureId(number)), ExitStatus::Signal(9));
    });
    world.finish();
    assert_snapshot!(world.transcript(), @"
     0.0  suite-started
     0.0  fixture-starting attempt=1 fixture=0
     0.0  fixture-ready fixture=0
     0.0  fixture-starting attempt=1 fixture=1
     0.0  fixture-ready fixture=1
     0.0  test-started attempt=1 repetition=1 test=0
     1.0  test-stopping cause=interrupt reason=stopped by SIGINT test=0
     1.0    → close the channel
     1.0  test-finished exit={code:0} phase=load reason=stopped by SIGINT test=0 verdict=interrupted
     1.0  hook-started hook=0 reason=stopped by SIGINT test=0 trigger=interrupt
    12.0  hook-finished hook=0
    12.0  hook-started hook=1 reason=the suite ends trigger=end
    12.0  hook-finished hook=1
    12.0  fixture-stopping fixture=1
    21.0  warning diagnostic={code:shutdown-timeout,hint:`--shutdown-timeout` sets how long tear-downs and hooks may take,message:the run did not end within 20s of SIGINT: the remaining processes were killed,severity:warning}
    21.0    → kill the tree
    21.0  fixture-stopping fixture=0
    21.0    → kill the tree
    21.0  fixture-stopped fixture=1 problem=it was killed: the run did not end within 20s of SIGINT
    21.0  fixture-stopped fixture=0 problem=it was killed: the run did not end within 20s of SIGINT
    21.0  suite-finished
    ");
}

#[test]
fn a_hook_that_runs_at_the_shutdown_timeout_finishes() {
    let mut plan = suite(1, 1);
    plan.hooks = vec![hook(0, &[Trigger::Interrupt]), hook(1, &[Trigger::End])];
    plan.hooks[0].timeout = 30 * SECOND;
    let mut world = World::started(&plan);
    world.ready(1);
    world.stop(StopLevel::TearDown);
    world.exit(TEST, ExitStatus::Code(0));
    assert_eq!(world.next_deadline(), Deadline::Shutdown);
    world.exit(FIXTURE, ExitStatus::Signal(9));
    world.now = 29 * SECOND;
    world.exit(HOOK, ExitStatus::Code(0));
    world.exit(Source::Hook(HookId(1)), ExitStatus::Code(0));
    world.finish();
    assert_snapshot!(world.transcript(), @"
     0.0  suite-started
     0.0  fixture-starting attempt=1 fixture=0
     0.0  fixture-ready fixture=0
     0.0  test-started attempt=1 repetition=1 test=0
     0.0  test-stopping cause=interrupt reason=stopped by SIGINT test=0
     0.0  test-finished exit={code:0} phase=load reason=stopped by SIGINT test=0 verdict=interrupted
     0.0  hook-started hook=0 reason=stopped by SIGINT test=0 trigger=interrupt
    20.0  warning diagnostic={code:shutdown-timeout,hint:`--shutdown-timeout` sets how long tear-downs and hooks may take,message:the run did not end within 20s of SIGINT: the remaining processes were killed,severity:warning}
    20.0  fixture-stopping fixture=0
    20.0    → kill the tree
    20.0  fixture-stopped fixture=0 problem=it was killed: the run did not end within 20s of SIGINT
    29.0  hook-finished hook=0
    29.0  hook-started hook=1 reason=the suite ends trigger=end
    29.0  hook-finished hook=1
    29.0  suite-finished
    ");
}

#[test]
fn a_test_that_does_not_stop_is_killed_at_the_shutdown_timeout() {
    let mut plan = suite(0, 2);
    let limits = rtf_plan::plan::TestLimits { grace: 100 * SECOND, ..*plan.tests[0].limits };
    plan.tests[0].limits = std::sync::Arc::new(limits);
    let mut world = World::running(&plan);
    world.next_deadline();
    world.stop(StopLevel::TearDown);
    assert_eq!(world.next_deadline(), Deadline::Shutdown);
    assert_eq!(world.now, 22 * SECOND);
    world.exit(TEST, ExitStatus::Signal(9));
    world.finish();
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Interrupted));
    assert_eq!(world.record.verdict(TestId(1)), Some(Verdict::Skipped));
}
