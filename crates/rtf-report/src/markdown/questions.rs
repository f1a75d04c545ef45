//! The questions of the deciding attempts to an operator, with their answers.

use rtf_model::Record;

use super::inline::code;
use super::{heading, row};
use crate::words;

/// Maximum number of questions in the table.
const ROWS: usize = 200;

/// Shows the table, if an operator was asked.
pub(super) fn show(page: &mut String, record: &Record) {
    let mut rows = Vec::new();
    for test in &record.tests {
        let Some(attempt) = test.decisive_attempt() else { continue };
        let name = record.full_name(test.plan.test);
        for question in &attempt.questions {
            let text = question.asked.text.lines().collect::<Vec<_>>().join(" ");
            rows.push([code(&name), code(&text), code(&question.answer_summary())]);
        }
    }
    if rows.is_empty() {
        return;
    }
    heading(page, "Questions");
    *page += "| test | question | answer |\n|---|---|---|\n";
    rows.iter().take(ROWS).for_each(|cells| row(page, cells));
    if let Some(more) = rows.len().checked_sub(ROWS).filter(|more| *more > 0) {
        *page += &format!("\n… and {}\n", words::count(more as u64, "more question"));
    }
}
