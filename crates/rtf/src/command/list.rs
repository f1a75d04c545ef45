//! `rtf list`: the tests that `rtf run` would run, one a line.

use std::io::Write;
use std::process::ExitCode;

use rtf_engine::plan::{Plan, TestPlan};
use rtf_report::escape;

use super::{Outcome, planning};
use crate::cli::InputArgs;
use crate::error::Failure;

/// Lists.
pub fn run(args: &InputArgs) -> Outcome {
    let planned = planning::plan(args)?;
    planned.show_warnings()?;
    let mut out = std::io::BufWriter::new(anstream::stdout().lock());
    Failure::unless_reader_left(write(&planned.plan, &mut out))?;
    Ok(ExitCode::SUCCESS)
}

fn write(plan: &Plan, out: &mut impl Write) -> std::io::Result<()> {
    for suite in &plan.suites {
        for test in &suite.tests {
            let name = format!("{}/{}", suite.name, test.name);
            writeln!(out, "{}{}", escape::line(&name), notes(test))?;
        }
    }
    out.flush()
}

fn notes(test: &TestPlan) -> String {
    let mut notes = Vec::new();
    if test.repetitions > 1 {
        notes.push(format!("{} times", test.repetitions));
    }
    if test.critical {
        notes.push("critical".to_owned());
    }
    notes.extend(test.tags.iter().map(|tag| format!("#{}", escape::line(tag))));
    if notes.is_empty() { String::new() } else { format!("  ({})", notes.join(", ")) }
}
