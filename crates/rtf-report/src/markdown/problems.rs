//! Everything besides the failed tests and the measurements: hooks, fixtures, flaky,
//! known and skipped tests, leaked processes, warnings.

use std::collections::BTreeMap;

use rtf_model::{FixtureRecord, HookRunRecord, Record, Verdict};

use super::inline::{block, code, first_line};
use super::{MarkdownOptions, heading, list, row};
use crate::explain::{self, Extent, Tone};
use crate::retried::Retried;
use crate::{cause, known_failure, logs, words};

/// Maximum number of items per list, and of rows per table.
const ITEMS: usize = 50;

/// Maximum number of hooks, fixtures and collapses with details.
const DETAILED: usize = 20;

/// How much of a hook is explained.
const EXTENT: Extent = Extent { items: 10, stack_lines: 20 };

/// The runs of hooks that failed.
pub(super) fn hooks(page: &mut String, record: &Record, options: &MarkdownOptions<'_>) {
    if !record.hook_failed() {
        return;
    }
    heading(page, "Hooks that failed: the robot may not be in a safe state");
    let runs =
        record.hooks.iter().flat_map(|hook| (1..).zip(&hook.runs).map(move |run| (hook, run)));
    let failed: Vec<_> = runs.filter(|(_, (_, run))| run.problem().is_some()).collect();
    for (hook, (number, run)) in failed.iter().take(DETAILED) {
        let name = code(&record.full_hook_name(hook.plan.hook));
        *page += &format!("{name} on {}\n\n", run.trigger);
        let log = options.dir.filter(|_| !run.output.is_empty());
        if let Some(dir) = log {
            let log = dir.join(logs::hook_run_log(record, hook.plan.hook, *number));
            *page += &format!("- log {}\n\n", code(&log.to_string_lossy()));
        }
        explain_hook(page, run);
    }
    if failed.len() > DETAILED {
        *page += &format!("… and {} more runs of hooks that failed\n", failed.len() - DETAILED);
    }
}

fn explain_hook(page: &mut String, run: &HookRunRecord) {
    let lines = explain::lines(|sink| {
        explain::hook(run, EXTENT, sink);
        explain::block(Tone::Dim, &run.reason, "reason: ", sink);
        explain::printed(words::tail(&run.output, EXTENT.stack_lines).0, sink);
    });
    block(page, lines.iter().map(String::as_str));
    *page += "\n";
}

/// Fixtures that collapsed, broke, or could not be torn down. Tolerated collapses are listed, too.
pub(super) fn fixtures(page: &mut String, record: &Record) {
    let has_problem = |fixture: &&FixtureRecord| {
        fixture.broken.is_some() || !fixture.collapses.is_empty() || !fixture.problems.is_empty()
    };
    let fixtures: Vec<_> = record.fixtures.iter().filter(has_problem).collect();
    if fixtures.is_empty() {
        return;
    }
    heading(page, "Collapses and problems of fixtures");
    for fixture in fixtures.iter().take(DETAILED) {
        let suite = record.suites.get(fixture.plan.suite.index());
        let suite_name = suite.map_or("", |suite| suite.plan.name.as_str());
        let name = code(&format!("{suite_name}/{}", fixture.plan.name));
        let starts = words::count(fixture.starts.into(), "start");
        let collapses = words::count(fixture.collapses.len() as u64, "collapse");
        let is_tolerated = suite.is_some_and(|suite| suite.plan.tolerates_collapse);
        let tolerated = if is_tolerated { ", tolerated by the suite" } else { "" };
        *page += &format!("{name}: {starts}, {collapses}{tolerated}\n\n");
        list(page, &fixture_problems(fixture), DETAILED, "problem", |(what, reason)| {
            format!("{what}: {}", first_line(reason))
        });
        if !fixture.log_tail.is_empty() {
            *page += "last lines before the last problem:\n\n";
            block(page, fixture.log_tail.iter().map(String::as_str));
            *page += "\n";
        }
    }
    if fixtures.len() > DETAILED {
        *page += &format!("… and {} more fixtures\n", fixtures.len() - DETAILED);
    }
}

