//! Hooks in the text report.

use rtf_model::{HookRecord, HookRunRecord, Record, Trigger};

use super::lines::TextLines;
use crate::explain::{self, Extent};
use crate::{cause, words};

pub(super) fn show(lines: &mut TextLines, record: &Record, hook: &HookRecord) {
    let on: Vec<_> = hook.plan.on.iter().map(|trigger| Trigger::as_str(*trigger)).collect();
    lines.fact(2, "hook", &format!("{} (on {})", hook.plan.name, on.join(", ")));
    if hook.runs.is_empty() {
        lines.at(4, "it was not triggered");
    }
    for (number, run) in (1..).zip(&hook.runs) {
        show_run(lines, record, (number, run));
    }
}

fn show_run(lines: &mut TextLines, record: &Record, (number, run): (usize, &HookRunRecord)) {
    let how = match (run.problem().is_some(), run.duration()) {
        (_, None) => "it did not finish".to_owned(),
        (false, Some(took)) => format!("done after {}", words::time(took)),
        (true, Some(took)) => format!("failed after {}", words::time(took)),
    };
    lines.at(4, &format!("run {number} on {}: {how}", run.trigger));
    lines.fact(6, "reason", cause::short(record, &run.reason));
    if let Some(test) = run.test {
        lines.fact(6, "about", &record.full_name(test));
    }
    explain::hook(run, Extent::ALL, &mut |_, line| lines.at(6, line));
    if !run.output.is_empty() {
        lines.at(6, "it printed:");
        lines.quoted(6, &run.output);
    }
}
