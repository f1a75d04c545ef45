//! A declared test as a JUnit test case.

use std::path::Path;

use quick_junit::{NonSuccessKind, TestCase, TestCaseStatus, TestRerun};
use rtf_model::{
    Attachment, AttemptRecord, Measurement, Record, Significance, TestRecord, Verdict,
};

use super::{described, first_line, text, time};
use crate::explain::{self, Extent, Tone};
use crate::{known_failure, words};

/// More measurements, questions or series than this would drown the page that shows them.
const MEASUREMENTS: usize = 100;

/// The reason of a test that was running when the run ended.
const CUT_SHORT: &str = "the run ended before the test did";

/// The reason of a flaky test, if flaky tests fail.
const FLAKY: &str = "it is flaky: it passed only after a retry";

/// The reason of a test that had not started when the run ended.
const NOT_BEGUN: &str = "the run ended before the test started";

pub(super) fn of(record: &Record, test: &TestRecord, folder: Option<&Path>) -> TestCase {
    let mut case = TestCase::new(text(&test.plan.name), status(record, test));
    let suite = record.suites.get(test.plan.suite.index()).map_or("", |s| &s.plan.name);
    case.set_classname(text(suite));
    case.set_time(test.duration());
    if let Some(first) = test.attempts.first() {
        case.timestamp = time::at(record, first.started);
    }
    add_details(&mut case, test, folder);
    case
}

/// Adds properties, leaked processes, output and attachments of a test.
pub(super) fn add_details(case: &mut TestCase, test: &TestRecord, folder: Option<&Path>) {
    properties(case, test);
    let left: Vec<_> = test.attempts.iter().flat_map(|a| a.leaked.iter().cloned()).collect();
    super::leaked(case, &left, test.final_verdict() == Verdict::Passed);
    let out = system_out(test, folder);
    if !out.is_empty() {
        case.set_system_out(out);
    }
}

/// Explains an attempt without its cases: how it ended, and its own problems.
pub(super) fn ending(test: &TestRecord, attempt: &AttemptRecord) -> String {
    let explained = explained(attempt);
    if explained.is_empty() { explained } else { format!("{}\n{explained}", title(test, attempt)) }
}

fn status(record: &Record, test: &TestRecord) -> TestCaseStatus {
    let verdict = test.final_verdict();
    if known_failure::is_known(test) {
        return known(record, test);
    }
    if let Some(reason) = known_failure::red_reason(record, test) {
        return red(record, test, &reason);
    }
    let status = match verdict {
        Verdict::Passed => return passed(record, test),
        Verdict::Skipped => TestCaseStatus::skipped(),
        verdict => TestCaseStatus::non_success(kind(verdict)),
    };
    let unspoken = if test.attempts.is_empty() { NOT_BEGUN } else { CUT_SHORT };
    let reason = if test.verdict().is_some() { test.reason() } else { Some(unspoken) };
    let reason = reason.unwrap_or(verdict.as_str());
    described(status, verdict.as_str(), first_line(reason), description(record, test, reason))
}

/// A known failure is skipped, as in pytest: no server has a word for it.
fn known(record: &Record, test: &TestRecord) -> TestCaseStatus {
    let description = description(record, test, test.reason().unwrap_or_default());
    let (kind, message) = (test.final_verdict().as_str(), known_failure::describe(test));
    described(TestCaseStatus::skipped(), kind, &message, description)
}

/// A test that passed or skipped itself, and makes the run red.
fn red(record: &Record, test: &TestRecord, reason: &str) -> TestCaseStatus {
    let kind = match test.significance() {
        Significance::UnexpectedPass => "unexpected-pass",
        _ => Verdict::Skipped.as_str(),
    };
    let status = TestCaseStatus::non_success(NonSuccessKind::Failure);
    described(status, kind, reason, description(record, test, reason))
}

pub(super) fn kind(verdict: Verdict) -> NonSuccessKind {
    match verdict {
        Verdict::Failed => NonSuccessKind::Failure,
        _ => NonSuccessKind::Error,
    }
}

/// A failure because it is flaky.
pub(super) fn flaky(mut status: TestCaseStatus) -> TestCaseStatus {
    status.set_message(FLAKY);
    status.set_type("flaky");
    status
}

/// A pass names the attempts that did not, as flaky runs.
fn passed(record: &Record, test: &TestRecord) -> TestCaseStatus {
    if test.is_flaky() && record.flaky_fails() {
        let mut status = flaky(TestCaseStatus::non_success(NonSuccessKind::Failure));
        status.set_description(description(record, test, FLAKY));
        return status;
    }
    let mut status = TestCaseStatus::success();
    for attempt in &test.attempts {
        let Some((_, finished)) = &attempt.finished else { continue };
        if finished.verdict.is_green() {
            continue;
        }
        let mut rerun = TestRerun::new(kind(finished.verdict));
        rerun.timestamp = time::at(record, attempt.started);
        rerun.set_time(attempt.duration().unwrap_or_default());
        rerun.set_type(finished.verdict.as_str());
        rerun.set_message(text(finished.reason.as_deref().unwrap_or_default()));
        rerun.set_description(explained(attempt));
        status.add_rerun(rerun);
    }
    status
}

