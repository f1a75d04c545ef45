//! The effects that one input leads to, and the time at which it came.

use std::time::Duration;

use rtf_model::protocol::Request;
use rtf_model::{Episode, EventKind, FixtureProvided, LeakedProcess, Message, MessageKind, Source};
use rtf_plan::plan::FixturePlan;
use serde_json::Value;

use super::io::{Deadline, Effect, HostId};
use crate::fixture_values::FixtureValues;

/// Collects the effects of one input.
#[derive(Debug)]
pub struct Context<'a> {
    now: Duration,
    effects: &'a mut Vec<Effect>,
    last_host: &'a mut u64,
    values: &'a mut FixtureValues,
    questions: &'a mut Questions,
    abandoned: Option<String>,
}

#[derive(Debug, Default)]
pub struct Questions {
    /// The number of the last one.
    last: u32,
    /// Why no operator can answer.
    unattended: Option<String>,
}

impl Questions {
    /// `unattended` is why no operator can answer, if none can.
    pub fn new(unattended: Option<String>) -> Self {
        Self { last: 0, unattended }
    }
}

impl<'a> Context<'a> {
    pub fn new(
        now: Duration,
        effects: &'a mut Vec<Effect>,
        last_host: &'a mut u64,
        values: &'a mut FixtureValues,
        questions: &'a mut Questions,
    ) -> Self {
        Self { now, effects, last_host, values, questions, abandoned: None }
    }

    pub fn now(&self) -> Duration {
        self.now
    }

    pub fn push(&mut self, effect: Effect) {
        self.effects.push(effect);
    }

    /// Sends a request, or without a number a notification.
    pub fn send(&mut self, host: HostId, id: Option<u64>, request: Request) {
        self.push(Effect::Send(host, id, Box::new(request)));
    }

    /// Reports an event, without secrets.
    pub fn emit(&mut self, kind: EventKind) {
        let kind = self.values.mask(kind);
        self.push(Effect::Emit(kind));
    }

    pub fn values(&self) -> &FixtureValues {
        self.values
    }

    /// Stores the parameters of an episode, also with the guard.
    pub fn begin_episode(&mut self, episode: Episode) {
        self.values.begin_episode(episode);
        self.push(Effect::KeepValues(Box::new(self.values.clone())));
    }

    /// Stores a value of a fixture, also with the guard.
    pub fn provide(&mut self, plan: &FixturePlan, index: usize, (name, value): (String, Value)) {
        let secret = plan.is_secret(&name);
        self.values.set(index, (&plan.name, &name), value.clone(), secret);
        self.push(Effect::KeepValues(Box::new(self.values.clone())));
        let value = (!secret).then_some(value);
        let fixture = plan.id;
        self.emit(EventKind::FixtureProvided(FixtureProvided { fixture, name, value, secret }));
    }

    pub fn report_leaked(&mut self, source: Source, processes: Vec<LeakedProcess>) {
        if !processes.is_empty() {
            self.emit(EventKind::ProcessesLeaked { source, processes });
        }
    }

    /// Sets a deadline `after` now.
    pub fn set(&mut self, deadline: Deadline, after: Duration) {
        self.push(Effect::SetDeadline(deadline, self.now.saturating_add(after)));
    }

    pub fn clear(&mut self, deadline: Deadline) {
        self.push(Effect::ClearDeadline(deadline));
    }

    /// Gives up a killed process that does not end, described as `process`.
    pub fn abandon(&mut self, process: String) {
        self.abandoned.get_or_insert(process);
    }

    /// The process that was given up, reported once.
    pub fn take_abandoned(&mut self) -> Option<String> {
        self.abandoned.take()
    }

    pub fn next_question(&mut self) -> u32 {
        self.questions.last += 1;
        self.questions.last
    }

    /// Why no operator can answer a question, if none can.
    pub fn unattended(&self) -> Option<String> {
        self.questions.unattended.clone()
    }

    pub fn next_host_id(&mut self) -> HostId {
        *self.last_host += 1;
        HostId(*self.last_host)
    }
}

/// An error that the runner reports on behalf of a process.
pub fn error_message(text: String) -> Message {
    Message::new(MessageKind::Error, text, None)
}
