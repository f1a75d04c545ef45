//! Attached fixtures: monitored, neither started nor stopped.

use std::sync::Arc;

use insta::assert_snapshot;
use rtf_model::{ExitStatus, TestId, Verdict};

use super::world::{FIXTURE, SECOND, TEST, World, suite};
use crate::run::machine::{Deadline, FixtureTimer, ProcessEvent};
use rtf_plan::plan::{FixtureBody, Probe, ProbeKind, ProbePlans, SuitePlan};

fn plan() -> SuitePlan {
    let mut plan = suite(1, 2);
    let probe =
        Probe { kind: ProbeKind::Tcp("robot:5000".to_owned()), every: SECOND, timeout: SECOND };
    let attached =
        ProbePlans { ready: vec![probe.clone()], alive: vec![probe], values: Vec::new() };
    plan.fixtures[0].body = FixtureBody::Attached(Arc::new(attached));
    plan.fixtures[0].restart_delay = SECOND;
    plan
}

#[test]
fn an_attached_fixture_is_awaited_monitored_and_released() {
    let plan = plan();
    let mut world = World::started(&plan);
    world.now = SECOND;
    world.input(FIXTURE, ProcessEvent::ProbesPassed);
    world.input(FIXTURE, ProcessEvent::ProbeFailed("the robot is off".to_owned()));
    world.exit(TEST, ExitStatus::Code(0));
    world.exit(FIXTURE, ExitStatus::Code(0));
    world.next_deadline();
    world.now = 5 * SECOND;
    world.input(FIXTURE, ProcessEvent::ProbesPassed);
    world.pass(1);
    world.exit(FIXTURE, ExitStatus::Code(0));
    world.finish();
    assert_snapshot!(world.transcript(), @"
    0.0  suite-started
    0.0  fixture-starting attempt=1 fixture=0
    1.0  fixture-ready fixture=0
    1.0    → WatchAlive(HostId(1))
    1.0  test-started attempt=1 repetition=1 test=0
    1.0  fixture-collapsed fixture=0 reason=the robot is off
    1.0  test-stopping cause=collapse reason=fixture `fixture0` collapsed: the robot is off test=0
    1.0  test-finished exit={code:0} phase=load reason=fixture `fixture0` collapsed: the robot is off test=0 verdict=collapsed
    1.0  fixture-stopping fixture=0
    1.0    → close the channel
    1.0  fixture-stopped fixture=0
    2.0  fixture-starting attempt=2 fixture=0
    5.0  fixture-ready fixture=0
    5.0    → WatchAlive(HostId(3))
    5.0  test-started attempt=1 repetition=1 test=1
    5.0  test-phase phase=setup test=1
    5.0  test-phase phase=run test=1
    5.0  test-phase phase=tear-down test=1
    5.0    → close the channel
    5.0  test-finished exit={code:0} phase=exit test=1 verdict=passed
    5.0  fixture-stopping fixture=0
    5.0    → close the channel
    5.0  fixture-stopped fixture=0
    5.0  suite-finished
    ");
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed));
}

#[test]
fn a_missing_attached_fixture_reports_the_failing_probe() {
    let plan = plan();
    let mut world = World::started(&plan);
    for reason in ["refused", "no route to the robot"] {
        world.input(FIXTURE, ProcessEvent::ProbePending(reason.to_owned()));
    }
    assert_eq!(world.next_deadline(), Deadline::Fixture(0, FixtureTimer::Limit));
    world.exit(FIXTURE, ExitStatus::Code(0));
    world.finish();
    assert_eq!(
        world.record.fixtures[0].broken.as_deref(),
        Some("set-up failed: it was not ready within 10s: no route to the robot")
    );
}