fn fixture_problems(fixture: &FixtureRecord) -> Vec<(String, &str)> {
    let broken = fixture.broken.iter().map(|reason| ("broken".to_owned(), reason.as_str()));
    let at =
        |word: &str, at: rtf_model::Micros| format!("{word} at {}", words::time(at.as_duration()));
    let collapses =
        fixture.collapses.iter().map(|(t, reason)| (at("collapsed", *t), reason.as_str()));
    let others = fixture.problems.iter().filter(|(_, text)| fixture.broken.as_ref() != Some(text));
    let others = others.map(|(t, problem)| (at("problem", *t), problem.as_str()));
    broken.chain(collapses).chain(others).collect()
}

/// Tests that passed only after a retry.
pub(super) fn flaky(page: &mut String, record: &Record) {
    let flaky = record.tests.iter().filter(|test| test.is_flaky());
    let tests: Vec<_> = flaky.flat_map(|test| Retried::of(record, test)).collect();
    if tests.is_empty() {
        return;
    }
    let counts = if record.flaky_fails() { ", which make the run red" } else { "" };
    heading(page, &format!("Flaky tests{counts}"));
    list(page, &tests, ITEMS, "test", |test| {
        let attempts = words::count(test.attempts, "attempt");
        let reason = test.before.first().map_or("", |(_, reason)| *reason);
        let name = code(&test.name);
        format!("{name} passed after {attempts}; before: {}", first_line(reason))
    });
}

/// Known failures, which do not make the run red.
pub(super) fn known(page: &mut String, record: &Record) {
    let tests: Vec<_> = record.tests.iter().filter(|test| known_failure::is_known(test)).collect();
    if tests.is_empty() {
        return;
    }
    heading(page, "Known failures, which do not make the run red");
    list(page, &tests, ITEMS, "test", |test| {
        let name = code(&record.full_name(test.plan.test));
        format!("{name}: {}", first_line(&known_failure::describe(test)))
    });
}

/// Skipped tests by reason.
pub(super) fn skipped(page: &mut String, record: &Record) {
    let mut reasons: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for test in record.tests.iter().filter(|test| test.final_verdict() == Verdict::Skipped) {
        let reason = test.skipped.as_deref().or(test.reason());
        let reason = reason.unwrap_or("the run ended before the test started");
        let name = record.full_name(test.plan.test);
        reasons.entry(cause::short(record, reason)).or_default().push(name);
    }
    if reasons.is_empty() {
        return;
    }
    heading(page, "Skipped tests");
    let reasons: Vec<_> = reasons.into_iter().collect();
    list(page, &reasons, ITEMS, "reason", |(reason, tests)| {
        let names: Vec<_> = tests.iter().take(5).map(|name| code(name)).collect();
        let more = match tests.len() - names.len() {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let count = words::count(tests.len() as u64, "test");
        format!("{count}: {}: {}{more}", first_line(reason), names.join(", "))
    });
}

/// Processes that were left behind and had to be killed.
pub(super) fn leaked(page: &mut String, record: &Record) {
    let processes = record.leaked_processes();
    if !processes.is_empty() {
        heading(page, "Processes that were left behind and had to be killed");
        list(page, &processes, ITEMS, "process", |process| code(&explain::process(process)));
    }
}

/// All hooks with the numbers of their runs.
pub(super) fn hook_runs(page: &mut String, record: &Record) {
    if record.hooks.is_empty() {
        return;
    }
    heading(page, "Hooks");
    *page += "| hook | runs | failed | triggers |\n|---|---|---|---|\n";
    for hook in record.hooks.iter().take(ITEMS) {
        let failed = hook.runs.iter().filter(|run| run.problem().is_some()).count();
        let mut triggers: Vec<_> = hook.runs.iter().map(|run| run.trigger.to_string()).collect();
        triggers.dedup();
        let seen = &triggers[..triggers.len().min(5)];
        let more = if triggers.len() > seen.len() { ", …" } else { "" };
        let name = code(&record.full_hook_name(hook.plan.hook));
        let numbers = [hook.runs.len().to_string(), failed.to_string()];
        row(page, &[&[name], &numbers[..], &[format!("{}{more}", seen.join(", "))]].concat());
    }
    if record.hooks.len() > ITEMS {
        *page += &format!("\n… and {} more hooks\n", record.hooks.len() - ITEMS);
    }
}

pub(super) fn warnings(page: &mut String, record: &Record) {
    if record.warnings.is_empty() {
        return;
    }
    heading(page, "Warnings");
    list(page, &record.warnings, ITEMS, "warning", |warning| {
        let place = warning.labels.first().map(|at| format!("{}:{}: ", at.file, at.line));
        first_line(&format!("{}{}", place.unwrap_or_default(), warning.message))
    });
}
