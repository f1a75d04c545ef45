//! Words for results that count otherwise than their verdict: known failures, tests that
//! passed although a failure is expected, and tests and cases that skipped themselves.

use rtf_model::{ExpectedFailure, Record, Significance, TestRecord, Verdict};

use crate::words;

/// Whether the result of a test is a known failure, which does not make the run red.
pub(crate) fn is_known(test: &TestRecord) -> bool {
    test.plan.expected.is_some()
        && match test.significance() {
            Significance::Expected => true,
            Significance::Quarantined => test.final_verdict() != Verdict::Passed,
            _ => false,
        }
}

/// The verdict of a test in summaries: `expected` or `quarantined` for a known failure.
pub(crate) fn word(test: &TestRecord) -> &'static str {
    if !is_known(test) {
        return test.final_verdict().as_str();
    }
    match test.significance() {
        Significance::Expected => "expected",
        _ => "quarantined",
    }
}

/// `expected failure: the gripper jams`, `quarantined: the gripper jams`, with the issue.
pub(crate) fn describe(test: &TestRecord) -> String {
    let title = match test.significance() {
        Significance::Quarantined => "quarantined",
        _ => "expected failure",
    };
    let expected = test.plan.expected.as_deref();
    let reason = expected.and_then(|expected| expected.reason.as_deref()).or(test.reason());
    let reason = reason.unwrap_or(test.final_verdict().as_str());
    let reason = reason.lines().next().unwrap_or_default();
    let issue = expected.and_then(|expected| expected.issue.as_deref());
    format!("{title}: {reason}{}", issue.map_or(String::new(), |issue| format!(" ({issue})")))
}

/// Why a test that passed or skipped itself makes the run red; `None` if it does not.
pub(crate) fn red_reason(record: &Record, test: &TestRecord) -> Option<String> {
    match test.significance() {
        Significance::UnexpectedPass => Some(advice(record, test)),
        Significance::SkippedItself if record.skips_fail(test) => {
            let reason = test.reason().unwrap_or("without a reason");
            Some(format!("it skipped itself, and skips fail: {reason}"))
        }
        Significance::Counts if test.final_verdict().is_green() && has_red_cases(record, test) => {
            Some("a case skipped itself, and skips fail".to_owned())
        }
        _ => None,
    }
}

/// Whether skipped cases of the test make the run red.
pub(crate) fn has_red_cases(record: &Record, test: &TestRecord) -> bool {
    record.skips_fail(test)
        && test.significance() == Significance::Counts
        && test.has_skipped_cases()
}

/// `it passed: remove expect="failed" from MoveTest in suites/arm.xml`.
fn advice(record: &Record, test: &TestRecord) -> String {
    let verdicts = test.plan.expected.iter().flat_map(|expected| &expected.verdicts);
    let verdicts: Vec<_> = verdicts.map(|verdict| verdict.as_str()).collect();
    let suite = record.suites.get(test.plan.suite.index()).map_or("", |suite| &suite.plan.file);
    let (verdicts, name) = (verdicts.join(" "), &test.plan.name);
    format!("it passed: remove expect=\"{verdicts}\" from {name} in {suite}")
}

/// The facts of a mark, each with its label.
pub(crate) fn facts(expected: &ExpectedFailure) -> Vec<(&'static str, String)> {
    let mut facts = Vec::new();
    facts.extend(expected.reason.as_ref().map(|reason| ("known", words::first_line(reason))));
    facts.extend(expected.issue.as_ref().map(|issue| ("issue", words::first_line(issue))));
    let until = expected.until.as_ref().map(|until| match expected.expired {
        true => format!("{until}, which has passed: the test counts"),
        false => until.clone(),
    });
    facts.extend(until.map(|until| ("until", words::first_line(&until))));
    facts
}
