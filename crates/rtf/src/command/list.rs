//! `rtf list`: the tests that `rtf run` would run, with the cases that are known before.

use std::borrow::Cow;
use std::io::{self, Write};
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_model::{ExpectedFailure, FindingSeverity, MonitorConfig, Parameter};
use rtf_plan::plan::{ListedCase, Plan, SuitePlan, TestPlan};
use rtf_report::escape;
use rtf_run::plan::{self, Planned};
use rtf_run::terminal;
use serde::Serialize;

use super::VerbResult;
use crate::cli::{ListArgs, ListFormat};
use crate::request::{self, config};

/// Lists tests.
pub fn run(mut args: ListArgs, matches: &ArgMatches) -> VerbResult {
    config::fill_results(&mut args.input, matches)?;
    let request = request::tests(&args.input)?;
    let planned = plan::plan(&request)?;
    print(&planned, args.format, args.monitors)
}

/// Prints the tests of a plan, and their monitors on request.
pub fn print(planned: &Planned, format: ListFormat, monitors: bool) -> VerbResult {
    planned.print_warnings()?;
    terminal::stdout(|out| match format {
        ListFormat::Text => write(&planned.plan, monitors, out),
        ListFormat::Json => write_json(&planned.plan, monitors, out),
    })?;
    Ok(ExitCode::SUCCESS)
}

fn write(plan: &Plan, with_monitors: bool, out: &mut dyn Write) -> io::Result<()> {
    for suite in &plan.suites {
        let monitors = if with_monitors { suite.monitors() } else { Vec::new() };
        for test in &suite.tests {
            let name = format!("{}/{}", suite.name, test.name);
            writeln!(out, "{}{}", escape::line(&name), notes(test))?;
            for case in test.known_cases().unwrap_or_default() {
                writeln!(out, "  {}{}", escape::line(&case.name), case_notes(&case))?;
            }
            for monitor in monitors.iter().filter(|monitor| monitor.judges(&test.name)) {
                writeln!(out, "  {}", escape::line(&describe(monitor)))?;
            }
        }
    }
    Ok(())
}

/// Describes a monitor: `stop  arm: elbow position: always(q <= 1.05rad)  (arm.limits.yaml:7:5)`.
fn describe(monitor: &MonitorConfig) -> String {
    let severity = monitor.severity.word();
    let location = monitor.location.to_string();
    let origin = monitor.origin.as_ref().unwrap_or(&location);
    format!("{severity:<8}  {}: {}  ({origin})", monitor.name, monitor.formula)
}

fn case_notes(case: &ListedCase) -> String {
    let disabled = case.disabled.then(|| "disabled".to_owned());
    in_parentheses(disabled.into_iter().chain(tags(&case.tags)).collect())
}

fn tags(tags: &[String]) -> impl Iterator<Item = String> {
    tags.iter().map(|tag| format!("#{}", escape::line(tag)))
}

fn in_parentheses(notes: Vec<String>) -> String {
    if notes.is_empty() { String::new() } else { format!("  ({})", notes.join(", ")) }
}

fn notes(test: &TestPlan) -> String {
    let mut notes = Vec::new();
    if test.settings.repetitions > 1 {
        notes.push(format!("{} times", test.settings.repetitions));
    }
    if test.settings.critical {
        notes.push("critical".to_owned());
    }
    if test.settings.exclusive {
        notes.push("exclusive".to_owned());
    }
    if let Some(expected) = &test.expected {
        notes.push(known_failure(expected));
    }
    notes.extend(tags(&test.tags));
    in_parentheses(notes)
}

/// Describes a known failure: `expected to be failed until 2027-01-31: #12`.
fn known_failure(expected: &ExpectedFailure) -> String {
    let mut text = match expected {
        ExpectedFailure { expired: true, until: Some(until), .. } => {
            format!("known failure, expired after {until}")
        }
        expected => {
            let verdicts: Vec<_> = expected.verdicts.iter().map(ToString::to_string).collect();
            let verb = if expected.quarantined { "quarantined" } else { "expected" };
            let until = expected.until.as_ref().map(|until| format!(" until {until}"));
            format!("{verb}: {}{}", verdicts.join(" or "), until.unwrap_or_default())
        }
    };
    for detail in expected.issue.iter().chain(&expected.reason) {
        text += &format!(", {}", escape::line(detail));
    }
    text
}

#[derive(Serialize)]
struct TestList<'p> {
    tests: Vec<ListedTest<'p>>,
}

/// A test; `docs/how-to/running.md` documents the fields.
#[derive(Serialize)]
struct ListedTest<'p> {
    suite: &'p str,
    name: &'p str,
    /// The argument with which `rtf run` runs only this test.
    select: Option<String>,
    file: &'p str,
    /// The line of its tag in the suite; 0 for a plug-in on the command line.
    line: u32,
    r#type: &'p str,
    plugin: String,
    tags: &'p [String],
    repetition: u32,
    critical: bool,
    exclusive: bool,
    /// The number of tests of its suite that may run at once.
    parallel: u32,
    /// Its values of a matrix.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    parameters: &'p [Parameter],
    /// Its known failure.
    #[serde(skip_serializing_if = "Option::is_none")]
    expected: Option<&'p ExpectedFailure>,
    /// The cases that it runs, if they are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    cases: Option<Vec<Cow<'p, ListedCase>>>,
    /// The monitors that judge it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    monitors: Vec<ListedMonitor>,
}

/// A monitor.
#[derive(Serialize)]
struct ListedMonitor {
    name: String,
    formula: String,
    severity: FindingSeverity,
    file: String,
    line: u32,
}

fn write_json(plan: &Plan, with_monitors: bool, out: &mut dyn Write) -> io::Result<()> {
    let tests = plan.suites.iter().flat_map(|suite| {
        let monitors = if with_monitors { suite.monitors() } else { Vec::new() };
        suite.tests.iter().map(move |test| listed(suite, test, &monitors)).collect::<Vec<_>>()
    });
    serde_json::to_writer_pretty(&mut *out, &TestList { tests: tests.collect() })?;
    writeln!(out)
}

fn listed<'p>(
    suite: &'p SuitePlan,
    test: &'p TestPlan,
    monitors: &[MonitorConfig],
) -> ListedTest<'p> {
    let judging = monitors.iter().filter(|monitor| monitor.judges(&test.name));
    ListedTest {
        suite: &suite.name,
        name: &test.name,
        select: (!suite.file.is_empty()).then(|| format!("{}::{}", suite.file, test.name)),
        file: &suite.file,
        line: test.line,
        r#type: &test.plugin.plugin_type,
        plugin: test.plugin.file.to_string_lossy().into_owned(),
        tags: &test.tags,
        repetition: test.settings.repetitions,
        critical: test.settings.critical,
        exclusive: test.settings.exclusive,
        parallel: suite.settings.parallel,
        parameters: test.parameters(),
        expected: test.expected.as_deref(),
        cases: test.known_cases(),
        monitors: judging.map(ListedMonitor::of).collect(),
    }
}

impl ListedMonitor {
    fn of(monitor: &MonitorConfig) -> Self {
        Self {
            name: monitor.name.clone(),
            formula: monitor.formula.clone(),
            severity: monitor.severity,
            file: monitor.location.file.clone(),
            line: monitor.location.line,
        }
    }
}
