//! The summary at the end: problems, logs, commands for reruns,
//! and the result in the last line.

use rtf_model::Record;

use super::options::View;
use super::page::ConsoleLines;
use super::style::{self, BAD, BOLD, GOOD, LOUD};
use super::{case_summary, failed_tests, hooks, skips};
use crate::growth::{self, Growing, Within};
use crate::repetition_summary::Repeated;
use crate::retried::Retried;
use crate::{escape, explain, outcome, words};

/// Minimum number of repetitions for a histogram.
const HISTOGRAM: usize = 10;

/// Maximum number of leaked processes that are listed.
const PROCESSES: usize = 50;

pub(super) fn show(page: &mut ConsoleLines, view: View<'_>) {
    let View { options, record } = view;
    hooks::summary(page, view);
    problems(page, record);
    failed_tests::show(page, view);
    case_summary::unexpected(page, view);
    case_summary::known(page, record);
    flaky(page, record);
    repeated(page, record);
    growing(page, record);
    skips::by_runner(page, record);
    skips::by_themselves(page, record);
    killed(page, record);
    page.line("");
    if let Some(folder) = &options.folder {
        let here = folder.as_os_str().is_empty().then_some(".".into());
        let shown = here.unwrap_or_else(|| folder.display().to_string());
        page.line(&format!("results: {}", escape::line(&shown)));
    }
    result(page, record);
}

fn problems(page: &mut ConsoleLines, record: &Record) {
    let of_suite = |suite: &rtf_model::SuiteRecord| {
        let name = escape::line(&suite.plan.name).into_owned();
        let problems = record.fixture_problems(suite.plan.suite);
        problems.into_iter().map(move |problem| format!("{name}: {}", words::short_line(&problem)))
    };
    let problems: Vec<_> = record.suites.iter().flat_map(of_suite).collect();
    if problems.is_empty() {
        return;
    }
    page.heading(BOLD, "problems outside the tests:");
    for same in problems.chunk_by(|a, b| a == b) {
        let times = if same.len() > 1 { format!(" ({} times)", same.len()) } else { String::new() };
        page.line(&format!("  {}{times}", style::paint(BAD, &same[0])));
    }
}

/// Tests that passed only after a retry, with the reasons of earlier failures.
fn flaky(page: &mut ConsoleLines, record: &Record) {
    let mut tests = record.tests.iter().filter(|test| test.is_flaky()).peekable();
    if tests.peek().is_none() {
        return;
    }
    let style = if record.flaky_fails() { BAD } else { LOUD };
    page.heading(BOLD, "flaky tests, which passed only after a retry:");
    for test in tests {
        for retried in Retried::of(record, test) {
            let name = style::paint(style, &escape::line(&retried.name));
            let attempts = words::count(retried.attempts, "attempt");
            page.line(&format!("  {name}  {attempts}"));
            for (verdict, reason) in retried.before {
                page.fact("before", &format!("{verdict}: {}", words::short_line(reason)));
            }
        }
    }
}

/// Statistics of repeated tests.
fn repeated(page: &mut ConsoleLines, record: &Record) {
    let tests = record.tests.iter().filter_map(|test| Some((test, Repeated::of(test)?)));
    let mut tests = tests.peekable();
    if tests.peek().is_none() {
        return;
    }
    page.heading(BOLD, "repeated tests:");
    for (test, repeated) in tests {
        let style = if repeated.passed == repeated.times.len() { GOOD } else { BAD };
        let name = escape::line(&record.full_name(test.plan.test)).into_owned();
        page.line(&format!("  {name}  {}", style::paint(style, &repeated.rate())));
        page.fact("time", &repeated.spread());
        if repeated.times.len() >= HISTOGRAM {
            page.fact("", &format!("|{}|", repeated.histogram()));
        }
    }
}

/// Fixtures and shared hosts whose resources grow.
fn growing(page: &mut ConsoleLines, record: &Record) {
    let fixtures =
        record.suites.iter().flat_map(|suite| growth::fixtures(record, suite, Within::Run));
    grow(page, "fixtures that grow while tests are repeated:", fixtures.collect());
    let hosts = record.suites.iter().flat_map(|suite| growth::hosts(record, suite, Within::Run));
    grow(page, "shared hosts that grow while tests are repeated:", hosts.collect());
}

fn grow(page: &mut ConsoleLines, title: &str, growing: Vec<Growing>) {
    if growing.is_empty() {
        return;
    }
    page.heading(BOLD, title);
    for each in growing {
        let name = style::paint(LOUD, &escape::line(&each.name));
        if each.what.is_empty() {
            each.lines().iter().for_each(|line| page.line(&format!("  {name}  {line}")));
        } else {
            page.line(&format!("  {name} {}", each.what));
            each.lines().iter().for_each(|line| page.line(&format!("    {line}")));
        }
    }
}

/// All leaked processes.
fn killed(page: &mut ConsoleLines, record: &Record) {
    let left = record.leaked_processes();
    if left.is_empty() {
        return;
    }
    page.heading(BOLD, "processes that were left behind and had to be killed:");
    for process in left.iter().take(PROCESSES) {
        page.line(&format!("  {}", explain::process(process)));
    }
    if left.len() > PROCESSES {
        page.line(&format!("  … and {} more", left.len() - PROCESSES));
    }
}

fn result(page: &mut ConsoleLines, record: &Record) {
    let style = if record.is_green() { GOOD } else { BAD };
    let word = style::paint(style, &outcome::word(record));
    page.line(&format!("{word}  {}", outcome::totals(record)));
}
