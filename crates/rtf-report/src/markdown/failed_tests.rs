//! The tests that make the run red, each with its reason, locations and last messages.

use rtf_model::{AttemptRecord, MessageKind, Record, TestRecord};

use super::inline::{block, code, first_line};
use super::{MarkdownOptions, heading, list};
use crate::console::replay_test;
use crate::explain;
use crate::finding::{self, Finding, Roots};
use crate::{logs, words};

/// The details of the tests take up to this many bytes, far below the 1 MiB that GitHub
/// accepts.
const DETAILS_BYTES: usize = 300 << 10;

/// Maximum number of tests that are listed without details.
const NAMES: usize = 200;

/// Maximum number of the last messages, and of the last lines of output, of a test.
const LAST: usize = 15;

pub(super) fn show(
    page: &mut String,
    record: &Record,
    roots: &Roots<'_>,
    options: &MarkdownOptions<'_>,
) {
    let failed = record.tests.iter().filter(|test| finding::is_problem(record, test));
    let failed: Vec<_> = failed.collect();
    if failed.is_empty() {
        return;
    }
    heading(page, "Tests that did not pass");
    let start = page.len();
    let mut shown = 0;
    for test in &failed {
        if page.len() - start > DETAILS_BYTES {
            break;
        }
        show_test(page, record, (test, &finding::of_test(record, test, roots)), options);
        shown += 1;
    }
    let rest = &failed[shown..];
    if !rest.is_empty() {
        *page += &format!("{} without details:\n\n", words::count(rest.len() as u64, "more test"));
        list(page, rest, NAMES, "test", |test| {
            let name = code(&record.full_name(test.plan.test));
            format!("{name} {}", test.final_verdict())
        });
    }
}

fn show_test(
    page: &mut String,
    record: &Record,
    (test, findings): (&TestRecord, &[Finding]),
    options: &MarkdownOptions<'_>,
) {
    let name = code(&record.full_name(test.plan.test));
    let reason = findings.first().and_then(|finding| finding.text.lines().next());
    let reason = test.reason().or(reason).unwrap_or_default();
    let verdict = test.final_verdict();
    *page += "<details>\n<summary>";
    *page += &format!("{name} <b>{verdict}</b>: {}</summary>\n\n", first_line(reason));
    facts(page, record, (test, findings), options);
    for finding in findings {
        if findings.len() > 1 {
            *page += &format!("{}\n\n", code(&finding.title));
        }
        block(page, finding.text.lines());
        *page += "\n";
    }
    if let Some(attempt) = test.decisive_attempt() {
        last_messages(page, attempt);
        last_output(page, attempt);
    }
    *page += "</details>\n\n";
}

/// Where the test is, its log, and the command that reruns it.
fn facts(
    page: &mut String,
    record: &Record,
    (test, findings): (&TestRecord, &[Finding]),
    options: &MarkdownOptions<'_>,
) {
    if let Some(place) = findings.first().and_then(|finding| finding.place.as_ref()) {
        let line = if place.line > 0 { format!(":{}", place.line) } else { String::new() };
        *page += &format!("- at {}\n", code(&format!("{}{line}", place.file)));
    }
    let attempt = test.decisive_attempt().filter(|attempt| !attempt.output.is_empty());
    if let Some((attempt, dir)) = attempt.zip(options.dir) {
        let id = (attempt.repetition, attempt.attempt);
        let log = dir.join(logs::attempt_log(record, test.plan.test, id));
        *page += &format!("- log {}\n", code(&log.to_string_lossy()));
    }
    if let Some(command) = (options.commands.rerun)(record, test.plan.test, None) {
        *page += &format!("- rerun {}\n", code(&command));
    }
    let replay = &options.commands.replay;
    if let Some(command) = options.dir.and_then(|dir| replay_test(replay, record, test, dir)) {
        *page += &format!("- replay {}\n", code(&command));
    }
    *page += "\n";
}

/// The last messages that are no problems: problems are listed above.
fn last_messages(page: &mut String, attempt: &AttemptRecord) {
    let is_reported = |kind| matches!(kind, MessageKind::Report | MessageKind::Check);
    let messages: Vec<_> =
        attempt.messages.iter().filter(|message| is_reported(message.kind)).collect();
    let last_ones = &messages[messages.len().saturating_sub(LAST)..];
    let lines = explain::lines(|sink| {
        last_ones.iter().for_each(|message| explain::message(message, sink));
    });
    if lines.is_empty() {
        return;
    }
    let all = messages.len() as u64 + attempt.messages_omitted;
    *page += &format!("{}:\n\n", last("message", LAST as u64, all));
    block(page, lines.iter().map(String::as_str));
    *page += "\n";
}

fn last_output(page: &mut String, attempt: &AttemptRecord) {
    let (lines, all) = words::tail(&attempt.output, LAST);
    if all > 0 {
        *page += &format!("{}:\n\n", last("line of output", LAST as u64, all as u64));
        block(page, lines);
        *page += "\n";
    }
}

/// `the last 15 of 40 messages`, or `3 messages`.
fn last(noun: &str, limit: u64, all: u64) -> String {
    let plural = match noun.split_once(' ') {
        Some((first, rest)) => format!("{} {rest}", words::plural(all, first)),
        None => words::plural(all, noun).into_owned(),
    };
    if all > limit {
        format!("the last {limit} of {all} {plural}")
    } else {
        format!("{all} {plural}")
    }
}
