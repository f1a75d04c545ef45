//! Tests in the text report.

use rtf_model::{AttemptRecord, MessageKind, Record, TestRecord};

use super::cases;
use super::lines::TextLines;
use crate::explain::{self, Extent};
use crate::{cause, escape, known_failure, words};

pub(super) fn show(lines: &mut TextLines, record: &Record, test: &TestRecord) {
    let plan = &test.plan;
    lines.fact(2, "test", &format!("{} ({})", plan.name, plan.plugin_type));
    lines.fact(4, "plug-in", &plan.plugin);
    lines.fact(4, "tags", &plan.tags.join(" "));
    let verdict = test.final_verdict();
    lines.at(4, &format!("verdict: {verdict}"));
    lines.parameters(4, &plan.parameters);
    mark(lines, record, test);
    if let Some(reason) = test.reason() {
        lines.fact(4, "reason", cause::short(record, reason));
    } else if !record.is_complete() && test.verdict().is_none() {
        let what = if test.attempts.is_empty() { "began" } else { "did" };
        lines.at(4, &format!("reason: the run ended before the test {what}"));
    }
    for attempt in &test.attempts {
        show_attempt(lines, test, attempt);
    }
    if let Some(reason) = test.skipped.as_deref().filter(|_| !test.attempts.is_empty()) {
        lines.fact(4, "the rest was skipped", cause::short(record, reason));
    }
}

/// How the verdict counts, if otherwise than that of other tests.
fn mark(lines: &mut TextLines, record: &Record, test: &TestRecord) {
    if known_failure::is_known(test) {
        lines.at(4, &format!("counts as: {}", known_failure::word(test)));
    } else if let Some(reason) = known_failure::red_reason(record, test) {
        lines.fact(4, "counts as failed", &reason);
    }
    let facts = test.plan.expected.as_deref().map(known_failure::facts);
    facts.iter().flatten().for_each(|(label, text)| lines.fact(4, label, text));
}

fn show_attempt(lines: &mut TextLines, test: &TestRecord, attempt: &AttemptRecord) {
    let mut title = words::repetition(test, attempt);
    if attempt.attempt > 1 {
        title += &format!(", attempt {}", attempt.attempt);
    }
    match &attempt.finished {
        None => title += ": it did not finish",
        Some((at, finished)) => {
            let time = words::time(at.since(attempt.started));
            title += &format!(": {} in {} after {time}", finished.verdict, finished.phase);
            if let Some(exit) = finished.exit {
                title += &format!(", {exit}");
            }
            if finished.rerun {
                title += ", will be retried";
            }
        }
    }
    lines.at(4, &title);
    phases(lines, attempt);
    details(lines, attempt);
}

fn phases(lines: &mut TextLines, attempt: &AttemptRecord) {
    let ends = attempt.phases.iter().skip(1).map(|(_, at)| *at);
    let ends = ends.chain(attempt.finished.as_ref().map(|(at, _)| *at));
    let took =
        |((phase, start), end): (&(rtf_model::Phase, rtf_model::Micros), rtf_model::Micros)| {
            format!("{phase} {}", words::time(end.since(*start)))
        };
    let phases: Vec<_> = attempt.phases.iter().zip(ends).map(took).collect();
    lines.fact(6, "phases", &phases.join(", "));
    if attempt.slow {
        lines.at(6, "it was slow");
    }
}

fn details(lines: &mut TextLines, attempt: &AttemptRecord) {
    // Failures, violations, stacks and leaked processes come first,
    // then everything else.
    explain::attempt(attempt, Extent::ALL, &mut |_, line| lines.at(6, line));
    cases::show(lines, attempt);
    let is_own = |case| !explain::is_in_case(attempt, case);
    let others = attempt
        .messages
        .iter()
        .filter(|message| matches!(message.kind, MessageKind::Report | MessageKind::Check))
        .filter(|message| is_own(message.case));
    for message in others {
        explain::message(message, &mut |_, line| lines.at(6, line));
    }
    if attempt.messages_omitted > 0 {
        let more = words::plural(attempt.messages_omitted, "message");
        lines.at(6, &format!("… and {} more {more} in the journal", attempt.messages_omitted));
    }
    for question in &attempt.questions {
        explain::question(question, &mut |_, line| lines.at(6, line));
    }
    let within = attempt.measurements.iter().filter(|it| it.is_within_limits() && is_own(it.case));
    within.for_each(|measurement| lines.at(6, &explain::measurement(measurement)));
    for series in attempt.series.iter().filter(|series| series.outside == 0) {
        lines.at(6, &explain::series(series));
    }
    for attachment in attempt.attachments.iter().filter(|it| is_own(it.case)) {
        let (name, place) = (escape::line(&attachment.name), words::attachment_place(attachment));
        lines.fact(6, "attached", &format!("{name}: {place}"));
    }
    if !attempt.output.is_empty() {
        lines.at(6, "it printed:");
        lines.quoted(6, &attempt.output);
    }
}
