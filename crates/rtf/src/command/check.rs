//! `rtf check`: every problem of suites and plug-ins; nothing is started.

use std::io::Write;
use std::process::ExitCode;

use super::{Outcome, planning};
use crate::cli::InputArgs;
use crate::error::Failure;

/// Checks.
pub fn run(args: &InputArgs) -> Outcome {
    let planned = planning::plan(args)?;
    let plan = planned.plan;
    let count = |number: usize, one: &str| {
        if number == 1 { format!("1 {one}") } else { format!("{number} {one}s") }
    };
    let summary = [
        count(plan.suites.len(), "suite"),
        count(plan.fixtures as usize, "fixture"),
        count(plan.tests as usize, "test"),
    ];
    writeln!(anstream::stdout(), "{}: no errors", summary.join(", ")).map_err(Failure::own)?;
    Ok(ExitCode::SUCCESS)
}
