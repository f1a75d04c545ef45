//! The cases of a test as JUnit test cases.

use std::collections::HashMap;
use std::path::Path;

use quick_junit::{NonSuccessKind, TestCase, TestCaseStatus, TestRerun};
use rtf_model::{
    Attachment, CaseId, CaseRecord, Measurement, Record, Significance, TestRecord, Verdict,
};

use super::{described, first_line, test, text, time};
use crate::cases::{CaseResult, CaseSource, TestCases, sources};
use crate::explain::{self, Extent};
use crate::{escape, known_failure, words};

/// Maximum number of measurements of a case.
const MEASUREMENTS: usize = 100;

/// The test cases of a test: one without cases, or with a problem outside of them, has its
/// own.
pub(super) fn of(record: &Record, test: &TestRecord, folder: Option<&Path>) -> Vec<TestCase> {
    let Some(cases) = TestCases::of(test) else { return vec![test::of(record, test, folder)] };
    let has_test_case = has_own_test_case(test, &cases);
    let mut junit = Vec::with_capacity(cases.results.len() + 1);
    if has_test_case {
        junit.push(test::of(record, test, folder));
    }
    let suite = record.suites.get(test.plan.suite.index()).map_or("", |s| &s.plan.name);
    let name = text(&format!("{suite}.{}", test.plan.name));
    let details = Details::of(test);
    // One test case has the output and the properties of the test.
    let mut bearer = None;
    for case in cases.results.iter().filter(|case| is_listed(case)) {
        let mut status = status(record, test, &cases, case);
        for earlier in cases.earlier_attempts(case) {
            rerun(&mut status, record, &cases, &earlier);
        }
        if case.is_problem && bearer.is_none() {
            bearer = Some(junit.len());
        }
        let mut one = TestCase::new(escape::line(case.path), status);
        one.set_classname(name.as_str());
        one.set_time(case.duration);
        if let Some(record_of_case) = case.record {
            one.timestamp = time::at(record, record_of_case.started);
        }
        details.add(&mut one, case, folder);
        junit.push(one);
    }
    let bearer = bearer.unwrap_or(0);
    if let Some(bearer) = junit.get_mut(bearer).filter(|_| !has_test_case) {
        bear(bearer, test, folder);
    }
    if let (Some(first), true) = (junit.first_mut(), cases.omitted > 0) {
        first.add_property(("omitted-passed-cases", cases.omitted.to_string().as_str()));
    }
    junit
}

/// Whether a case is more than the cases that it contains.
fn is_listed(case: &CaseResult<'_>) -> bool {
    !case.is_container || case.is_problem || case.verdict() == Some(Verdict::Skipped)
}

fn has_own_test_case(test: &TestRecord, cases: &TestCases<'_>) -> bool {
    let is_explained = match test.significance() {
        Significance::UnexpectedPass | Significance::SkippedItself => false,
        _ => test.final_verdict() != Verdict::Skipped && !cases.has_test_problem(test),
    };
    let is_retried = test.attempts.len() > test.deciding_attempts().count();
    !is_explained || test.is_flaky() && is_retried || cases.results.is_empty()
}

/// Adds the output and the properties of a test to the test case of one of its cases.
fn bear(case: &mut TestCase, test: &TestRecord, folder: Option<&Path>) {
    let own = case.system_out.take();
    test::add_details(case, test, folder);
    if let Some(own) = own {
        let out = case.system_out.as_ref().map_or("", |out| out.as_str());
        let separator = if out.is_empty() || out.ends_with('\n') { "" } else { "\n" };
        let all = format!("{out}{separator}{}", own.as_str());
        case.set_system_out(all);
    }
    let Some(attempt) = test.decisive_attempt() else { return };
    let ending = test::ending(test, attempt);
    if let TestCaseStatus::NonSuccess { description, .. } = &mut case.status
        && !ending.is_empty()
    {
        let mut all = description.as_ref().map_or("", |text| text.as_str()).to_owned();
        let reasons = all.clone();
        for line in ending.lines().filter(|line| reasons.lines().all(|told| told != *line)) {
            all += &format!("\n{line}");
        }
        *description = Some(all.into());
    }
}

