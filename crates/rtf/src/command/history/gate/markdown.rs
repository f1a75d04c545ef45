//! A judgement in Markdown, for a pull request.

use std::io::{self, Write};

use rtf_history::answers::gate::GateReport;
use rtf_report::markdown::{code, words as plain};

use super::words::{self, GateWords};

/// How many tests a gate lists: code hosts refuse long comments.
const LINES: usize = 50;

pub fn write(out: &mut dyn Write, report: &GateReport) -> io::Result<()> {
    let outcome = if report.passed { "passed" } else { "failed" };
    writeln!(out, "## Robot tests: gates {outcome}\n\n{}\n", plain(&words::head(report)))?;
    writeln!(out, "| gate | result |\n|---|---|")?;
    let gates = words::gates(report);
    for gate in &gates {
        writeln!(out, "| {} | {} |", plain(&gate.title), outcome_of(gate))?;
    }
    gates.iter().try_for_each(|gate| write_details(out, gate))
}

fn outcome_of(gate: &GateWords) -> &'static str {
    if gate.passed { "passed" } else { "**failed**" }
}

fn write_details(out: &mut dyn Write, gate: &GateWords) -> io::Result<()> {
    if gate.lines.is_empty() && gate.notes.is_empty() {
        return Ok(());
    }
    writeln!(out, "\n### {}\n", plain(&gate.title))?;
    for line in gate.lines.iter().take(LINES) {
        let details = if line.details.is_empty() {
            String::new()
        } else {
            format!(": {}", plain(&line.details))
        };
        writeln!(out, "- {}{details}", code(&line.test))?;
    }
    for note in gate.notes.iter().take(LINES) {
        writeln!(out, "- {}", plain(note))?;
    }
    let omitted = gate.lines.len().saturating_sub(LINES) + gate.notes.len().saturating_sub(LINES);
    if omitted > 0 {
        writeln!(out, "- … {omitted} more")?;
    }
    Ok(())
}
