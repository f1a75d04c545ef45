//! How many tests shared hosts have served. A suite has one at a time.

use std::collections::BTreeMap;

use crate::SuiteId;

/// By suites, how many tests the host of the last one had served.
#[derive(Clone, Debug, Default)]
pub(super) struct Served(BTreeMap<SuiteId, u32>);

impl Served {
    /// A host has served so many tests: one more than before, or it is another host.
    pub fn test(&mut self, suite: SuiteId, tests_served: u32) -> Result<(), String> {
        let before = self.0.insert(suite, tests_served).unwrap_or_default();
        match tests_served == 1 || tests_served == before.saturating_add(1) {
            true => Ok(()),
            false => {
                Err(format!("a host of suite {suite} serves test {tests_served} after {before}"))
            }
        }
    }
}
