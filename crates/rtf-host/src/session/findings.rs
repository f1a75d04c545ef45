//! What a fixture reports about a running test, and the monitors of a test.

use rtf_model::protocol::{MonitorDeclaration, Notification};
use rtf_model::{FaultInjected, Finding, Samples, TestId};

use super::Session;

impl Session {
    /// Reports a problem of a running test.
    pub fn finding(&self, finding: Finding) {
        self.notify(&Notification::Finding(finding));
    }

    /// Declares a formula that judges the rest of the test.
    pub fn monitor(&self, monitor: MonitorDeclaration) {
        self.notify(&Notification::Monitor(monitor));
    }

    /// Reports samples that were taken while a test runs.
    pub fn observed(&self, test: TestId, samples: Samples) {
        self.notify(&Notification::Observed { test, samples });
    }

    pub fn fault_injected(&self, fault: FaultInjected) {
        self.notify(&Notification::FaultInjected(fault));
    }

    pub fn fault_removed(&self, test: TestId, name: String) {
        self.notify(&Notification::FaultRemoved { test, name });
    }
}
