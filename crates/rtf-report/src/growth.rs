//! What fixtures and shared hosts use more and more of while tests are repeated.

use rtf_model::{Growth, HostRecord, Record, Resource, SuiteRecord, TestId};

use crate::words;

/// How many of the tests that a host served are named.
const NAMES: usize = 3;

/// Where names are to be understood.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Within {
    /// Where the suite is known.
    Suite,
    /// Among those of all suites.
    Run,
}

#[derive(Debug)]
pub(crate) struct Growing {
    /// A fixture's name, or whose host it is.
    pub name: String,
    /// What is to be known of it besides; empty for a fixture.
    pub what: String,
    growth: Vec<Growth>,
}

impl Growing {
    /// A line for each thing that grows: `memory grows by 1.02 MiB a test: from 8.13
    /// MiB to 48.9 MiB in 40 tests`.
    pub fn lines(&self) -> Vec<String> {
        lines(&self.growth)
    }

    /// The same as names and values: `growth.arm.memory` = `1069547.52`, which is
    /// bytes, descriptors or processes from one test to the next.
    pub fn properties(&self) -> Vec<(String, String)> {
        let property = |growth: &Growth| {
            let each = (growth.each * 1000.0).round() / 1000.0;
            (format!("growth.{}.{}", self.name, growth.resource.as_str()), each.to_string())
        };
        self.growth.iter().map(property).collect()
    }
}

/// A line for each thing that grows.
pub(crate) fn lines(growth: &[Growth]) -> Vec<String> {
    growth.iter().map(line).collect()
}

/// The fixtures of a suite that grow.
pub(crate) fn fixtures(record: &Record, suite: &SuiteRecord, within: Within) -> Vec<Growing> {
    let fixtures = suite.fixtures.iter().filter_map(|id| record.fixture(*id));
    let growing = fixtures.map(|fixture| Growing {
        name: match within {
            Within::Suite => fixture.plan.name.clone(),
            Within::Run => record.fixture_name(fixture.plan.fixture),
        },
        what: String::new(),
        growth: fixture.growth(),
    });
    growing.filter(|growing| !growing.growth.is_empty()).collect()
}

/// The hosts shared by tests of a suite that grow.
pub(crate) fn hosts(record: &Record, suite: &SuiteRecord, within: Within) -> Vec<Growing> {
    let growing = suite.growing_hosts().into_iter().map(|(host, growth)| Growing {
        name: name_of(record, host, within),
        what: format!("(shared, measured after {} tests)", host.usage.seen()),
        growth,
    });
    growing.collect()
}

/// `host of MoveTest, GripTest`
fn name_of(record: &Record, host: &HostRecord, within: Within) -> String {
    let name = |test: &TestId| match (within, record.tests.get(test.index())) {
        (Within::Suite, Some(test)) => test.plan.name.clone(),
        _ => record.full_name(*test),
    };
    let names: Vec<_> = host.tests.iter().take(NAMES).map(name).collect();
    let more = host.tests.len() - names.len();
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("host of {}{more}", names.join(", "))
}

fn line(growth: &Growth) -> String {
    let Growth { resource, each, from, to, tests } = *growth;
    let (what, amount): (_, fn(f64) -> String) = match resource {
        Resource::Memory => ("memory grows", words::bytes),
        Resource::Descriptors => ("open file descriptors grow", words::significant),
        Resource::Processes => ("processes grow", words::significant),
    };
    let [from, to] = [from, to].map(|number| amount(number as f64));
    format!("{what} by {} a test: from {from} to {to} in {tests} tests", amount(each))
}
