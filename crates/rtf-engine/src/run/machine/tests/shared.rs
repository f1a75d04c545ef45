//! Tests that share a host.

use rtf_model::protocol::{Reply, Request};
use rtf_model::{ExitStatus, Phase, Source, TestId, Trigger, Usage, Verdict};

use super::world::{World, hook, suite};
use crate::run::machine::{HostId, Input, ProcessEvent, StopLevel};
use rtf_plan::plan::SuitePlan;
use rtf_process::codec::INITIALIZE;

impl World<'_> {
    /// A host that has answered begins its assigned test or becomes idle.
    pub fn release(&mut self, host: HostId) {
        self.answered.remove(&host);
        self.hosts.remove(&host);
        if !self.begin_assigned(host) {
            self.idle.insert(host);
        }
        self.feed(Input::Host(host, ProcessEvent::Released));
    }

    /// A host begins its assigned test; false if there is none.
    pub fn begin_assigned(&mut self, on: HostId) -> bool {
        let Some((host, source, request)) = self.assigned.remove(&on) else { return false };
        self.idle.remove(&on);
        self.hosts.insert(host, source);
        self.sent.push((host, Some(request), Request::DumpStack {}));
        true
    }

    pub fn exit_idle(&mut self, host: HostId, status: ExitStatus) {
        self.idle.remove(&host);
        if !self.assigned.contains_key(&host) {
            self.feed(Input::Host(host, ProcessEvent::Exited(status, Vec::new())));
        }
        self.refuse_assigned(host, status);
    }

    /// A host that has ended begins none of its assigned tests.
    pub fn refuse_assigned(&mut self, host: HostId, status: ExitStatus) {
        let mut last = host;
        while let Some((next, ..)) = self.assigned.remove(&last) {
            self.feed(Input::Host(next, ProcessEvent::NotStarted(status)));
            last = next;
        }
    }
}

fn shared(fixtures: usize, tests: usize) -> SuitePlan {
    let mut plan = suite(fixtures, tests);
    plan.tests.iter_mut().for_each(|test| test.settings.shared = true);
    plan
}

fn source(test: u32) -> Source {
    Source::Test(TestId(test))
}

/// The host reports that it can be shared.
fn initialized(world: &mut World<'_>, test: u32) {
    let value = serde_json::json!({ "protocol": 1, "host": "h", "supports_shared": true });
    world.input(source(test), ProcessEvent::Replied(INITIALIZE, Reply::Result(value)));
}

/// A test passes, and its host stays alive.
pub(super) fn answer_and_continue(world: &mut World<'_>, test: u32) -> HostId {
    continue_after(world, test, None)
}

/// A test passes or has a failure, and its host stays alive.
pub(super) fn continue_after(world: &mut World<'_>, test: u32, failure: Option<&str>) -> HostId {
    for phase in [Phase::Setup, Phase::Run, Phase::TearDown] {
        world.phase(source(test), phase);
        let text = failure.filter(|_| phase == Phase::Run);
        text.into_iter().for_each(|text| world.failure(source(test), text, false));
    }
    let host = world.host_of(source(test));
    let asked = world.sent.iter().rev().find(|(to, id, _)| *to == host && id.is_some());
    let id = asked.and_then(|(_, id, _)| *id).expect("a request");
    let outcome = if failure.is_some() { "failed" } else { "passed" };
    let value = serde_json::json!({ "outcome": outcome, "continues": true });
    world.input(source(test), ProcessEvent::Replied(id, Reply::Result(value)));
    host
}

#[test]
fn a_host_is_assigned_the_next_test_while_the_present_one_runs() {
    let plan = shared(0, 3);
    let mut world = World::started(&plan);
    let host = world.host_of(source(0));
    assert!(world.assigned.is_empty(), "the host has not reported that it can be shared");
    initialized(&mut world, 0);
    assert!(world.assigned.contains_key(&host));
    for test in [0, 1] {
        let host = answer_and_continue(&mut world, test);
        assert_eq!(world.record.verdict(TestId(test)), None, "the next one has not begun");
        world.release(host);
        assert_eq!(world.record.verdict(TestId(test)), Some(Verdict::Passed));
    }
    world.pass(2);
    world.finish();
    assert_eq!(world.record.verdict(TestId(2)), Some(Verdict::Passed));
}

#[test]
fn several_tests_are_assigned_together() {
    let plan = shared(0, 30);
    let mut world = World::started(&plan);
    initialized(&mut world, 0);
    let assigned: Vec<_> = world.assigned.values().map(|(_, source, _)| *source).collect();
    assert_eq!(assigned, (1..=16).map(source).collect::<Vec<_>>());
    let counts = (0..29).map(|test| {
        let host = answer_and_continue(&mut world, test);
        world.release(host);
        world.assigned.len()
    });
    let counts: Vec<_> = counts.collect();
    assert_eq!(counts[..10], [15, 14, 13, 12, 11, 10, 9, 8, 16, 15]);
    world.pass(29);
    world.finish();
    assert!(plan.tests.iter().all(|test| world.record.verdict(test.id) == Some(Verdict::Passed)));
}

