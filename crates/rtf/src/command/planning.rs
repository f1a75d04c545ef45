//! What `run`, `check` and `list` have in common: from paths to a plan, with
//! every problem shown.

use std::io::Write;

use rtf_engine::plan::{self, Options, Plan, Surroundings};
use rtf_engine::suite::Sources;
use rtf_model::{Diagnostic, Severity};

use crate::cli::InputArgs;
use crate::error::Failure;
use crate::exit;
use crate::render;

/// A plan, and what the user should look at nevertheless.
pub struct Planned {
    /// What will be done.
    pub plan: Plan,
    /// Warnings. A run's reporters show them; other verbs do it themselves.
    pub warnings: Vec<Diagnostic>,
    sources: Sources,
}

/// Plans; shows every problem on standard error when there is an error.
pub fn plan(args: &InputArgs) -> Result<Planned, Failure> {
    let surroundings = Surroundings::of_process().map_err(Failure::own)?;
    let mut options = Options::new(surroundings);
    options.recursive = args.recursive;
    options.param = args.param.clone().unwrap_or_default();
    options.environment = args.environment.clone().unwrap_or_default();
    options.repetitions = args.repetition.unwrap_or(1);
    let outcome = plan::build(&args.inputs, &options);
    if let Some(plan) = outcome.plan {
        return Ok(Planned { plan, warnings: outcome.diagnostics, sources: outcome.sources });
    }
    show(&outcome.diagnostics, &outcome.sources)?;
    let told = writeln!(anstream::stderr(), "{}; nothing was started", sum(&outcome.diagnostics));
    Failure::unless_reader_left(told)?;
    Err(Failure::told(exit::BAD_INPUT))
}

impl Planned {
    /// Shows the warnings on standard error.
    pub fn show_warnings(&self) -> Result<(), Failure> {
        show(&self.warnings, &self.sources)
    }
}

fn show(diagnostics: &[Diagnostic], sources: &Sources) -> Result<(), Failure> {
    // The stream takes the colours out where they are not wanted.
    let mut err = anstream::stderr().lock();
    Failure::unless_reader_left(render::write(&mut err, diagnostics, sources, true))
}

/// `2 errors and 1 warning`
fn sum(diagnostics: &[Diagnostic]) -> String {
    let of = |severity| diagnostics.iter().filter(|d| d.severity == severity).count();
    let errors = count(of(Severity::Error), "error");
    match of(Severity::Warning) {
        0 => errors,
        warnings => format!("{errors} and {}", count(warnings, "warning")),
    }
}

/// A number with its noun: `1 suite`, `2 suites`.
pub fn count(number: usize, one: &str) -> String {
    if number == 1 { format!("1 {one}") } else { format!("{number} {one}s") }
}
