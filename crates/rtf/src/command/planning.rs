//! What `run`, `check` and `list` have in common: from paths to a plan, with
//! every problem shown.

use rtf_engine::plan::{self, Options, Plan, Surroundings};
use rtf_model::{Diagnostic, Severity};

use crate::cli::InputArgs;
use crate::error::Failure;
use crate::exit;
use crate::render;

/// A plan, and what the user should look at nevertheless.
pub struct Planned {
    /// What will be done.
    pub plan: Plan,
    /// Warnings; they were shown.
    pub warnings: Vec<Diagnostic>,
}

/// Plans, and shows every problem on standard error.
pub fn plan(args: &InputArgs) -> Result<Planned, Failure> {
    let surroundings = Surroundings::of_process().map_err(Failure::own)?;
    let mut options = Options::new(surroundings);
    options.recursive = args.recursive;
    options.param = args.param.clone().unwrap_or_default();
    options.environment = args.environment.clone().unwrap_or_default();
    options.repetitions = args.repetition.unwrap_or(1);
    let outcome = plan::build(&args.inputs, &options);
    // The stream takes the colours out where they are not wanted.
    let mut err = anstream::stderr().lock();
    render::write(&mut err, &outcome.diagnostics, &outcome.sources, true).map_err(Failure::own)?;
    let errors = outcome.diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
    match outcome.plan {
        Some(plan) => Ok(Planned { plan, warnings: outcome.diagnostics }),
        None => {
            let many = if errors == 1 { "1 error".to_owned() } else { format!("{errors} errors") };
            Err(Failure {
                hint: Some("nothing was started".to_owned()),
                code: exit::BAD_INPUT,
                error: many.into(),
            })
        }
    }
}
