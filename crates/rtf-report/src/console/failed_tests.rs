//! The tests that did not pass, in the summary.

use std::path::Path;

use rtf_model::{Attachment, Phase, Record, Significance, TestRecord, Verdict};

use super::case_summary;
use super::options::{ReplayCommand, View};
use super::page::ConsoleLines;
use super::style::{self, BOLD};
use crate::cases::TestCases;
use crate::{escape, explain, known_failure, logs, words};

/// The endings of recordings that a fixture can replay.
const RECORDINGS: [&str; 3] = [".mcap", ".bag", ".tar.gz"];

pub(super) fn show(page: &mut ConsoleLines, view: View<'_>) {
    let record = view.record;
    let failed: Vec<_> = record.tests.iter().filter(|test| is_failed(record, test)).collect();
    if failed.is_empty() {
        return;
    }
    page.heading(BOLD, "tests that did not pass:");
    for test in failed {
        failed_test(page, view, test);
    }
}

/// Whether a test did not pass. The runner's skips and unexpected passes are listed
/// separately.
fn is_failed(record: &Record, test: &TestRecord) -> bool {
    let is_listed = match test.significance() {
        Significance::UnexpectedPass => false,
        Significance::SkippedItself => true,
        _ => test.final_verdict() != Verdict::Skipped,
    };
    is_listed && !record.is_test_green(test)
}

fn failed_test(page: &mut ConsoleLines, view: View<'_>, test: &TestRecord) {
    let View { options, record } = view;
    let id = test.plan.test;
    let attempt = test.decisive_attempt();
    let cases = TestCases::of(test);
    failed_title(page, record, test);
    // The reason is that of a case, which is listed.
    let is_reported = cases.as_ref().is_some_and(|cases| !cases.has_test_problem(test));
    let red_reason = known_failure::red_reason(record, test);
    match red_reason.as_deref().or(test.reason()) {
        Some(reason) if red_reason.is_some() || !is_reported => {
            page.fact("reason", &words::short_line(reason));
        }
        None if !record.is_complete() => page.fact("reason", "the run ended before the test did"),
        _ => {}
    }
    if !is_reported {
        first_problem(page, test);
    }
    case_summary::mark(page, test);
    if let Some(attempt) = attempt.filter(|attempt| !attempt.output.is_empty()) {
        let log = logs::attempt_log(record, id, (attempt.repetition, attempt.attempt));
        options.shown(&log).into_iter().for_each(|log| page.fact("log", &log));
    }
    if let Some(command) = (options.rerun)(record, id, None) {
        page.fact("rerun", &escape::line(&command));
    }
    let dir = options.folder.as_deref();
    if let Some(command) = dir.and_then(|dir| replay_test(&options.replay, record, test, dir)) {
        page.fact("replay", &escape::line(&command));
    }
    if let Some(cases) = &cases {
        case_summary::failed_cases(page, view, test, cases);
    }
}

/// Returns the command that replays the recording of the attempt that failed; `dir` is the run's
/// directory for display.
#[must_use]
pub fn replay_test(
    replay: &ReplayCommand,
    record: &Record,
    test: &TestRecord,
    dir: &Path,
) -> Option<String> {
    if record.is_test_green(test) {
        return None;
    }
    let attachments = &test.decisive_attempt()?.attachments;
    let recording = attachments.iter().find(|it| is_recording(it))?;
    replay(record, test.plan.test, &dir.join(&recording.path))
}

/// Whether a fixture can replay this attachment.
#[must_use]
pub fn is_recording(attachment: &Attachment) -> bool {
    let path = &attachment.path;
    !attachment.omitted && RECORDINGS.iter().any(|ending| path.ends_with(ending))
}

/// `  arm/MoveTest  failed in set-up`.
fn failed_title(page: &mut ConsoleLines, record: &Record, test: &TestRecord) {
    let finished = test.decisive_attempt().and_then(|attempt| attempt.finished.as_ref());
    let phase = finished.map(|(_, finished)| finished.phase).filter(|phase| *phase != Phase::Run);
    let verdict = test.final_verdict();
    let phase = phase.filter(|_| verdict.is_problem());
    let phase = phase.map_or(String::new(), |phase| format!(" in {phase}"));
    let name = style::paint(BOLD, &escape::line(&record.full_name(test.plan.test)));
    let verdict = style::paint(style::of_verdict(verdict), verdict.as_str());
    page.line(&format!("  {name}  {verdict}{phase}"));
}

/// Shows the first failure of an attempt without an end, and the location of the first
/// problem.
fn first_problem(page: &mut ConsoleLines, test: &TestRecord) {
    let attempt = test.decisive_attempt();
    let first = attempt.and_then(|attempt| explain::own_failures(attempt).next());
    let is_open = attempt.is_none_or(|attempt| attempt.finished.is_none());
    if let (true, Some(failure)) = (is_open, first) {
        page.fact("before", &words::short_line(&failure.text));
    }
    let violation = attempt.and_then(|attempt| attempt.violations().next());
    let place = first.and_then(|message| message.location.as_ref());
    if let Some(location) = place.or(violation.and_then(|v| v.location.as_ref())) {
        page.fact("at", &escape::line(&location.to_string()));
    }
}
