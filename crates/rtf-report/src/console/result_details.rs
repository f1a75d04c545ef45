//! Details of the result of a test or hook: its leaked processes, and the end of its output.

use rtf_model::LeakedProcess;

use super::page::ConsoleLines;
use super::style::LOUD;
use crate::explain::{self, Extent, Tone};
use crate::words;

/// How much of a failed test is shown; the reports contain everything.
pub(super) const EXTENT: Extent = Extent { items: 10, stack_lines: 40 };

/// Number of output lines of a failed test.
const OUTPUT_LINES: usize = 20;

/// Shows leaked processes of a test or hook that succeeded.
pub(super) fn leaked(page: &mut ConsoleLines, name: &str, processes: &[LeakedProcess]) {
    if !processes.is_empty() {
        page.remark((LOUD, "leaked"), name);
        explain::left(processes, &mut |tone, line| page.detail(tone, line));
    }
}

/// Shows the last lines of an output, and the log with all lines.
pub(super) fn output(text: &str, log: Option<String>, sink: explain::Sink<'_>) {
    let (lines, total) = words::tail(text, OUTPUT_LINES);
    let heading = match total {
        0..=OUTPUT_LINES => "it printed:".to_owned(),
        _ => format!("the last {OUTPUT_LINES} of {total} lines that it printed:"),
    };
    sink(Tone::Plain, &heading);
    explain::printed(lines, sink);
    if let Some(log) = log.filter(|_| total > OUTPUT_LINES) {
        sink(Tone::Dim, &format!("full log: {log}"));
    }
}
