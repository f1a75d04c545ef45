//! Tests that share a host.

use rtf_model::protocol::{Reply, Request};
use rtf_model::{ExitStatus, Phase, Source, TestId, Usage, Verdict};

use super::world::{World, suite};
use crate::run::machine::{HostId, HostInput, Input, StopLevel};
use rtf_plan::plan::SuitePlan;
use rtf_process::codec::INITIALIZE;

impl World<'_> {
    /// A host that has answered goes on to the test that it was asked for, or waits.
    pub fn release(&mut self, host: HostId) {
        self.answered.remove(&host);
        self.hosts.remove(&host);
        if !self.begin_joined(host) {
            self.idle.insert(host);
        }
        self.feed(Input::Host(host, HostInput::Released));
    }

    /// A host begins the test that it was asked for; false when there is none.
    pub fn begin_joined(&mut self, on: HostId) -> bool {
        let Some((host, source, request)) = self.joined.remove(&on) else { return false };
        self.idle.remove(&on);
        self.hosts.insert(host, source);
        self.sent.push((host, Some(request), Request::DumpStack {}));
        true
    }

    /// A host that has nothing to do ends.
    pub fn end_idle(&mut self, host: HostId, status: ExitStatus) {
        self.idle.remove(&host);
        match self.joined.remove(&host) {
            Some((next, ..)) => self.feed(Input::Host(next, HostInput::Unbegun(status))),
            None => self.feed(Input::Host(host, HostInput::Exited(status, Vec::new()))),
        }
    }
}

fn shared(fixtures: usize, tests: usize) -> SuitePlan {
    let mut plan = suite(fixtures, tests);
    plan.tests.iter_mut().for_each(|test| test.shared = true);
    plan
}

fn source(test: u32) -> Source {
    Source::Test(TestId(test))
}

/// The host says that it can be shared.
fn initialized(world: &mut World<'_>, test: u32) {
    let value = serde_json::json!({ "protocol": 1, "host": "h", "supports_shared": true });
    world.input(source(test), HostInput::Answered(INITIALIZE, Reply::Result(value)));
}

/// A test goes through its phases and is answered; its host stays.
pub(super) fn stays(world: &mut World<'_>, test: u32) -> HostId {
    for phase in [Phase::Setup, Phase::Run, Phase::TearDown] {
        world.phase(source(test), phase);
    }
    let host = world.host_of(source(test));
    let asked = world.sent.iter().rev().find(|(to, id, _)| *to == host && id.is_some());
    let id = asked.and_then(|(_, id, _)| *id).expect("a request");
    let value = serde_json::json!({ "outcome": "passed", "continues": true });
    world.input(source(test), HostInput::Answered(id, Reply::Result(value)));
    host
}

#[test]
fn a_host_is_asked_for_the_next_test_while_the_present_one_runs() {
    let plan = shared(0, 3);
    let mut world = World::started(&plan);
    let host = world.host_of(source(0));
    assert!(world.joined.is_empty(), "not before it is known that it can");
    initialized(&mut world, 0);
    assert!(world.joined.contains_key(&host));
    for test in [0, 1] {
        let host = stays(&mut world, test);
        assert_eq!(world.record.verdict(TestId(test)), None, "the next one has not begun");
        world.release(host);
        assert_eq!(world.record.verdict(TestId(test)), Some(Verdict::Passed));
    }
    world.pass(2);
    world.finish();
    assert_eq!(world.record.verdict(TestId(2)), Some(Verdict::Passed));
}

#[test]
fn what_a_host_uses_is_told_before_it_gets_the_next_repetition() {
    let mut plan = shared(0, 1);
    plan.tests[0].repetitions = 3;
    let mut world = World::started(&plan);
    initialized(&mut world, 0);
    for served in 1..=2 {
        let host = stays(&mut world, 0);
        assert!(world.joined.is_empty(), "it is looked at first");
        let usage = Usage { processes: 1, memory: 4096, descriptors: 9 };
        world.input(source(0), HostInput::Uses { usage, tests_served: Some(served) });
        world.release(host);
        assert!(world.joined.contains_key(&host), "then it is asked again");
        world.begin_joined(host);
    }
    world.pass(0);
    world.finish();
    let hosts = &world.record.suites[0].hosts;
    assert_eq!((hosts.len(), hosts[0].tests_served, hosts[0].usage.seen()), (1, 2, 2));
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Passed));
}

#[test]
fn a_host_that_dies_before_the_next_test_begins_is_the_present_tests() {
    let plan = shared(0, 2);
    let mut world = World::started(&plan);
    initialized(&mut world, 0);
    stays(&mut world, 0);
    world.exit(source(0), ExitStatus::Signal(11));
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Crashed));
    world.pass(1);
    world.finish();
    assert_eq!(world.record.verdict(TestId(1)), Some(Verdict::Passed));
}

#[test]
fn a_host_that_dies_idle_is_nobodys_and_the_next_test_gets_another() {
    let plan = shared(1, 2);
    let mut world = World::started(&plan);
    let fixture = Source::Fixture(rtf_model::FixtureId(0));
    world.answer(fixture, "passed");
    world.answer(fixture, "passed");
    initialized(&mut world, 0);
    let host = stays(&mut world, 0);
    assert!(world.joined.is_empty(), "the fixture is asked first");
    world.release(host);
    world.answer(fixture, "passed");
    assert!(world.joined.contains_key(&host));
    world.end_idle(host, ExitStatus::Signal(6));
    assert!(world.story().contains("shared-host-ended"), "{}", world.story());
    world.pass(1);
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.verdict(TestId(1)), Some(Verdict::Passed));
}

#[test]
fn a_stop_that_crosses_the_answer_stops_the_next_test_too() {
    let plan = shared(0, 3);
    let mut world = World::started(&plan);
    initialized(&mut world, 0);
    let host = stays(&mut world, 0);
    world.stop(StopLevel::TearDown);
    world.release(host);
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Interrupted));
    world.exit(source(1), ExitStatus::Code(0));
    world.finish();
    assert_eq!(world.record.verdict(TestId(1)), Some(Verdict::Interrupted));
    assert_eq!(world.record.final_verdict(TestId(2)), Verdict::Skipped);
}

#[test]
fn a_host_without_a_test_is_ended_with_the_suite() {
    let plan = shared(1, 2);
    let mut world = World::started(&plan);
    let fixture = Source::Fixture(rtf_model::FixtureId(0));
    world.answer(fixture, "passed");
    world.answer(fixture, "passed");
    let host = stays(&mut world, 0);
    world.unseen = true;
    world.release(host);
    world.feed(Input::Skip("a person".to_owned()));
    world.examined(0);
    world.tear_down(0);
    assert!(!world.done, "its end is awaited");
    assert!(world.story().contains("kill the tree"), "{}", world.story());
    world.end_idle(host, ExitStatus::Signal(9));
    world.finish();
}
