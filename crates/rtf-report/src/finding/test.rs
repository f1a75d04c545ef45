//! The findings of a test: one for each case that did not pass, and one for the test
//! if it has no cases, or a problem outside of them.

use rtf_model::{Record, TestRecord, Verdict};

use super::{EXTENT, Finding, Rank, Roots};
use crate::cases::{CaseResult, TestCases};
use crate::{escape, explain, known_failure};

/// Maximum number of cases of a test with a finding.
const CASES: usize = 100;

/// Whether a test has findings. A known failure has none.
pub(crate) fn is_problem(record: &Record, test: &TestRecord) -> bool {
    let verdict = test.final_verdict();
    // The reason why the runner skipped it is a separate finding.
    let is_red = !verdict.is_green() && verdict != Verdict::Skipped;
    !known_failure::is_known(test) && (is_red || known_failure::red_reason(record, test).is_some())
}

pub(crate) fn of_test(record: &Record, test: &TestRecord, roots: &Roots<'_>) -> Vec<Finding> {
    if !is_problem(record, test) {
        return Vec::new();
    }
    if let Some(reason) = known_failure::red_reason(record, test) {
        return vec![of_red(record, test, &reason, roots)];
    }
    let Some(cases) = TestCases::of(test) else { return vec![of_whole(record, test, roots)] };
    let mut findings = Vec::new();
    if cases.has_test_problem(test) {
        findings.push(of_whole(record, test, roots));
    }
    let failed = cases.results.iter().filter(|case| case.is_problem);
    let count = failed.clone().count();
    findings.extend(failed.take(CASES).map(|case| of_case(record, test, (&cases, case), roots)));
    if count > CASES {
        let more = format!("… and {} more cases did not pass", count - CASES);
        findings.last_mut().into_iter().for_each(|last| last.text += &format!("\n{more}"));
    }
    findings
}

/// The test itself, without its cases.
fn of_whole(record: &Record, test: &TestRecord, roots: &Roots<'_>) -> Finding {
    let verdict = test.final_verdict();
    let about = record.full_name(test.plan.test);
    let mut lines = explain::lines(|sink| {
        if let Some(attempt) = test.decisive_attempt() {
            explain::attempt(attempt, EXTENT, sink);
        }
    });
    if lines.is_empty() {
        lines.push(escape::block(test.reason().unwrap_or(verdict.as_str())).into_owned());
    }
    Finding {
        rank: rank(verdict),
        kind: verdict.as_str().to_owned(),
        title: format!("{} {verdict}", escape::line(&about)),
        text: lines.join("\n"),
        place: roots.test(record, test),
        about,
    }
}

fn of_case(
    record: &Record,
    test: &TestRecord,
    (cases, case): (&TestCases<'_>, &CaseResult<'_>),
    roots: &Roots<'_>,
) -> Finding {
    let verdict = case.verdict().unwrap_or(Verdict::Error);
    let about = format!("{}/{}", record.full_name(test.plan.test), case.path);
    let lines = explain::lines(|sink| explain::case(cases, case, EXTENT, sink));
    let place = cases.locations(case).find_map(|at| roots.place(&at.file, at.line));
    Finding {
        rank: rank(verdict),
        kind: verdict.as_str().to_owned(),
        title: format!("{} {verdict}", escape::line(&about)),
        text: lines.join("\n"),
        place: place.or_else(|| roots.test(record, test)),
        about,
    }
}

/// A test that passed or skipped itself, and makes the run red.
fn of_red(record: &Record, test: &TestRecord, reason: &str, roots: &Roots<'_>) -> Finding {
    let about = record.full_name(test.plan.test);
    let kind = match test.final_verdict() {
        Verdict::Passed if test.plan.expected.is_some() => "unexpected-pass",
        _ => Verdict::Skipped.as_str(),
    };
    Finding {
        rank: Rank::Robot,
        kind: kind.to_owned(),
        title: format!("{} {kind}", escape::line(&about)),
        text: escape::block(reason).into_owned(),
        place: roots.test(record, test),
        about,
    }
}

fn rank(verdict: Verdict) -> Rank {
    if verdict == Verdict::Failed { Rank::Robot } else { Rank::Bench }
}
