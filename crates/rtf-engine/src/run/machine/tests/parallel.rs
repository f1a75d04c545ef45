//! Parallel tests of a suite.

use insta::assert_snapshot;
use rtf_model::protocol::Notification;
use rtf_model::{EventKind, ExitStatus, Phase, Source, TestId, Trigger, Verdict};

use super::world::{FIXTURE, HOOK, SECOND, World, hook, suite};
use crate::run::FailLimit;
use crate::run::machine::{Deadline, Input, ProcessEvent, StopLevel, SuiteMachine};
use rtf_plan::plan::{AfterCollapse, Retries, SuitePlan};

const OK: ExitStatus = ExitStatus::Code(0);

fn plan(fixtures: usize, tests: usize, parallel: u32) -> SuitePlan {
    let mut plan = suite(fixtures, tests);
    plan.settings.parallel = parallel;
    plan
}

fn test(id: u32) -> Source {
    Source::Test(TestId(id))
}

fn started(plan: &SuitePlan) -> World<'_> {
    let mut world = World::started(plan);
    if !plan.fixtures.is_empty() {
        world.ready(1);
    }
    world.restart_transcript();
    world
}

fn running(world: &World<'_>) -> Vec<u32> {
    let tests = world.hosts.values().filter_map(|source| match source {
        Source::Test(id) => Some(id.0),
        _ => None,
    });
    let mut tests: Vec<_> = tests.collect();
    tests.sort_unstable();
    tests
}

fn fail(world: &mut World<'_>, id: u32, critical: bool) {
    world.phase(test(id), Phase::Run);
    world.failure(test(id), "too far", critical);
    world.end(test(id), "failed");
}

fn interrupted(world: &mut World<'_>, id: u32) {
    world.end(test(id), "interrupted");
}

