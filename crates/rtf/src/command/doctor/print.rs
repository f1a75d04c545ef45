//! Prints findings, as text or JSON.

use std::io::{self, Write};

use rtf_report::escape;
use rtf_run::doctor::{CheckResult, Component, Missing};
use rtf_run::error::Failure;
use rtf_run::terminal;
use serde::Serialize;

/// The column of details.
const DETAILS: usize = 27;

/// Prints text for people.
pub fn text(findings: &[CheckResult]) -> Result<(), Failure> {
    terminal::stdout(|out| write(findings, out))
}

fn write(findings: &[CheckResult], out: &mut dyn Write) -> io::Result<()> {
    let (fixtures, components): (Vec<_>, Vec<_>) =
        findings.iter().partition(|finding| finding.part == Component::Fixture);
    for (title, findings) in [("rtf", components), ("fixtures", fixtures)] {
        if !findings.is_empty() {
            writeln!(out, "{title}")?;
        }
        for finding in findings {
            write_finding(finding, out)?;
        }
    }
    Ok(())
}

fn write_finding(finding: &CheckResult, out: &mut dyn Write) -> io::Result<()> {
    let (colour, word) =
        if finding.ok { ("\u{1b}[32m", "ok     ") } else { ("\u{1b}[31m", "missing") };
    let name = escape::line(&finding.name);
    let about = escape::line(&finding.about);
    writeln!(out, "  {colour}{word}\u{1b}[0m  {name:<14}  {about}")?;
    for found in &finding.found {
        writeln!(out, "{:DETAILS$}{}", "", escape::line(found))?;
    }
    for Missing { what, install, purpose } in &finding.missing {
        let purpose =
            purpose.as_ref().map_or(String::new(), |option| format!(" (only for {option})"));
        let line = format!("{what}{purpose}");
        writeln!(out, "{:DETAILS$}{}", "", escape::line(&line))?;
        writeln!(out, "{:DETAILS$}{}", "", escape::line(&format!("hint: {install}")))?;
    }
    Ok(())
}

#[derive(Serialize)]
struct Document<'f> {
    rtf: &'static str,
    findings: &'f [CheckResult],
}

/// Prints one JSON document.
pub fn json(findings: &[CheckResult]) -> Result<(), Failure> {
    let document = Document { rtf: env!("CARGO_PKG_VERSION"), findings };
    terminal::stdout(|out| {
        serde_json::to_writer_pretty(&mut *out, &document)?;
        writeln!(out)
    })
}
