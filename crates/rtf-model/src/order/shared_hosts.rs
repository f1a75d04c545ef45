//! How many tests a shared host has served. A suite has one shared host at a time.

use std::collections::BTreeMap;

use crate::SuiteId;

/// By suite: how many tests its current host has served.
#[derive(Clone, Debug, Default)]
pub(super) struct TestsServed(BTreeMap<SuiteId, u32>);

impl TestsServed {
    /// A host has served one test more than before, or it is a new host.
    pub fn record(&mut self, suite: SuiteId, tests_served: u32) -> Result<(), String> {
        let before = self.0.insert(suite, tests_served).unwrap_or_default();
        match tests_served == 1 || tests_served == before.saturating_add(1) {
            true => Ok(()),
            false => {
                Err(format!("a host of suite {suite} serves test {tests_served} after {before}"))
            }
        }
    }
}
