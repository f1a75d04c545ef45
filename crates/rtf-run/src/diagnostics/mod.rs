//! Prints the problems of suites, plug-ins and `rtf.toml` to standard error.

mod render;

use rtf_model::{Diagnostic, Severity};
use rtf_plan::suite::SourceMap;

use crate::error::Failure;
use crate::terminal;

pub fn print(diagnostics: &[Diagnostic], sources: &SourceMap) -> Result<(), Failure> {
    // The stream removes the colours if they are not wanted.
    terminal::stderr(|err| render::write(err, diagnostics, sources, true))
}

/// Prints problems, at least one of which is an error, and their number.
pub fn refuse(problems: &[Diagnostic], sources: &SourceMap) -> Failure {
    let number = |severity| problems.iter().filter(|p| p.severity == severity).count();
    let mut sum = count(number(Severity::Error), "error");
    if number(Severity::Warning) > 0 {
        sum += &format!(" and {}", count(number(Severity::Warning), "warning"));
    }
    let printed = print(problems, sources)
        .and_then(|()| terminal::stderr(|err| writeln!(err, "{sum}; nothing was started")));
    printed.err().unwrap_or_else(Failure::printed)
}

/// A number with its noun: `1 suite`, `2 suites`.
pub fn count(number: usize, noun: &str) -> String {
    if number == 1 { format!("1 {noun}") } else { format!("{number} {noun}s") }
}
