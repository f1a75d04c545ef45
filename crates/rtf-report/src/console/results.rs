//! Results of tests and cases in the console, as they finish.

use rtf_model::{
    AttemptRecord, CaseFinished, CaseRecord, Record, Significance, Source, TestFinished,
    TestRecord, Verdict,
};

use super::options::{Verbosity, View};
use super::page::ConsoleLines;
use super::result_details::{self, EXTENT};
use super::style::{self, BAD, LOUD};
use crate::cases::{CaseProblems, describe_counts};
use crate::explain::{self, Tone};
use crate::{escape, known_failure, logs, words};

/// Maximum number of cases of an attempt that are shown because they did not pass.
const CASES: u64 = 100;

/// Shows a case that did not pass, in the attempt in which it ran.
pub(super) fn case_finished(page: &mut ConsoleLines, view: View<'_>, end: &CaseFinished) {
    let View { options, record } = view;
    if !end.verdict.is_problem() || end.carried {
        return;
    }
    let Some(test) = record.tests.get(end.test.index()) else { return };
    let Some(attempt) = test.attempts.last() else { return };
    let Some(case) = attempt.cases.get(end.case) else { return };
    if attempt.cases.problems() > CASES || !(end.rerun || attempt.has_own_problem(case)) {
        return;
    }
    let (known, word) = attempt_word(test, end.verdict);
    if known && options.verbosity == Verbosity::Quiet {
        return;
    }
    case_line(page, record, test, (case, word));
    let mut reported = CaseProblems::default();
    let is_in_case = |reported: Option<_>| reported == Some(end.case);
    reported.failures.extend(attempt.failures().filter(|failure| is_in_case(failure.case)));
    reported.violations.extend(attempt.violations().filter(|value| is_in_case(value.case)));
    let reason = end.reason.as_deref().unwrap_or(end.verdict.as_str());
    let sink = &mut |tone, line: &str| page.detail(tone, line);
    if known {
        return sink(Tone::Dim, &words::short_line(reason));
    }
    explain::case_problems(reason, &reported, EXTENT, sink);
}

/// `passed     0.012 s  arm/MoveTest/joint 3`.
pub(super) fn case_line(
    page: &mut ConsoleLines,
    record: &Record,
    test: &TestRecord,
    (case, word): (&CaseRecord, (anstyle::Style, &str)),
) {
    let attempt = words::case_attempt(case);
    let name = format!("{}/{}{attempt}", record.full_name(test.plan.test), case.path);
    let time = words::time(case.duration().unwrap_or_default());
    page.entry(word, &time, &escape::line(&name));
}

pub(super) fn test_finished(page: &mut ConsoleLines, view: View<'_>, finished: &TestFinished) {
    let View { options, record } = view;
    let Some(test) = record.tests.get(finished.test.index()) else { return };
    let Some(attempt) = test.attempts.last() else { return };
    let name = attempt_name(record, test, (attempt, finished));
    let (known, word) = attempt_word(test, finished.verdict);
    let skipped_itself = finished.verdict == Verdict::Skipped && !attempt.stopped;
    let skips_fail = skipped_itself && record.skips_fail(test);
    let advice = advice(record, test, finished);
    let is_good = finished.verdict.is_green() && advice.is_none() || known;
    if !(is_good || skipped_itself && !skips_fail) || options.verbosity > Verbosity::Quiet {
        let time = words::time(attempt.duration().unwrap_or_default());
        let word = if advice.is_some() || skips_fail { (BAD, word.1) } else { word };
        page.entry(word, &time, &name);
        let sink = &mut |tone, line: &str| page.detail(tone, line);
        advice.iter().for_each(|advice| explain::block(Tone::Bad, advice, "", sink));
        if known || skipped_itself {
            let reason = finished.reason.as_deref().unwrap_or_default();
            sink(Tone::Dim, &words::short_line(reason));
        }
    }
    if known || skipped_itself || finished.verdict.is_green() {
        return result_details::leaked(page, &name, &attempt.leaked);
    }
    problem(page, view, test, attempt);
}

fn attempt_name(
    record: &Record,
    test: &TestRecord,
    (attempt, finished): (&AttemptRecord, &TestFinished),
) -> String {
    let mut name = escape::line(&record.full_name(finished.test)).into_owned();
    match test.repetitions() {
        None => name += &format!(" ({})", attempt.repetition),
        Some(1) => {}
        Some(all) => name += &format!(" ({} of {all})", attempt.repetition),
    }
    if attempt.attempt > 1 {
        name += &format!(", attempt {}", attempt.attempt);
    }
    if finished.rerun {
        name += ", will be retried";
    }
    name
}

/// Whether a verdict of an attempt is a known failure, and the word for it.
fn attempt_word(test: &TestRecord, verdict: Verdict) -> (bool, (anstyle::Style, &'static str)) {
    let significance = test.plan.expected.as_ref().map(|e| e.significance(verdict));
    match significance {
        Some(Significance::Expected) => (true, (LOUD, "expected")),
        Some(Significance::Quarantined) if verdict.is_problem() => (true, (LOUD, "quarantined")),
        _ => (false, (style::of_verdict(verdict), verdict.as_str())),
    }
}

/// The advice for a test that passed in all its repetitions although a failure is expected.
fn advice(record: &Record, test: &TestRecord, finished: &TestFinished) -> Option<String> {
    let is_last = test.verdict().is_some();
    let is_green = finished.verdict.is_green() && is_last;
    is_green.then(|| known_failure::red_reason(record, test)).flatten()
}

fn problem(page: &mut ConsoleLines, view: View<'_>, test: &TestRecord, attempt: &AttemptRecord) {
    let View { options, record } = view;
    let sink = &mut |tone, line: &str| page.detail(tone, line);
    explain::explain(attempt, EXTENT, sink);
    case_counts(attempt, sink);
    explain::left(&attempt.leaked, sink);
    if !attempt.output.is_empty() && options.verbosity < Verbosity::Verbose {
        let log = options.shown(&logs::log(record, Source::Test(test.plan.test)));
        result_details::output(&attempt.output, log, sink);
    }
}

/// `40 cases: 6 passed, 1 crashed, 33 did not run`.
fn case_counts(attempt: &AttemptRecord, sink: explain::Sink<'_>) {
    let cases = &attempt.cases;
    if cases.total() == 0 {
        return;
    }
    let counts = describe_counts(|verdict| cases.of(verdict), cases.not_run().len() as u64);
    sink(Tone::Plain, &format!("{}: {counts}", words::count(cases.total(), "case")));
    let problems = attempt.cases.problems();
    if problems > CASES {
        let more = words::count(problems - CASES, "more case");
        sink(Tone::Dim, &format!("… and {more} that did not pass are in the reports"));
    }
}
