//! What fixtures use more and more of while tests are repeated.

use rtf_model::{FixtureRecord, Growth, Resource};

use crate::words;

/// A line for each thing that grows: `memory grows by 1.02 MiB a test: from 8.13
/// MiB to 48.9 MiB in 40 tests`.
pub(crate) fn lines(fixture: &FixtureRecord) -> Vec<String> {
    fixture.growth().iter().map(line).collect()
}

/// The same as names and values: `growth.arm.memory` = `1069547.52`, which is
/// bytes, descriptors or processes from one test to the next.
pub(crate) fn properties(fixture: &FixtureRecord) -> Vec<(String, String)> {
    let name = &fixture.plan.name;
    let property = |growth: &Growth| {
        let each = (growth.each * 1000.0).round() / 1000.0;
        (format!("growth.{name}.{}", growth.resource.as_str()), each.to_string())
    };
    fixture.growth().iter().map(property).collect()
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
