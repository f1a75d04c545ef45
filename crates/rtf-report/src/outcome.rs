//! The outcome of a run in one line: a word and the totals.

use rtf_model::{Record, Verdict};

use crate::cases::CaseTotals;
use crate::{escape, known_failure, words};

/// The outcome as a word, with its reason: `PASSED`, `FAILED (there are no tests)`.
pub(crate) fn word(record: &Record) -> String {
    if record.is_green() {
        "PASSED".to_owned()
    } else if record.is_damaged() {
        "DAMAGED (the journal cannot be trusted)".to_owned()
    } else if let Some(reason) = record.runner_death() {
        format!("INCOMPLETE (the runner died: {})", escape::line(reason))
    } else if !record.is_complete() {
        "INCOMPLETE (the runner did not reach the end)".to_owned()
    } else if let Some(reason) = record.interrupted() {
        format!("INTERRUPTED ({})", escape::line(reason))
    } else if record.tests.is_empty() {
        "FAILED (there are no tests)".to_owned()
    } else {
        "FAILED".to_owned()
    }
}

/// `3 tests in 1 suite, 0.123 s: 1 passed, 2 failed`.
pub(crate) fn totals(record: &Record) -> String {
    let tests = words::count(record.tests.len() as u64, "test");
    let suites = words::count(record.suites.len() as u64, "suite");
    let time = words::time(record.last_at.as_duration());
    let counts = match test_counts(record) {
        counts if counts.is_empty() => counts,
        counts => format!(": {counts}"),
    };
    let totals = CaseTotals::of_run(record);
    let (cases, case_counts) = match totals.total {
        0 => (String::new(), String::new()),
        total => {
            let counts = format!("; cases: {}", totals.describe());
            (format!(", {}", words::count(total, "case")), counts)
        }
    };
    let flaky = match record.tests.iter().filter(|test| test.is_flaky()).count() {
        0 => String::new(),
        flaky => format!(" ({flaky} flaky)"),
    };
    let failed = record.failed_hooks().count();
    let hooks = match failed {
        0 => String::new(),
        failed => format!("; {} failed", words::count(failed as u64, "hook")),
    };
    format!("{tests}{cases} in {suites}, {time}{counts}{flaky}{case_counts}{hooks}")
}

/// `9 passed, 1 failed, 1 expected`.
fn test_counts(record: &Record) -> String {
    let words = Verdict::ALL.map(Verdict::as_str).into_iter().chain(["expected", "quarantined"]);
    let mut counts: Vec<_> = words.map(|word| (word, 0_u32)).collect();
    for test in &record.tests {
        let word = known_failure::word(test);
        counts.iter_mut().filter(|(counted, _)| *counted == word).for_each(|(_, n)| *n += 1);
    }
    let counts = counts.iter().filter(|(_, count)| *count > 0);
    counts.map(|(word, count)| format!("{count} {word}")).collect::<Vec<_>>().join(", ")
}
