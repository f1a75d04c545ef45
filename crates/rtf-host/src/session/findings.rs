//! What a fixture reports about a running test.

use rtf_model::protocol::Notification;
use rtf_model::{Finding, Samples, TestId};

use super::Session;

impl Session {
    /// Reports a problem of a running test.
    pub fn finding(&self, finding: Finding) {
        self.notify(&Notification::Finding(finding));
    }

    /// Reports samples that were taken while a test runs.
    pub fn observed(&self, test: TestId, samples: Samples) {
        self.notify(&Notification::Observed { test, samples });
    }
}
