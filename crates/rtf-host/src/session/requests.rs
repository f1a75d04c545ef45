//! The requests of the runner: they are queued, begin, may be interrupted, and are answered.

use std::sync::PoisonError;
use std::sync::atomic::Ordering;

use rtf_model::protocol::{Answer, Notification, Reply, RpcError};
use rtf_model::{Outcome, Phase};
use serde::Serialize;

use super::Session;
use crate::decode::Incoming;
use crate::unix;

impl Session {
    /// Queues a request that was read.
    pub(crate) fn push(&self, incoming: Incoming) {
        self.state().incoming.push_back(incoming);
        self.0.changed.notify_all();
    }

    /// Asks the plug-in to stop, and returns whether one runs. If not, the runner's
    /// notification crossed the answer. A number limits the stop to that request.
    pub(crate) fn request_stop(&self, reason: &str, request: Option<u64>) -> bool {
        // A thread that holds the lock is about to send.
        if let Ok(mut sampling) = self.0.sampling.try_lock() {
            sampling.send(&self.0.writer);
        }
        let mut state = self.state();
        let is_asked = match (request, state.busy) {
            (None, busy) => busy || !state.incoming.is_empty(),
            (Some(_), true) => state.request == request,
            (Some(_), false) => state.incoming.front().is_some_and(|next| next.id() == request),
        };
        if is_asked {
            state.outcome.record(Outcome::Interrupted, reason);
            state.stop_reason.get_or_insert_with(|| reason.to_owned());
            self.0.stop.store(true, Ordering::Release);
            self.0.changed.notify_all();
        }
        is_asked
    }

    /// The runner is gone: ends the process if a plug-in is loaded.
    pub(crate) fn close(&self) {
        let mut state = self.state();
        if state.has_plugin {
            unix::exit_now(1);
        }
        state.closed = true;
        self.0.changed.notify_all();
    }

    /// Begins a request that was read on the main thread.
    pub(crate) fn begin(&self, incoming: &Incoming) {
        let mut state = self.state();
        (state.busy, state.request) = (true, incoming.id());
    }

    /// The next request, `None` at the end of the channel.
    pub(crate) fn next(&self) -> Option<Incoming> {
        let mut state = self.state();
        loop {
            if let Some(incoming) = state.incoming.pop_front() {
                (state.busy, state.request) = (true, incoming.id());
                return Some(incoming);
            }
            if state.closed {
                return None;
            }
            state = self.0.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Records whether a plug-in is loaded, or about to be.
    pub(crate) fn set_has_plugin(&self, has_plugin: bool) {
        self.state().has_plugin = has_plugin;
    }

    /// Announces a phase of the test.
    pub(crate) fn phase(&self, phase: Phase) {
        self.0.cases.set_phase(phase);
        self.notify(&Notification::Phase { phase });
        if phase == Phase::Setup {
            self.sampling().begin();
        }
    }

    /// Whether the present request has no problem so far.
    pub(crate) fn has_passed(&self) -> bool {
        self.state().outcome.has_passed()
    }

    /// Records a problem of the present request that no message reports.
    pub(crate) fn record(&self, outcome: Outcome, reason: &str) {
        self.state().outcome.record(outcome, reason);
    }

    /// Records that a function stopped. It decides only if the plug-in reported nothing.
    pub(crate) fn record_stopped(&self, reason: &str) {
        self.state().outcome.record_stopped(reason);
    }

    /// Records that the runner gets a problem of the present request, if there is one:
    /// threads of a fixture also report between requests.
    pub(super) fn record_reported(&self, outcome: Outcome) {
        self.0.cases.record_problem();
        let mut state = self.state();
        if state.busy {
            state.outcome.record_reported(outcome);
        }
    }

    /// Resets the stop request, so that a tear-down that parks the robot can wait until
    /// the runner asks again.
    pub(crate) fn clear_stop(&self) {
        let mut state = self.state();
        state.stop_reason = None;
        self.0.stop.store(false, Ordering::Release);
    }

    /// Ends the present request and returns its answer.
    pub(crate) fn conclude(&self) -> Answer {
        self.0.cases.end_attempt();
        let mut state = self.state();
        state.busy = false;
        state.stop_reason = None;
        self.0.stop.store(false, Ordering::Release);
        state.outcome.take_answer()
    }

    /// Ends a request that concerned no plug-in. A stop request for the next one stays.
    pub(crate) fn end_without_plugin(&self) {
        self.state().busy = false;
    }

    /// Answers a request. A request without a number gets no answer.
    pub(crate) fn answer<T: Serialize>(&self, id: Option<u64>, result: T) {
        self.flush();
        if id.is_some() {
            self.0.writer.send(id, &Reply::Result(result));
        }
    }

    pub(crate) fn refuse(&self, id: Option<u64>, error: RpcError) {
        self.0.writer.send(id, &Reply::<()>::Error(error));
    }
}
