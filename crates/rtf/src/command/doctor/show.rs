//! Findings, for people and for programs.

use std::io::{self, Write};

use rtf_report::escape;
use serde::Serialize;

use super::{Finding, Missing, Part};
use crate::error::Failure;

/// Details begin in this column.
const DETAILS: usize = 27;

/// Prints them for people.
pub fn text(found: &[Finding]) -> Result<(), Failure> {
    let mut out = anstream::stdout().lock();
    Failure::unless_reader_left(write(found, &mut out))
}

fn write(found: &[Finding], out: &mut impl Write) -> io::Result<()> {
    let (fixtures, own): (Vec<_>, Vec<_>) =
        found.iter().partition(|finding| finding.part == Part::Fixture);
    for (title, findings) in [("rtf", own), ("fixtures", fixtures)] {
        if !findings.is_empty() {
            writeln!(out, "{title}")?;
        }
        for finding in findings {
            one(finding, out)?;
        }
    }
    out.flush()
}

fn one(finding: &Finding, out: &mut impl Write) -> io::Result<()> {
    let (colour, word) =
        if finding.ok { ("\u{1b}[32m", "ok     ") } else { ("\u{1b}[31m", "missing") };
    let name = escape::line(&finding.name);
    let about = escape::line(&finding.about);
    writeln!(out, "  {colour}{word}\u{1b}[0m  {name:<14}  {about}")?;
    for there in &finding.found {
        writeln!(out, "{:DETAILS$}{}", "", escape::line(there))?;
    }
    for Missing { what, install, purpose } in &finding.missing {
        let purpose =
            purpose.as_ref().map_or(String::new(), |text| format!(", which {text} needs"));
        let line = format!("{what}{purpose}");
        writeln!(out, "{:DETAILS$}{}", "", escape::line(&line))?;
        writeln!(out, "{:DETAILS$}{}", "", escape::line(&format!("hint: {install}")))?;
    }
    Ok(())
}

/// All that was found.
#[derive(Serialize)]
struct Document<'f> {
    rtf: &'static str,
    findings: &'f [Finding],
}

/// Prints them for programs.
pub fn json(found: &[Finding]) -> Result<(), Failure> {
    let document = Document { rtf: env!("CARGO_PKG_VERSION"), findings: found };
    let mut out = anstream::stdout().lock();
    let written = serde_json::to_writer_pretty(&mut out, &document)
        .map_err(io::Error::from)
        .and_then(|()| writeln!(out));
    Failure::unless_reader_left(written)
}
