//! The outcome of the request that the host carries out.
//!
//! The runner decides the verdict from the messages, measurements and samples. The
//! host only has to know whether `run` is called after `setup`, and gives a reason
//! for problems that no message reports.

use rtf_model::Outcome;
use rtf_model::protocol::Answer;

/// The first problem of a request, if there is one.
#[derive(Clone, Debug, Default)]
pub(crate) struct RequestOutcome {
    first: Option<(Outcome, Option<String>)>,
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

    pub(crate) fn has_passed(&self) -> bool {
        self.first.is_none()
    }

    /// The answer, after which the next request begins.
    pub(crate) fn take_answer(&mut self) -> Answer {
        let (outcome, reason) = self.first.take().unwrap_or((Outcome::Passed, None));
        Answer { outcome, reason, subscriptions: Vec::new(), continues: false }
    }
}