fn verdicts(world: &World<'_>) -> Vec<&'static str> {
    let ids = (0u32..).take(world.record.tests.len());
    ids.map(|id| world.record.verdict(TestId(id)).map_or("none", Verdict::as_str)).collect()
}

#[test]
fn the_next_test_starts_as_soon_as_a_slot_is_free() {
    let plan = plan(0, 4, 2);
    let mut world = started(&plan);
    assert_eq!(running(&world), [0, 1]);
    world.pass(1);
    assert_eq!(running(&world), [0, 2]);
    world.pass(2);
    world.pass(0);
    world.pass(3);
    world.finish();
    assert!(world.record.is_green(), "{}", world.transcript());
}

#[test]
fn repetitions_of_a_test_never_overlap_and_keep_its_slot() {
    let mut plan = plan(0, 3, 2);
    plan.tests[0].settings.repetitions = 2;
    let mut world = started(&plan);
    assert_eq!(running(&world), [0, 1]);
    world.pass(0);
    assert_eq!(running(&world), [0, 1]);
    world.pass(1);
    assert_eq!(running(&world), [0, 2]);
    world.pass(0);
    world.pass(2);
    world.finish();
    assert_eq!(world.record.tests[0].attempts.len(), 2);
    assert!(world.record.is_green(), "{}", world.transcript());
}

#[test]
fn an_exclusive_test_runs_alone() {
    let mut plan = plan(0, 4, 3);
    plan.tests[1].settings.exclusive = true;
    let mut world = started(&plan);
    assert_eq!(running(&world), [0]);
    world.pass(0);
    assert_eq!(running(&world), [1]);
    world.pass(1);
    assert_eq!(running(&world), [2, 3]);
    world.pass(2);
    world.pass(3);
    world.finish();
    assert!(world.record.is_green(), "{}", world.transcript());
}

#[test]
fn a_collapse_interrupts_all_tests_and_each_has_its_after_collapse() {
    let mut plan = plan(1, 4, 3);
    plan.tests[1].settings.after_collapse = AfterCollapse::Rerun;
    plan.tests[2].settings.after_collapse = AfterCollapse::Skip;
    plan.hooks = vec![hook(0, &[Trigger::Collapse])];
    let mut world = started(&plan);
    world.input(
        FIXTURE,
        ProcessEvent::Notified(Notification::Collapsed { reason: "gone".to_owned() }),
    );
    interrupted(&mut world, 2);
    interrupted(&mut world, 0);
    // No hook parks the robot while a test still moves it.
    assert!(!world.hosts.values().any(|source| *source == HOOK));
    interrupted(&mut world, 1);
    world.exit(HOOK, OK);
    world.tear_down(0);
    (0..2).for_each(|_| world.answer(FIXTURE, "passed"));
    world.pass(3);
    world.pass(1);
    world.tear_down(0);
    world.finish();
    assert_eq!(verdicts(&world), ["collapsed", "passed", "skipped", "passed"]);
    assert_snapshot!(world.transcript(), @"
    0.0  fixture-collapsed fixture=0 reason=gone
    0.0  test-stopping cause=collapse reason=fixture `fixture0` collapsed: gone test=0
    0.0  test-stopping cause=collapse reason=fixture `fixture0` collapsed: gone test=1
    0.0  test-stopping cause=collapse reason=fixture `fixture0` collapsed: gone test=2
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=load reason=fixture `fixture0` collapsed: gone test=2 verdict=skipped
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=load reason=fixture `fixture0` collapsed: gone test=0 verdict=collapsed
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=load reason=fixture `fixture0` collapsed: gone rerun=true test=1 verdict=collapsed
    0.0  hook-started hook=0 reason=fixture `fixture0` collapsed: gone trigger=collapse
    0.0  hook-finished hook=0
    0.0  fixture-stopping fixture=0
    0.0    → close the channel
    0.0  fixture-stopped fixture=0
    0.0  fixture-starting attempt=2 fixture=0
    0.0  fixture-ready fixture=0
    0.0  test-started attempt=2 repetition=1 test=1
    0.0  test-started attempt=1 repetition=1 test=3
    0.0  test-phase phase=setup test=3
    0.0  test-phase phase=run test=3
    0.0  test-phase phase=tear-down test=3
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=exit test=3 verdict=passed
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
}

#[test]
fn a_collapse_reported_late_affects_all_tests_that_just_ended() {
    let plan = plan(1, 2, 2);
    let mut world = started(&plan);
    world.hides_liveness = true;
    world.pass(0);
    world.pass(1);
    world.exit(FIXTURE, ExitStatus::Signal(11));
    world.finish();
    assert_eq!(verdicts(&world), ["collapsed", "collapsed"]);
}

/// An earlier examination does not cover the time since then.
#[test]
fn fixtures_are_examined_after_the_end_of_each_passing_test() {
    let plan = plan(1, 2, 2);
    let mut world = started(&plan);
    world.hides_liveness = true;
    world.pass(0);
    world.pass(1);
    world.pass_examination(0);
    assert_eq!(verdicts(&world), ["passed", "none"]);
    world.pass_examination(0);
    assert_eq!(verdicts(&world), ["passed", "passed"]);
    world.tear_down(0);
    world.finish();
}

#[test]
fn a_hook_waits_for_running_tests_and_no_test_starts_before_it() {
    let mut plan = plan(0, 4, 2);
    plan.hooks = vec![hook(0, &[Trigger::Failure])];
    let mut world = started(&plan);
    fail(&mut world, 0, false);
    assert_eq!(running(&world), [1]);
    world.pass(1);
    assert_eq!(running(&world), [0; 0]);
    world.exit(HOOK, OK);
    assert_eq!(running(&world), [2, 3]);
    world.pass(2);
    world.pass(3);
    world.finish();
    let about = world.record.hooks[0].runs[0].test;
    assert_eq!(about, Some(TestId(0)));
}

#[test]
fn after_a_critical_failure_running_tests_finish() {
    let plan = plan(1, 4, 2);
    let mut world = started(&plan);
    fail(&mut world, 0, true);
    while world.next_deadline() != Deadline::Test(TestId(0), super::super::TestTimer::Limit) {}
    assert_eq!(running(&world), [1]);
    world.pass(1);
    world.tear_down(0);
    world.finish();
    assert_eq!(verdicts(&world), ["failed", "passed", "skipped", "skipped"]);
}

#[test]
fn tests_after_a_critical_test_wait_for_it() {
    let mut plan = plan(0, 4, 3);
    plan.tests[1].settings.critical = true;
    let mut world = started(&plan);
    assert_eq!(running(&world), [0, 1]);
    world.pass(0);
    assert_eq!(running(&world), [1]);
    fail(&mut world, 1, false);
    world.finish();
    assert_eq!(verdicts(&world), ["passed", "failed", "skipped", "skipped"]);
}

#[test]
fn a_user_stops_one_test_and_the_others_continue() {
    let mut plan = plan(0, 3, 2);
    plan.tests[1].settings.repetitions = 2;
    let mut world = started(&plan);
    world.feed(Input::StopTest(TestId(1), "a user".to_owned()));
    interrupted(&mut world, 1);
    assert_eq!(running(&world), [0, 2]);
    world.pass(0);
    world.pass(2);
    world.finish();
    assert_eq!(verdicts(&world), ["passed", "interrupted", "passed"]);
}

#[test]
fn a_signal_and_the_suite_timeout_stop_all_tests() {
    let mut plan = plan(0, 3, 2);
    plan.settings.timeout = Some(SECOND);
    for by_signal in [true, false] {
        let mut world = started(&plan);
        if by_signal {
            world.stop(StopLevel::TearDown);
        } else {
            assert_eq!(world.next_deadline(), Deadline::Suite);
            world.input(test(0), ProcessEvent::StackDumped("main".to_owned()));
            world.input(test(1), ProcessEvent::StackDumped("main".to_owned()));
        }
        interrupted(&mut world, 1);
        interrupted(&mut world, 0);
        world.finish();
        let stopped = if by_signal { "interrupted" } else { "timed-out" };
        assert_eq!(verdicts(&world), [stopped, stopped, "skipped"]);
    }
}

#[test]
fn a_second_signal_kills_all_tests() {
    let plan = plan(0, 2, 2);
    let mut world = started(&plan);
    world.stop(StopLevel::Kill);
    assert_eq!(world.log.iter().filter(|line| line.contains("kill the tree")).count(), 2);
    world.exit(test(0), ExitStatus::Signal(9));
    world.exit(test(1), ExitStatus::Signal(9));
    world.finish();
}

#[test]
fn a_crash_affects_only_its_test() {
    let plan = plan(0, 2, 2);
    let mut world = started(&plan);
    world.phase(test(1), Phase::Run);
    world.exit(test(1), ExitStatus::Signal(11));
    world.pass(0);
    world.finish();
    assert_eq!(verdicts(&world), ["passed", "crashed"]);
}

#[test]
fn each_test_has_its_own_deadlines() {
    let mut plan = plan(0, 2, 2);
    let mut limits = *plan.tests[1].limits;
    limits.load = 3 * SECOND;
    plan.tests[1].limits = limits.into();
    let mut world = started(&plan);
    world.next_deadline();
    world.input(test(1), ProcessEvent::StackDumped("main".to_owned()));
    interrupted(&mut world, 1);
    world.pass(0);
    world.finish();
    assert_eq!(verdicts(&world), ["passed", "timed-out"]);
}

#[test]
fn a_delayed_retry_keeps_its_slot_and_blocks_no_test() {
    let mut plan = plan(0, 3, 2);
    plan.tests[0].settings.retries = Retries { count: 1, delay: 4 * SECOND };
    let mut world = started(&plan);
    fail(&mut world, 0, false);
    assert_eq!(running(&world), [1]);
    world.pass(1);
    assert_eq!(running(&world), [2]);
    while world.next_deadline() != Deadline::Retry(TestId(0)) {}
    assert_eq!(running(&world), [0, 2]);
    world.pass(0);
    world.pass(2);
    world.finish();
    assert!(world.record.is_green(), "{}", world.transcript());
}

#[test]
fn at_the_failure_limit_running_tests_finish() {
    let plan = plan(0, 4, 3);
    let mut world = World::new(&plan);
    world.machine = SuiteMachine::new(&plan, FailLimit::new(Some(1)));
    world.start();
    fail(&mut world, 1, false);
    world.pass(0);
    world.pass(2);
    world.finish();
    assert_eq!(verdicts(&world), ["passed", "failed", "passed", "skipped"]);
}

#[test]
fn a_check_that_fails_after_a_test_affects_it_and_the_running_ones() {
    let plan = plan(1, 3, 2);
    let mut world = started(&plan);
    assert_eq!(running(&world), [0, 1]);
    world.hides_liveness = true;
    world.pass(0);
    assert_eq!(running(&world), [1], "no other one has begun");
    world.hides_liveness = false;
    world.answer(FIXTURE, "failed");
    let stopping =
        |kind: &EventKind| matches!(kind, EventKind::TestStopping { test, .. } if test.0 == 1);
    assert!(world.events.iter().any(stopping), "{}", world.transcript());
    interrupted(&mut world, 1);
    world.tear_down(0);
    world.ready(1);
    world.pass(2);
    world.tear_down(0);
    world.finish();
    assert_eq!(verdicts(&world), ["collapsed", "collapsed", "passed"]);
}
