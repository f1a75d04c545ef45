//! The whole record of a run as plain text, for reading and for comparing.

mod cases;
mod fixtures;
mod hooks;
mod lines;
mod tests;

use std::io::{self, Write};

use rtf_model::{Record, SuiteRecord, TestRecord, Verdict};

use crate::cases::CaseTotals;
use crate::growth::{self, Within};
use crate::{explain, known_failure, private_resources, words};
use lines::TextLines;

/// Writes the text report of a record.
///
/// # Errors
/// `out` cannot be written.
pub fn write(out: &mut dyn Write, record: &Record) -> io::Result<()> {
    let mut lines = TextLines::default();
    head(&mut lines, record);
    lines.write_to(out)?;
    for suite in &record.suites {
        show_suite(&mut lines, out, record, suite)?;
    }
    result(&mut lines, record);
    lines.write_to(out)
}

/// Writes one test of a record.
///
/// # Errors
/// `out` cannot be written.
pub fn write_test(out: &mut dyn Write, record: &Record, test: &TestRecord) -> io::Result<()> {
    let mut lines = TextLines::default();
    head(&mut lines, record);
    let suite = record.suites.get(test.plan.suite.index());
    lines.at(0, "");
    lines.fact(0, "suite", suite.map_or("", |suite| &suite.plan.name));
    tests::show(&mut lines, record, test);
    lines.write_to(out)
}

/// Writes a record without its tests.
///
/// # Errors
/// `out` cannot be written.
pub fn write_without_tests(out: &mut dyn Write, record: &Record) -> io::Result<()> {
    let mut lines = TextLines::default();
    head(&mut lines, record);
    for suite in &record.suites {
        show_suite_head(&mut lines, record, suite);
        show_problems(&mut lines, record, suite);
    }
    lines.at(0, "");
    show_end(&mut lines, record);
    lines.write_to(out)
}

fn head(lines: &mut TextLines, record: &Record) {
    if record.is_damaged() {
        lines.at(0, "the journal of this run is damaged, what follows is incomplete:");
        record.damages.iter().for_each(|damage| lines.fact(2, "damage", &damage.to_string()));
    }
    let Some(run) = &record.run else {
        return lines.at(0, "run: the start of the journal is missing");
    };
    lines.fact(0, "run", &run.run);
    lines.fact(0, "started", &run.started_at);
    lines.fact(0, "command", &words::command(&run.command));
    lines.fact(0, "directory", &run.working_dir);
    lines.fact(0, "rtf", &run.rtf);
    for warning in &record.warnings {
        let place = warning.labels.first();
        let place = place.map(|at| format!("{}:{}:{}: ", at.file, at.line, at.column));
        lines.fact(0, "warning", &format!("{}{}", place.unwrap_or_default(), warning.message));
        for note in &warning.notes {
            lines.fact(2, "note", note);
        }
        if let Some(hint) = &warning.hint {
            lines.fact(2, "hint", hint);
        }
    }
}

fn show_suite(
    lines: &mut TextLines,
    out: &mut dyn Write,
    record: &Record,
    suite: &SuiteRecord,
) -> io::Result<()> {
    show_suite_head(lines, record, suite);
    for test in suite.tests.iter().filter_map(|id| record.tests.get(id.index())) {
        tests::show(lines, record, test);
        lines.write_to(out)?;
    }
    show_problems(lines, record, suite);
    lines.write_to(out)
}

/// Everything of a suite that precedes its tests.
fn show_suite_head(lines: &mut TextLines, record: &Record, suite: &SuiteRecord) {
    lines.at(0, "");
    lines.fact(0, "suite", &suite.plan.name);
    lines.fact(2, "file", &suite.plan.file);
    lines.fact(2, "description", &suite.plan.description);
    lines.fact(2, "environment", &suite.plan.environment);
    if suite.plan.tolerates_collapse {
        lines.at(2, "a collapse of a fixture is tolerated");
    }
    if let (Some(start), Some(end)) = (suite.started, suite.finished) {
        lines.at(2, &format!("time: {}", words::time(end.since(start))));
    }
    if let Some(prepared) = &suite.prepared {
        private_resources::show(prepared, &mut |_, line| lines.at(2, line));
    }
    for fixture in suite.fixtures.iter().filter_map(|id| record.fixture(*id)) {
        fixtures::show(lines, fixture);
    }
    for host in growth::hosts(record, suite, Within::Suite) {
        lines.fact(2, "grows", &format!("{} {}", host.name, host.what));
        host.lines().iter().for_each(|line| lines.at(4, line));
    }
    for hook in suite.hooks.iter().filter_map(|id| record.hooks.get(id.index())) {
        hooks::show(lines, record, hook);
    }
}

fn show_problems(lines: &mut TextLines, record: &Record, suite: &SuiteRecord) {
    for problem in record.suite_problems(suite.plan.suite) {
        lines.fact(2, "problem", &problem);
    }
}

fn show_end(lines: &mut TextLines, record: &Record) {
    if let Some(reason) = record.interrupted() {
        lines.fact(0, "interrupted", reason);
    }
    if let Some(reason) = record.runner_death() {
        lines.fact(0, "incomplete: the runner died", reason);
    } else if !record.is_complete() {
        lines.at(0, "incomplete: the runner did not reach the end of this run");
    }
}

fn result(lines: &mut TextLines, record: &Record) {
    lines.at(0, "");
    show_end(lines, record);
    let left = record.leaked_processes();
    if !left.is_empty() {
        lines.at(0, "left behind and killed:");
        left.iter().for_each(|process| lines.at(2, &explain::process(process)));
    }
    let totals = record.final_totals();
    lines.at(0, &format!("tests: {}", totals.planned));
    for verdict in Verdict::ALL.into_iter().filter(|verdict| totals.of(*verdict) > 0) {
        lines.at(2, &format!("{verdict}: {}", totals.of(verdict)));
    }
    let known = record.tests.iter().filter(|test| known_failure::is_known(test)).count();
    if known > 0 {
        lines.at(2, &format!("known failures among them: {known}"));
    }
    let cases = CaseTotals::of_run(record);
    if cases.total > 0 {
        lines.at(0, &format!("cases: {} ({})", cases.total, cases.describe()));
    }
    let failed = record.failed_hooks().count();
    if failed > 0 {
        lines.at(0, &format!("hooks that failed: {failed}"));
    }
    lines.at(0, &format!("time: {}", words::time(record.last_at.as_duration())));
    let result = match record.is_green() {
        true => "passed",
        false if record.is_damaged() => "not passed (the journal is damaged)",
        false => "not passed",
    };
    lines.at(0, &format!("result: {result}"));
}