#[test]
fn a_host_that_crashes_begins_none_of_its_assigned_tests() {
    let plan = shared(0, 4);
    let mut world = World::started(&plan);
    initialized(&mut world, 0);
    let host = answer_and_continue(&mut world, 0);
    world.release(host);
    world.exit(source(1), ExitStatus::Signal(11));
    assert!(world.assigned.is_empty());
    initialized(&mut world, 2);
    let host = answer_and_continue(&mut world, 2);
    world.release(host);
    world.pass(3);
    world.finish();
    let verdicts = [0, 1, 2, 3].map(|test| world.record.verdict(TestId(test)).unwrap());
    assert_eq!(verdicts, [Verdict::Passed, Verdict::Crashed, Verdict::Passed, Verdict::Passed]);
}

/// The host does not know the failures, and continues.
#[test]
fn no_test_is_assigned_before_the_verdict_that_decides_whether_it_runs() {
    let mut plan = shared(0, 5);
    plan.tests[1].settings.retries.count = 1;
    plan.tests[2].settings.critical = true;
    let mut world = World::started(&plan);
    initialized(&mut world, 0);
    assert_eq!(world.assigned.len(), 1, "the next test has retries");
    let mut last = HostId(0);
    for (test, fails) in [(0, false), (1, true), (1, false), (2, true)] {
        if fails {
            world.failure(source(test), "it deviates", false);
        }
        last = answer_and_continue(&mut world, test);
        world.release(last);
        world.begin_assigned(last);
        assert!(world.assigned.is_empty());
    }
    world.exit_idle(last, ExitStatus::Signal(9));
    world.finish();
    assert_eq!(world.record.tests[1].attempts.len(), 2);
    assert_eq!(world.record.verdict(TestId(1)), Some(Verdict::Passed));
    assert_eq!(world.record.final_verdict(TestId(3)), Verdict::Skipped);
}

#[test]
fn no_test_is_assigned_before_a_hook_that_its_predecessor_may_trigger() {
    let mut plan = shared(0, 2);
    plan.hooks = vec![hook(0, &[Trigger::Failure])];
    let mut world = World::started(&plan);
    initialized(&mut world, 0);
    assert!(world.assigned.is_empty());
}

#[test]
fn resource_usage_is_reported_before_the_next_repetition() {
    let mut plan = shared(0, 1);
    plan.tests[0].settings.repetitions = 3;
    let mut world = World::started(&plan);
    initialized(&mut world, 0);
    for served in 1..=2 {
        let host = answer_and_continue(&mut world, 0);
        assert!(world.assigned.is_empty(), "its usage is measured first");
        let usage = Usage { processes: 1, memory: 4096, descriptors: 9 };
        world.input(
            source(0),
            ProcessEvent::ResourcesMeasured { usage, tests_served: Some(served) },
        );
        world.release(host);
        assert!(world.assigned.contains_key(&host), "then it is assigned the next one");
        world.begin_assigned(host);
    }
    world.pass(0);
    world.finish();
    let hosts = &world.record.suites[0].hosts;
    assert_eq!((hosts.len(), hosts[0].tests_served, hosts[0].usage.seen()), (1, 2, 2));
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Passed));
}

#[test]
fn a_host_that_crashes_before_the_next_test_begins_fails_the_present_one() {
    let plan = shared(0, 2);
    let mut world = World::started(&plan);
    initialized(&mut world, 0);
    answer_and_continue(&mut world, 0);
    world.exit(source(0), ExitStatus::Signal(11));
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Crashed));
    world.pass(1);
    world.finish();
    assert_eq!(world.record.verdict(TestId(1)), Some(Verdict::Passed));
}

#[test]
fn an_idle_host_that_crashes_fails_no_test_and_is_replaced() {
    let plan = shared(1, 2);
    let mut world = World::started(&plan);
    let fixture = Source::Fixture(rtf_model::FixtureId(0));
    world.answer(fixture, "passed");
    world.answer(fixture, "passed");
    initialized(&mut world, 0);
    let host = answer_and_continue(&mut world, 0);
    assert!(world.assigned.is_empty(), "the fixture is checked first");
    world.release(host);
    world.answer(fixture, "passed");
    assert!(world.assigned.contains_key(&host));
    world.exit_idle(host, ExitStatus::Signal(6));
    assert!(world.transcript().contains("shared-host-ended"), "{}", world.transcript());
    world.pass(1);
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.verdict(TestId(1)), Some(Verdict::Passed));
}

#[test]
fn a_stop_during_the_answer_also_stops_the_next_test() {
    let plan = shared(0, 3);
    let mut world = World::started(&plan);
    initialized(&mut world, 0);
    let host = answer_and_continue(&mut world, 0);
    world.stop(StopLevel::TearDown);
    world.release(host);
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Interrupted));
    world.exit(source(1), ExitStatus::Code(0));
    world.finish();
    assert_eq!(world.record.verdict(TestId(1)), Some(Verdict::Interrupted));
    assert_eq!(world.record.final_verdict(TestId(2)), Verdict::Skipped);
}

#[test]
fn an_idle_host_is_killed_at_the_end_of_the_suite() {
    let plan = shared(1, 2);
    let mut world = World::started(&plan);
    let fixture = Source::Fixture(rtf_model::FixtureId(0));
    world.answer(fixture, "passed");
    world.answer(fixture, "passed");
    let host = answer_and_continue(&mut world, 0);
    world.hides_liveness = true;
    world.release(host);
    world.feed(Input::Skip("a user".to_owned()));
    world.pass_examination(0);
    world.tear_down(0);
    assert!(!world.done, "the suite waits for its end");
    assert!(world.transcript().contains("kill the tree"), "{}", world.transcript());
    world.exit_idle(host, ExitStatus::Signal(9));
    world.finish();
}
