//! Skipped tests and cases in the summary.

use std::collections::BTreeMap;

use rtf_model::{Record, Significance, TestId, Verdict};

use super::page::ConsoleLines;
use super::style::{self, BOLD, LOUD};
use crate::cases::TestCases;
use crate::{cause, escape, words};

/// Maximum number of skipped tests that are listed per reason.
const NAMES: usize = 5;

pub(super) fn by_runner(page: &mut ConsoleLines, record: &Record) {
    let mut reasons: BTreeMap<&str, Vec<TestId>> = BTreeMap::new();
    for test in &record.tests {
        let skipped_itself = test.significance() == Significance::SkippedItself;
        if test.final_verdict() == Verdict::Skipped && !skipped_itself {
            let reason = test.skipped.as_deref();
            let reason = reason.unwrap_or("the run ended before the test started");
            reasons.entry(reason).or_default().push(test.plan.test);
        }
    }
    if reasons.is_empty() {
        return;
    }
    page.heading(BOLD, "skipped tests:");
    for (reason, tests) in reasons {
        let name = |id: &TestId| escape::line(&record.full_name(*id)).into_owned();
        let names: Vec<_> = tests.iter().map(name).collect();
        list(page, "test", cause::short(record, reason), &names);
    }
}

/// Lists tests and cases that skipped themselves.
pub(super) fn by_themselves(page: &mut ConsoleLines, record: &Record) {
    let mut reasons: BTreeMap<(&str, &str), Vec<String>> = BTreeMap::new();
    for test in &record.tests {
        let name = || escape::line(&record.full_name(test.plan.test)).into_owned();
        if test.significance() == Significance::SkippedItself {
            let reason = test.reason().unwrap_or("without a reason");
            reasons.entry((reason, "test")).or_default().push(name());
        }
        if !test.has_skipped_cases() {
            continue;
        }
        let cases = TestCases::of(test);
        let results = cases.iter().flat_map(|cases| &cases.results);
        for case in results.filter(|case| case.verdict() == Some(Verdict::Skipped)) {
            let reason = case.record.and_then(|case| case.reason()).unwrap_or("without a reason");
            let name = format!("{}/{}", name(), escape::line(case.path));
            reasons.entry((reason, "case")).or_default().push(name);
        }
    }
    if reasons.is_empty() {
        return;
    }
    page.heading(BOLD, "skipped themselves:");
    for ((reason, noun), names) in reasons {
        list(page, noun, reason, &names);
    }
}

/// Lists tests or cases that were skipped for one reason.
fn list(page: &mut ConsoleLines, noun: &str, reason: &str, names: &[String]) {
    let count = style::paint(LOUD, &words::count(names.len() as u64, noun));
    page.line(&format!("  {count}: {}", words::short_line(reason)));
    for name in names.iter().take(NAMES) {
        page.line(&format!("    {name}"));
    }
    if names.len() > NAMES {
        page.line(&format!("    … and {} more", names.len() - NAMES));
    }
}