/// Everything that explains the verdict: each attempt that did not pass, and
/// before them the reason when it is none of theirs.
fn description(record: &Record, test: &TestRecord, reason: &str) -> String {
    let attempts = test.attempts.iter().filter(|a| a.verdict() != Some(Verdict::Passed));
    let mut reasons = attempts.clone().filter_map(|a| a.finished.as_ref()?.1.reason.as_deref());
    let mut lines = Vec::new();
    if reasons.all(|told| told != reason) {
        lines.push(text(reason));
    }
    for attempt in attempts {
        lines.extend([title(test, attempt), explained(attempt)]);
    }
    // A test that was skipped for a broken fixture has its cause in the fixture's case.
    if test.attempts.iter().any(|a| a.verdict() == Some(Verdict::Collapsed)) {
        lines.extend(fixture_tails(record, test));
    }
    lines.retain(|line| !line.is_empty());
    lines.join("\n")
}

fn title(test: &TestRecord, attempt: &AttemptRecord) -> String {
    let mut title = words::repetition(test, attempt);
    title += &format!(", attempt {}", attempt.attempt);
    let Some((_, finished)) = &attempt.finished else { return title + ": it did not finish" };
    title += &format!(": {} in {}", finished.verdict, finished.phase);
    if let Some(exit) = finished.exit {
        title += &format!(", {exit}");
    }
    title
}

fn explained(attempt: &AttemptRecord) -> String {
    explain::lines(|sink| explain::attempt(attempt, Extent::ALL, sink)).join("\n")
}

/// The last lines of the fixtures that are to blame.
fn fixture_tails(record: &Record, test: &TestRecord) -> Vec<String> {
    let suite = record.suites.get(test.plan.suite.index());
    let fixtures = suite.iter().flat_map(|suite| &suite.fixtures);
    let fixtures = fixtures.filter_map(|id| record.fixture(*id));
    explain::lines(|sink| {
        for fixture in fixtures.filter(|fixture| !fixture.log_tail.is_empty()) {
            let heading = format!("the last lines of fixture {}:", fixture.plan.name);
            sink(Tone::Plain, &text(&heading));
            explain::printed(fixture.log_tail.iter().map(String::as_str), sink);
        }
    })
}

fn properties(case: &mut TestCase, test: &TestRecord) {
    case.add_property(("plugin", text(&test.plan.plugin).as_str()));
    for tag in &test.plan.tags {
        case.add_property(("tag", text(tag).as_str()));
    }
    let measurements = test.deciding_attempts().flat_map(|attempt| {
        attempt.measurements.iter().filter(|it| !explain::is_in_case(attempt, it.case))
    });
    for measurement in measurements.take(MEASUREMENTS) {
        add_measurement(case, measurement);
    }
    let questions = test.deciding_attempts().flat_map(|attempt| &attempt.questions);
    for question in questions.take(MEASUREMENTS) {
        let title = question.asked.text.lines().next().unwrap_or_default();
        let name = text(&format!("question.{title}"));
        case.add_property((name, text(&question.answer_summary())));
    }
    let faults = test.deciding_attempts();
    let faults = faults.flat_map(|attempt| attempt.faults.iter().map(move |it| (attempt, it)));
    for (attempt, fault) in faults.take(MEASUREMENTS) {
        let times = explain::fault_times(attempt, fault);
        let (kind, effect) = (fault.fault.kind.as_str(), &fault.fault.effect);
        let name = text(&format!("fault.{}", fault.fault.name));
        case.add_property((name, text(&format!("{kind} {times}: {effect}"))));
    }
    let series = test.deciding_attempts().flat_map(|attempt| &attempt.series);
    for series in series.take(MEASUREMENTS) {
        let name = text(&format!("series.{}", series.name));
        case.add_property((name, text(&series.summary())));
    }
}

/// Adds a measurement as a property.
pub(super) fn add_measurement(case: &mut TestCase, measurement: &Measurement) {
    let name = text(&format!("measurement.{}", measurement.name));
    let mut value = measurement.value_with_unit();
    let limits = measurement.limits();
    if !limits.is_empty() {
        let learned = if measurement.learned { "learned: " } else { "" };
        value += &format!(" ({learned}{limits})");
    }
    case.add_property((name, text(&value)));
}

/// What the attempts printed and attached.
fn system_out(test: &TestRecord, folder: Option<&Path>) -> String {
    let mut out = String::new();
    for attempt in &test.attempts {
        if !attempt.output.is_empty() {
            if test.attempts.len() > 1 {
                out += &title(test, attempt);
                out.push('\n');
            }
            out += &text(&attempt.output);
        }
        attach_all(&mut out, folder, attempt);
    }
    out
}

/// Adds the files of an attempt; those of a case are in its own test case.
fn attach_all(out: &mut String, folder: Option<&Path>, attempt: &AttemptRecord) {
    let Some(folder) = folder else { return };
    let is_kept = |it: &&Attachment| !explain::is_in_case(attempt, it.case);
    for attachment in attempt.attachments.iter().filter(is_kept) {
        attach(out, folder, attachment);
    }
}

/// The lines that name the files of a test.
pub(crate) fn attachments(test: &TestRecord, folder: Option<&Path>) -> String {
    let mut out = String::new();
    test.attempts.iter().for_each(|attempt| attach_all(&mut out, folder, attempt));
    out
}

/// Adds a file, unless it was not kept, as both Jenkins and GitLab find it.
pub(super) fn attach(out: &mut String, folder: &Path, attachment: &Attachment) {
    if attachment.omitted {
        return;
    }
    if !out.is_empty() && !out.ends_with('\n') {
        out.push('\n');
    }
    let path = folder.join(&attachment.path);
    *out += &format!("[[ATTACHMENT|{}]]\n", text(&path.display().to_string()));
}
