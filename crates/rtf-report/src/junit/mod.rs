//! The record of a run as a JUnit XML file, as Jenkins and GitLab read it.
//!
//! Each declared test is a test case, also when it was skipped or when the run died
//! before it, and so is each run of a hook. A test with cases has one for each of them. What JUnit has no word for (a fixture that collapsed, a run that
//! was interrupted) becomes a further case with an error, so that no server
//! shows as green what was not.

mod case;
mod hook;
mod problems;
mod test;
mod time;

use std::io::{self, Write};
use std::path::Path;

pub(crate) use test::attachments;

use quick_junit::{Report, TestCase, TestCaseStatus, TestSuite};
use rtf_model::{LeakedProcess, Record, SuiteRecord, TestRecord};

use crate::cases::TestCases;
use crate::growth::{self, Within};
use crate::{escape, explain, words};

/// Writes the JUnit report of a record. `folder` is the run's directory,
/// which contains the attachments.
///
/// # Errors
/// `out` cannot be written.
pub fn write(out: &mut dyn Write, record: &Record, folder: Option<&Path>) -> io::Result<()> {
    write_with(out, record, folder, &AsPlanned)
}

/// As [`write()`], with the names and the output of another runner.
///
/// # Errors
/// As for [`write()`].
pub(crate) fn write_with(
    out: &mut dyn Write,
    record: &Record,
    folder: Option<&Path>,
    style: &dyn Style,
) -> io::Result<()> {
    // In memory first: an error of `out` (a closed pipe) then stays what it is.
    let xml = report(record, folder, style).to_string().map_err(io::Error::other)?;
    out.write_all(xml.as_bytes())
}

/// Names and output by which a server continues the history of another runner.
pub(crate) trait Style {
    /// The name of a suite.
    fn suite_name<'r>(&self, suite: &'r SuiteRecord) -> &'r str {
        &suite.plan.name
    }

    /// Changes the test case of a test without cases.
    fn adapt(&self, _case: &mut TestCase, _suite: &SuiteRecord, _test: &TestRecord) {}
}

/// The names of the plan.
struct AsPlanned;

impl Style for AsPlanned {}

fn report(record: &Record, folder: Option<&Path>, style: &dyn Style) -> Report {
    let name = record.run.as_ref().map_or("rtf", |run| &run.run);
    let mut report = Report::new(text(name));
    report.timestamp = time::at(record, rtf_model::Micros(0));
    report.set_time(record.last_at.as_duration());
    let suites = record.suites.iter().map(|suite| test_suite(record, suite, (folder, style)));
    let of_run = problems::of_run(record);
    // Damage comes first: nothing that follows is certain.
    let (first, last) = if record.is_damaged() { (of_run, None) } else { (None, of_run) };
    report.add_test_suites(first.into_iter().chain(suites).chain(last));
    report
}

fn test_suite(
    record: &Record,
    suite: &SuiteRecord,
    (folder, style): (Option<&Path>, &dyn Style),
) -> TestSuite {
    let mut junit = TestSuite::new(text(style.suite_name(suite)));
    if let Some(started) = suite.started {
        junit.timestamp = time::at(record, started);
        junit.set_time(suite.finished.unwrap_or(record.last_at).since(started));
    }
    properties(&mut junit, record, suite);
    for test in suite.tests.iter().filter_map(|id| record.tests.get(id.index())) {
        let mut cases = case::of(record, test, folder);
        if let [case] = &mut cases[..]
            && TestCases::of(test).is_none()
        {
            style.adapt(case, suite, test);
        }
        junit.add_test_cases(cases);
    }
    for hook in suite.hooks.iter().filter_map(|id| record.hooks.get(id.index())) {
        junit.add_test_cases(hook::of(record, hook));
    }
    for fixture in suite.fixtures.iter().filter_map(|id| record.fixture(*id)) {
        if let Some(case) = problems::of_fixture(record, suite, fixture) {
            junit.add_test_case(case);
        }
    }
    junit
}

fn properties(junit: &mut TestSuite, record: &Record, suite: &SuiteRecord) {
    let mut add = |name: &str, value: &str| {
        if !value.is_empty() {
            junit.add_property((text(name), text(value)));
        }
    };
    if let Some(run) = &record.run {
        add("run", &run.run);
        add("rtf", &run.rtf);
        add("command", &words::command(&run.command));
        add("working-dir", &run.working_dir);
    }
    add("file", &suite.plan.file);
    add("description", &suite.plan.description);
    add("environment", &suite.plan.environment);
    let fixtures = growth::fixtures(record, suite, Within::Suite);
    let hosts = growth::hosts(record, suite, Within::Suite);
    for growing in fixtures.iter().chain(&hosts) {
        growing.properties().iter().for_each(|(name, value)| add(name, value));
    }
    for fixture in suite.fixtures.iter().filter_map(|id| record.fixture(*id)) {
        for value in &fixture.values {
            let name = format!("fixture.{}.{}", fixture.plan.name, value.name);
            // An empty value is listed, too. Parsers read a line break in an attribute as a space.
            let value = value.text();
            junit.add_property((escape::line(&name), escape::line(&value)));
        }
    }
}

/// A status with its type, message and description.
fn described(
    mut status: TestCaseStatus,
    kind: &str,
    message: &str,
    description: String,
) -> TestCaseStatus {
    status.set_message(text(message));
    status.set_type(kind);
    status.set_description(description);
    status
}

fn first_line(text: &str) -> &str {
    text.lines().next().unwrap_or_default()
}

/// Text that XML can hold and that means no harm: control characters are
/// written out, not dropped.
pub(crate) fn text(text: &str) -> String {
    escape::block(text).into_owned()
}

/// Adds leaked processes as properties; a case that passed
/// also has them in its standard error, which more servers show.
fn leaked(case: &mut TestCase, left: &[LeakedProcess], passed: bool) {
    for process in left {
        case.add_property(("leaked", explain::process(process).as_str()));
    }
    if passed && !left.is_empty() {
        let lines = explain::lines(|sink| explain::left(left, sink));
        case.set_system_err(lines.join("\n") + "\n");
    }
}
