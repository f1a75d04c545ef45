//! The cases of an attempt in the text report.

use std::collections::HashMap;

use rtf_model::{AttemptRecord, CaseId, CaseRecord};

use super::lines::TextLines;
use crate::{escape, explain, words};

/// A case is written this many columns further in than the one that contains it.
const INDENT: usize = 2;

/// The deepest indentation.
const DEPTH: usize = 20;

/// Writes the cases of an attempt in the order in which they started, each with its
/// messages, measurements and attachments.
pub(super) fn show(lines: &mut TextLines, attempt: &AttemptRecord) {
    let cases = &attempt.cases;
    let details = details(attempt);
    for case in cases.kept() {
        show_case(lines, case, details.get(&case.start.case).map_or(&[], Vec::as_slice));
    }
    if cases.omitted() > 0 {
        let more = words::count(cases.omitted(), "more case");
        lines.at(6, &format!("… and {more} that passed in the journal"));
    }
    for name in cases.not_run().names() {
        lines.fact(6, "case that did not run", name);
    }
}

fn show_case(lines: &mut TextLines, case: &CaseRecord, details: &[String]) {
    let indent = 6 + INDENT * case.depth().min(DEPTH);
    let result = match (case.verdict(), case.duration()) {
        (Some(verdict), Some(time)) => {
            let place = match case.is_carried() {
                true => " in an earlier attempt".to_owned(),
                false => words::case_attempt(case),
            };
            format!("{verdict} after {}{place}", words::time(time))
        }
        _ => "it did not finish".to_owned(),
    };
    lines.at(indent, &format!("case {}: {result}", escape::line(&case.start.name)));
    let indent = indent + INDENT;
    lines.fact(indent, "tags", &case.start.tags.join(" "));
    lines.parameters(indent, &case.start.parameters);
    if let Some(reason) = case.reason() {
        lines.fact(indent, "reason", reason);
    }
    details.iter().for_each(|line| lines.at(indent, line));
}

/// The lines of what was reported in each case.
fn details(attempt: &AttemptRecord) -> HashMap<CaseId, Vec<String>> {
    let mut details: HashMap<CaseId, Vec<String>> = HashMap::new();
    if attempt.cases.total() == 0 {
        return details;
    }
    for message in &attempt.messages {
        let Some(case) = message.case else { continue };
        let lines = details.entry(case).or_default();
        explain::message(message, &mut |_, line| lines.push(line.to_owned()));
    }
    for measurement in &attempt.measurements {
        let Some(case) = measurement.case else { continue };
        details.entry(case).or_default().push(explain::measurement(measurement));
    }
    for attachment in &attempt.attachments {
        let Some(case) = attachment.case else { continue };
        let (name, place) = (escape::line(&attachment.name), words::attachment_place(attachment));
        details.entry(case).or_default().push(format!("attached: {name}: {place}"));
    }
    details
}
