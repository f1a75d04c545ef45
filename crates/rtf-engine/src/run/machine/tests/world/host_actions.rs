//! Actions of hosts.

use rtf_model::protocol::{Notification, Reply};
use rtf_model::{ExitStatus, FixtureId, HookId, Message, MessageKind, Phase, Source, TestId};

use super::World;
use crate::run::machine::ProcessEvent;
use rtf_plan::plan::SuitePlan;

/// The first fixture.
pub const FIXTURE: Source = Source::Fixture(FixtureId(0));
/// The first test.
pub const TEST: Source = Source::Test(TestId(0));
/// The first hook.
pub const HOOK: Source = Source::Hook(HookId(0));

impl<'p> World<'p> {
    pub fn started(plan: &'p SuitePlan) -> Self {
        let mut world = Self::new(plan);
        world.start();
        world
    }

    /// The fixtures are ready, and the first test runs. The transcript begins here.
    pub fn running(plan: &'p SuitePlan) -> Self {
        let mut world = Self::started(plan);
        world.ready(plan.fixtures.len());
        world.phase(TEST, Phase::Run);
        world.restart_transcript();
        world
    }

    /// Set-up and `check` of the first fixtures pass.
    pub fn ready(&mut self, fixtures: usize) {
        for _ in ["set-up", "check"] {
            for fixture in 0..u32::try_from(fixtures).unwrap() {
                self.answer(Source::Fixture(FixtureId(fixture)), "passed");
            }
        }
    }

    pub fn collapse(&mut self, source: Source, reason: &str) {
        let reason = reason.to_owned();
        self.input(source, ProcessEvent::Notified(Notification::Collapsed { reason }));
    }

    /// A host answers and exits with code 0.
    pub fn end(&mut self, source: Source, outcome: &str) {
        self.answer(source, outcome);
        self.exit(source, ExitStatus::Code(0));
    }

    /// Answers the last request to a host.
    pub fn answer(&mut self, source: Source, outcome: &str) {
        let host = self.host_of(source);
        let asked = self.sent.iter().rev().find(|(to, id, _)| *to == host && id.is_some());
        let id = asked.and_then(|(_, id, _)| *id).expect("a request");
        let value = serde_json::json!({ "outcome": outcome, "reason": format!("says {outcome}") });
        self.input(source, ProcessEvent::Replied(id, Reply::Result(value)));
    }

    /// Set-up of a fixture passes; it subscribes to all notifications.
    pub fn set_up_subscribed(&mut self, fixture: u32) {
        let source = Source::Fixture(FixtureId(fixture));
        let topics = ["test-started", "test-finished"];
        let value = serde_json::json!({ "outcome": "passed", "subscriptions": topics });
        self.input(source, ProcessEvent::Replied(2, Reply::Result(value)));
    }

    pub fn phase(&mut self, source: Source, phase: Phase) {
        self.input(source, ProcessEvent::Notified(Notification::Phase { phase }));
    }

    pub fn failure(&mut self, source: Source, text: &str, critical: bool) {
        let kind = MessageKind::Failure;
        let message = Message {
            kind,
            text: text.to_owned(),
            location: None,
            comparison: None,
            critical,
            case: None,
            interval: None,
        };
        self.input(source, ProcessEvent::Notified(Notification::Message(message)));
    }

    /// A fixture passes its examination.
    pub fn pass_examination(&mut self, fixture: u32) {
        let source = Source::Fixture(FixtureId(fixture));
        self.input(source, ProcessEvent::Alive);
        self.answer(source, "passed");
    }

    /// A test passes all its phases.
    pub fn pass(&mut self, test: u32) {
        let source = Source::Test(TestId(test));
        for phase in [Phase::Setup, Phase::Run, Phase::TearDown] {
            self.phase(source, phase);
        }
        self.end(source, "passed");
    }

    /// Tear-down of a fixture passes.
    pub fn tear_down(&mut self, fixture: u32) {
        self.end(Source::Fixture(FixtureId(fixture)), "passed");
    }
}
