//! Cases and skips of the plug-in.

use rtf_model::protocol::{CaseSelector, EpisodeSlots, Notification};
use rtf_model::{CaseId, CaseStart, Location, Parameter};

use super::Session;
use crate::cases::{CaseEnd, CaseError};

impl Session {
    /// Starts a case of the test on the calling thread. Returns whether its body runs; if
    /// not, it is not selected, or not allowed here, or the test is stopping. Otherwise call
    /// [`Self::end_case`] after the body.
    pub fn begin_case(
        &self,
        name: String,
        parameters: Vec<Parameter>,
        location: Option<Location>,
    ) -> bool {
        let start = CaseStart { parameters, location, ..CaseStart::new(CaseId(0), name) };
        let send = |started: &Notification| self.notify_case(started);
        self.allowed(self.0.cases.begin(start, self.interrupted(), send)).unwrap_or(false)
    }

    /// Finishes the innermost case of the calling thread.
    pub fn end_case(&self, end: CaseEnd) {
        let send = |finished: &Notification| self.notify_case(finished);
        self.allowed(self.0.cases.end(end, self.interrupted(), send));
    }

    /// Announces top-level cases.
    pub fn plan_cases(&self, names: Vec<String>) {
        self.allowed(self.0.cases.plan(names, |planned| self.notify_case(planned)));
    }

    /// Skips the innermost case of the calling thread, or the test if it has none. The
    /// plug-in then leaves the case or the step.
    pub fn skip(&self, reason: &str) {
        if self.allowed(self.0.cases.skip(reason)) == Some(true) {
            self.state().outcome.skip(reason);
        }
    }

    /// Reports a call that is not allowed here as an error of the plug-in.
    pub(super) fn allowed<T>(&self, result: Result<T, CaseError>) -> Option<T> {
        result.map_err(|error| self.error(error.to_string(), None)).ok()
    }

    /// Begins an attempt of a test with these selected cases or slots, on the calling thread.
    pub(crate) fn begin_attempt(&self, cases: &[CaseSelector], slots: Option<EpisodeSlots>) {
        self.0.cases.begin_attempt(cases, slots);
        self.begin_episodes(slots);
    }

    /// Sends a notification about cases; false if it is too long.
    pub(super) fn notify_case(&self, notification: &Notification) -> bool {
        self.flush();
        self.0.writer.send(None, notification)
    }
}
