//! Failed cases and known failures in the summary.

use rtf_model::{Record, Significance, TestRecord, Verdict};

use super::options::View;
use super::page::ConsoleLines;
use super::style::{self, BAD, BOLD, LOUD};
use crate::cases::{CaseResult, TestCases};
use crate::{escape, known_failure, words};

/// Maximum number of cases that are listed per test.
const CASES: usize = 20;

/// Lists the cases of a test that did not pass.
pub(super) fn failed_cases(
    page: &mut ConsoleLines,
    view: View<'_>,
    test: &TestRecord,
    cases: &TestCases<'_>,
) {
    let failed: Vec<_> = cases.results.iter().filter(|case| case.is_problem).collect();
    for case in failed.iter().take(CASES) {
        failed_case(page, view, (test, cases, case));
    }
    if failed.len() > CASES {
        page.line(&format!("    … and {} more cases that did not pass", failed.len() - CASES));
    }
    if known_failure::has_red_cases(view.record, test) {
        let skipped = cases.results.iter().filter(|case| case.verdict() == Some(Verdict::Skipped));
        for case in skipped.take(CASES) {
            failed_case(page, view, (test, cases, case));
        }
    }
    let not_run = cases.totals().not_run;
    if not_run > 0 {
        page.line(&format!("    {} did not run", words::count(not_run, "case")));
    }
}

fn failed_case(
    page: &mut ConsoleLines,
    View { options, record }: View<'_>,
    (test, cases, case): (&TestRecord, &TestCases<'_>, &CaseResult<'_>),
) {
    let verdict = case.verdict().unwrap_or(Verdict::Skipped);
    let name = style::paint(BOLD, &escape::line(case.path));
    let verdict = style::paint(style::of_verdict(verdict), verdict.as_str());
    page.line(&format!("    case {name}  {verdict}"));
    page.inner_fact("reason", &words::short_line(case.reason()));
    if let Some(location) = cases.locations(case).next() {
        page.inner_fact("at", &escape::line(&location.to_string()));
    }
    let path = cases.selectable_path(case);
    if let Some(command) = (options.rerun)(record, test.plan.test, Some(&path)) {
        page.inner_fact("rerun", &escape::line(&command));
    }
}

/// Lists tests that passed although a failure is expected.
pub(super) fn unexpected(page: &mut ConsoleLines, View { options, record }: View<'_>) {
    let is_unexpected = |test: &&TestRecord| test.significance() == Significance::UnexpectedPass;
    let mut tests = record.tests.iter().filter(is_unexpected).peekable();
    if tests.peek().is_none() {
        return;
    }
    page.heading(BOLD, "tests that passed although a failure is expected:");
    for test in tests {
        let name = escape::line(&record.full_name(test.plan.test)).into_owned();
        page.line(&format!("  {}", style::paint(BAD, &name)));
        let advice = known_failure::red_reason(record, test).unwrap_or_default();
        page.fact("reason", &words::short_line(&advice));
        mark(page, test);
        if let Some(command) = (options.rerun)(record, test.plan.test, None) {
            page.fact("rerun", &escape::line(&command));
        }
    }
}

pub(super) fn known(page: &mut ConsoleLines, record: &Record) {
    let mut tests = record.tests.iter().filter(|test| known_failure::is_known(test)).peekable();
    if tests.peek().is_none() {
        return;
    }
    page.heading(BOLD, "known failures, which do not make the run red:");
    for test in tests {
        let name = style::paint(LOUD, &escape::line(&record.full_name(test.plan.test)));
        let (word, verdict) = (known_failure::word(test), test.final_verdict());
        page.line(&format!("  {name}  {word} ({verdict})"));
        page.fact("reason", &words::short_line(test.reason().unwrap_or(verdict.as_str())));
        mark(page, test);
        if let Some(cases) = TestCases::of(test) {
            page.fact("cases", &cases.totals().describe());
        }
    }
}

/// Shows why a failure is known, and until when.
pub(super) fn mark(page: &mut ConsoleLines, test: &TestRecord) {
    let facts = test.plan.expected.as_deref().map(known_failure::facts);
    facts.iter().flatten().for_each(|(label, text)| page.fact(label, text));
}
