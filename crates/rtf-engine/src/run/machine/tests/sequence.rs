//! The sequence of events without a collapse.

use insta::assert_snapshot;
use rtf_model::{ExitStatus, FixtureId, Source, TestId, Verdict};

use super::world::{FIXTURE, TEST, World, suite};
use crate::run::machine::{ProcessEvent, StopLevel};

#[test]
fn fixtures_are_set_up_in_order_and_torn_down_in_reverse() {
    let plan = suite(2, 1);
    let mut world = World::started(&plan);
    world.ready(2);
    world.pass(0);
    world.tear_down(1);
    world.tear_down(0);
    world.finish();
    assert_snapshot!(world.transcript(), @"
    0.0  suite-started
    0.0  fixture-starting attempt=1 fixture=0
    0.0  fixture-ready fixture=0
    0.0  fixture-starting attempt=1 fixture=1
    0.0  fixture-ready fixture=1
    0.0  test-started attempt=1 repetition=1 test=0
    0.0  test-phase phase=setup test=0
    0.0  test-phase phase=run test=0
    0.0  test-phase phase=tear-down test=0
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=exit test=0 verdict=passed
    0.0  fixture-stopping fixture=1
    0.0    → close the channel
    0.0  fixture-stopped fixture=1
    0.0  fixture-stopping fixture=0
    0.0    → close the channel
    0.0  fixture-stopped fixture=0
    0.0  suite-finished
    ");
    assert!(world.record.is_green());
}

/// Defect 5 of the predecessor: the first fixture was never torn down.
#[test]
fn when_the_second_set_up_fails_the_first_fixture_is_torn_down() {
    let plan = suite(2, 2);
    let mut world = World::started(&plan);
    world.answer(FIXTURE, "passed");
    world.answer(Source::Fixture(FixtureId(1)), "error");
    world.tear_down(1);
    world.tear_down(0);
    world.finish();
    assert_snapshot!(world.transcript(), @"
    0.0  suite-started
    0.0  fixture-starting attempt=1 fixture=0
    0.0  fixture-ready fixture=0
    0.0  fixture-starting attempt=1 fixture=1
    0.0  fixture-broken fixture=1 reason=set-up failed: says error
    0.0  fixture-stopping fixture=1
    0.0    → close the channel
    0.0  fixture-stopped fixture=1 problem=set-up failed: says error
    0.0  fixture-stopping fixture=0
    0.0    → close the channel
    0.0  fixture-stopped fixture=0
    0.0  test-skipped reason=fixture `fixture1` is broken: set-up failed: says error test=0
    0.0  test-skipped reason=fixture `fixture1` is broken: set-up failed: says error test=1
    0.0  suite-finished
    ");
    assert_eq!(world.record.totals().of(Verdict::Skipped), 2);
    assert!(!world.record.is_green());
}

#[test]
fn every_repetition_is_run() {
    let mut plan = suite(0, 1);
    plan.tests[0].settings.repetitions = 3;
    let mut world = World::started(&plan);
    for _ in 0..3 {
        assert_eq!(world.record.verdict(TestId(0)), None);
        world.pass(0);
    }
    world.finish();
    assert_eq!(world.record.tests[0].attempts.len(), 3);
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Passed));
}

#[test]
fn a_critical_assertion_skips_the_rest_and_tears_down() {
    let plan = suite(1, 3);
    let mut world = World::started(&plan);
    world.ready(1);
    let test = Source::Test(TestId(0));
    world.phase(test, rtf_model::Phase::Run);
    world.failure(test, "the emergency stop is pressed", true);
    world.end(test, "failed");
    world.next_deadline();
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Failed));
    assert_eq!(
        world.record.tests[2].reason(),
        Some("a critical assertion of `test0` did not hold: the emergency stop is pressed")
    );
}

#[test]
fn a_host_that_cannot_be_started_is_an_error_of_its_test_only() {
    let plan = suite(0, 2);
    let mut world = World::started(&plan);
    let reason = "no such file".to_owned();
    world.input(TEST, ProcessEvent::SpawnFailed(reason));
    world.pass(1);
    world.finish();
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Error));
    assert_eq!(world.record.tests[0].reason(), Some("no such file"));
}

#[test]
fn a_stop_request_interrupts_the_test_and_tears_down() {
    let plan = suite(1, 2);
    let mut world = World::started(&plan);
    world.ready(1);
    world.stop(StopLevel::TearDown);
    world.end(TEST, "interrupted");
    world.tear_down(0);
    world.finish();
    assert_snapshot!(world.transcript(), @"
    0.0  suite-started
    0.0  fixture-starting attempt=1 fixture=0
    0.0  fixture-ready fixture=0
    0.0  test-started attempt=1 repetition=1 test=0
    0.0  test-stopping cause=interrupt reason=stopped by SIGINT test=0
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=load reason=stopped by SIGINT test=0 verdict=interrupted
    0.0  fixture-stopping fixture=0
    0.0    → close the channel
    0.0  fixture-stopped fixture=0
    0.0  test-skipped reason=stopped by SIGINT test=1
    0.0  suite-finished
    ");
}

#[test]
fn a_second_stop_request_kills_everything_without_tear_down() {
    let plan = suite(2, 1);
    let mut world = World::started(&plan);
    world.answer(FIXTURE, "passed");
    world.stop(StopLevel::TearDown);
    world.stop(StopLevel::Kill);
    world.exit(Source::Fixture(FixtureId(1)), ExitStatus::Signal(9));
    world.exit(FIXTURE, ExitStatus::Signal(9));
    world.finish();
    assert_snapshot!(world.transcript(), @"
    0.0  suite-started
    0.0  fixture-starting attempt=1 fixture=0
    0.0  fixture-ready fixture=0
    0.0  fixture-starting attempt=1 fixture=1
    0.0  fixture-stopping fixture=1
    0.0    → kill the tree
    0.0  fixture-stopping fixture=0
    0.0    → kill the tree
    0.0  fixture-stopped fixture=1
    0.0  fixture-stopped fixture=0
    0.0  test-skipped reason=stopped by SIGINT test=0
    0.0  suite-finished
    ");
}

#[test]
fn a_stop_request_before_the_start_starts_nothing() {
    let plan = suite(1, 1);
    let mut world = World::new(&plan);
    world.stop(StopLevel::TearDown);
    world.start();
    world.finish();
    assert!(world.hosts.is_empty());
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Skipped));
}
