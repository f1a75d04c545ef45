//! The effects that one input leads to, and the time at which it came.

use std::time::Duration;

use rtf_model::{EventKind, LeakedProcess, Message, MessageKind, Source};

use super::io::{Deadline, Effect, HostId};

/// Collects the effects of one input.
#[derive(Debug)]
pub struct Context<'a> {
    now: Duration,
    effects: &'a mut Vec<Effect>,
    last_host: &'a mut u64,
    abandoned: Option<String>,
}

impl<'a> Context<'a> {
    pub fn new(now: Duration, effects: &'a mut Vec<Effect>, last_host: &'a mut u64) -> Self {
        Self { now, effects, last_host, abandoned: None }
    }

    pub fn now(&self) -> Duration {
        self.now
    }

    pub fn push(&mut self, effect: Effect) {
        self.effects.push(effect);
    }

    pub fn emit(&mut self, kind: EventKind) {
        self.push(Effect::Emit(kind));
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

    pub fn next_host_id(&mut self) -> HostId {
        *self.last_host += 1;
        HostId(*self.last_host)
    }
}

/// An error that the runner reports on behalf of a process.
pub fn error_message(text: String) -> Message {
    let (kind, location, comparison) = (MessageKind::Error, None, None);
    Message { kind, text, location, comparison, critical: false, case: None }
}
