//! `rtf check`: every problem of suites and plug-ins; nothing is started.

use std::io::Write;
use std::process::ExitCode;

use super::Outcome;
use super::planning::{self, count};
use crate::cli::CheckArgs;
use crate::error::Failure;

/// Checks.
pub fn run(args: &CheckArgs) -> Outcome {
    let planned = planning::plan(&args.input, &args.results)?;
    planned.show_warnings()?;
    let plan = planned.plan;
    let summary = [
        count(plan.suites.len(), "suite"),
        count(plan.fixtures as usize, "fixture"),
        count(plan.tests as usize, "test"),
    ];
    let warned = match planned.warnings.len() {
        0 => String::new(),
        many => format!(", {}", count(many, "warning")),
    };
    let written = writeln!(anstream::stdout(), "{}: no errors{warned}", summary.join(", "));
    Failure::unless_reader_left(written)?;
    Ok(ExitCode::SUCCESS)
}
