//! The outcome of the request that the host carries out.
//!
//! The runner decides the verdict from the messages, measurements and samples. The
//! host only has to know whether `run` is called after `setup`, and gives a reason
//! for problems that no message reports.

use rtf_model::Outcome;
use rtf_model::protocol::Answer;

/// The first problem of a request, or why the test skipped itself.
#[derive(Clone, Debug, Default)]
pub(crate) struct RequestOutcome {
    first: Option<(Outcome, Option<String>)>,
    skip_reason: Option<String>,
}

impl RequestOutcome {
    /// Records a problem that the runner knows from a message, measurement or sample.
    pub(crate) fn record_reported(&mut self, outcome: Outcome) {
        self.first.get_or_insert((outcome, None));
    }

    /// Records a problem that only the answer reports.
    pub(crate) fn record(&mut self, outcome: Outcome, reason: &str) {
        self.first.get_or_insert_with(|| (outcome, Some(reason.to_owned())));
    }

    /// Records that the test skipped itself. A problem has precedence.
    pub(crate) fn skip(&mut self, reason: &str) {
        self.skip_reason.get_or_insert_with(|| reason.to_owned());
    }

    /// Records that a function stopped. Without a problem or a skip, it is an error: the
    /// plug-in must not pass.
    pub(crate) fn record_stopped(&mut self, reason: &str) {
        if self.skip_reason.is_none() {
            self.record(Outcome::Error, reason);
        }
    }

    pub(crate) fn has_passed(&self) -> bool {
        self.first.is_none() && self.skip_reason.is_none()
    }

    /// The answer, after which the next request begins.
    pub(crate) fn take_answer(&mut self) -> Answer {
        let skipped = self.skip_reason.take().map(|reason| (Outcome::Skipped, Some(reason)));
        let (outcome, reason) = self.first.take().or(skipped).unwrap_or((Outcome::Passed, None));
        Answer { outcome, reason, subscriptions: Vec::new(), continues: false }
    }
}
