//! Shared hosts: the tests that they served, and the resources that they used.

use std::collections::BTreeMap;

use crate::{Growth, Resource, TestId, Usage, UsageSeries};

/// A host itself may grow by so many bytes per test: its data for a plug-in
/// stay until it exits, because leftover threads of the plug-in may use them.
const EXPECTED_GROWTH_BYTES: f64 = 4096.0;

/// A host that served several tests in turn, in a suite in which tests are repeated.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HostRecord {
    /// The tests that it served, each once.
    pub tests: Vec<TestId>,
    /// Number of tests served at the last measurement; each repetition counts.
    pub tests_served: u32,
    /// Its resources after each of them.
    pub usage: UsageSeries,
}

/// Records the resources of the current host after it has served a test.
pub(super) fn record_usage(
    hosts: &mut Vec<HostRecord>,
    test: TestId,
    tests_served: Option<u32>,
    usage: Usage,
) {
    let tests_served = tests_served.unwrap_or(1);
    if tests_served == 1 || hosts.is_empty() {
        hosts.push(HostRecord::default());
    }
    let Some(host) = hosts.last_mut() else { return };
    host.tests_served = tests_served;
    host.usage.add(usage);
    // The repetitions of a test follow each other.
    if host.tests.last() != Some(&test) {
        host.tests.push(test);
    }
}

/// The hosts whose resources grew. Of several hosts that served the same
/// tests, the one with the most measurements counts.
pub(super) fn growing(hosts: &[HostRecord]) -> Vec<(&HostRecord, Vec<Growth>)> {
    let mut longest = BTreeMap::<&[TestId], &HostRecord>::new();
    for host in hosts {
        let known = longest.entry(&host.tests).or_insert(host);
        if known.usage.seen() < host.usage.seen() {
            *known = host;
        }
    }
    let is_expected = |growth: &Growth| {
        growth.resource == Resource::Memory && growth.each < EXPECTED_GROWTH_BYTES
    };
    let with_growth = longest.into_values().map(|host| {
        let growth = host.usage.growth().into_iter();
        (host, growth.filter(|growth| !is_expected(growth)).collect::<Vec<_>>())
    });
    with_growth.filter(|(_, growth)| !growth.is_empty()).collect()
}
