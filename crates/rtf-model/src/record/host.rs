//! What is known of the hosts that tests share.

use std::collections::BTreeMap;

use crate::{Growth, Resource, TestId, Usage, UsageSeries};

/// A host itself may grow by so many bytes from one test to the next: what it made for
/// a plug-in stays until it ends, since threads that the plug-in left may use it.
const OWN: f64 = 4096.0;

/// A host that served tests one after the other, in a suite in which tests are repeated.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HostRecord {
    /// The tests that it served, each once.
    pub tests: Vec<TestId>,
    /// How many tests it had served when it was measured last; each repetition counts.
    pub tests_served: u32,
    /// What it used after each of them.
    pub usage: UsageSeries,
}

/// The host of a suite that lives has served a test.
pub(super) fn uses(
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

/// The hosts that used more and more, and what; of those that served the same
/// tests, the one that was measured most.
pub(super) fn growing(hosts: &[HostRecord]) -> Vec<(&HostRecord, Vec<Growth>)> {
    let mut longest = BTreeMap::<&[TestId], &HostRecord>::new();
    for host in hosts {
        let known = longest.entry(&host.tests).or_insert(host);
        if known.usage.seen() < host.usage.seen() {
            *known = host;
        }
    }
    let is_its_own = |growth: &Growth| growth.resource == Resource::Memory && growth.each < OWN;
    let with_growth = longest.into_values().map(|host| {
        let growth = host.usage.growth().into_iter();
        (host, growth.filter(|growth| !is_its_own(growth)).collect::<Vec<_>>())
    });
    with_growth.filter(|(_, growth)| !growth.is_empty()).collect()
}