fn status(
    record: &Record,
    test: &TestRecord,
    cases: &TestCases<'_>,
    case: &CaseResult<'_>,
) -> TestCaseStatus {
    let Some(verdict) = case.verdict() else {
        return not_run(test);
    };
    let (status, message) = match verdict {
        Verdict::Passed
            if record.flaky_fails() && case.record.is_some_and(CaseRecord::is_flaky) =>
        {
            let status = TestCaseStatus::non_success(NonSuccessKind::Failure);
            return test::flaky(status);
        }
        Verdict::Passed => return TestCaseStatus::success(),
        Verdict::Skipped if known_failure::has_red_cases(record, test) => {
            let message = format!("it skipped itself, and skips fail: {}", case.reason());
            (TestCaseStatus::non_success(NonSuccessKind::Failure), message)
        }
        Verdict::Skipped => (TestCaseStatus::skipped(), case.reason().to_owned()),
        _ if known_failure::is_known(test) => {
            (TestCaseStatus::skipped(), known_failure::describe(test))
        }
        verdict => (TestCaseStatus::non_success(test::kind(verdict)), case.reason().to_owned()),
    };
    described(status, verdict.as_str(), first_line(&message), explained(cases, case))
}

fn explained(cases: &TestCases<'_>, case: &CaseResult<'_>) -> String {
    explain::lines(|sink| explain::case(cases, case, Extent::ALL, sink)).join("\n")
}

/// Adds an earlier attempt of a case. One that passed is no rerun in JUnit.
fn rerun(
    status: &mut TestCaseStatus,
    record: &Record,
    cases: &TestCases<'_>,
    attempt: &CaseResult<'_>,
) {
    let problem = attempt.verdict().filter(|verdict| verdict.is_problem());
    let Some((verdict, record_of_case)) = problem.zip(attempt.record) else { return };
    let mut rerun = TestRerun::new(test::kind(verdict));
    rerun.timestamp = time::at(record, record_of_case.started);
    rerun.set_time(attempt.duration);
    rerun.set_type(verdict.as_str());
    rerun.set_message(text(first_line(attempt.reason())));
    rerun.set_description(explained(cases, attempt));
    status.add_rerun(rerun);
}

fn not_run(test: &TestRecord) -> TestCaseStatus {
    let mut status = TestCaseStatus::skipped();
    let reason = test.reason().unwrap_or("the run ended before the test did");
    // A test that would have passed has no other reason than this.
    let message = match reason.contains("planned cases did not run") {
        true => "did not run".to_owned(),
        false => format!("did not run: {}", words::first_line(reason)),
    };
    status.set_message(message);
    status
}

/// Measurements and attachments by the attempt and the case in which they were reported.
#[derive(Default)]
struct Details<'r> {
    measurements: HashMap<(usize, CaseId), Vec<&'r Measurement>>,
    attachments: HashMap<(usize, CaseId), Vec<&'r Attachment>>,
}

impl<'r> Details<'r> {
    fn of(test: &'r TestRecord) -> Self {
        let mut details = Self::default();
        sources(test).iter().for_each(|source| details.add_source(source));
        details
    }

    fn add_source(&mut self, source: &CaseSource<'r>) {
        for measurement in &source.attempt.measurements {
            if let Some(key) = source.key(measurement.case) {
                self.measurements.entry(key).or_default().push(measurement);
            }
        }
        for attachment in &source.attempt.attachments {
            if let Some(key) = source.key(attachment.case) {
                self.attachments.entry(key).or_default().push(attachment);
            }
        }
    }

    fn add(&self, junit: &mut TestCase, case: &CaseResult<'_>, folder: Option<&Path>) {
        let Some(key) = case.key() else { return };
        let measurements = self.measurements.get(&key).into_iter().flatten();
        for measurement in measurements.take(MEASUREMENTS) {
            test::add_measurement(junit, measurement);
        }
        for tag in case.record.iter().flat_map(|record| &record.start.tags) {
            junit.add_property(("tag", text(tag).as_str()));
        }
        for parameter in case.record.iter().flat_map(|record| &record.start.parameters) {
            let name = text(&format!("parameter.{}", parameter.name));
            junit.add_property((name, text(&parameter.value)));
        }
        let attachments = self.attachments.get(&key).into_iter().flatten();
        let mut out = String::new();
        if let Some(folder) = folder {
            attachments.for_each(|attachment| test::attach(&mut out, folder, attachment));
        }
        if !out.is_empty() {
            junit.set_system_out(out);
        }
    }
}
