//! `rtf doctor`: what is missing on this machine, and how it is installed.
//!
//! [`own`] looks at what rtf itself uses, [`fixtures`] at what the fixture
//! managers need that come with it; [`show`] prints what was found.

mod fixtures;
mod own;
mod show;

use std::process::ExitCode;

use rtf_plan::plan::RunnerEnvironment;
use serde::Serialize;

use super::Outcome;
use crate::cli::{DoctorArgs, DoctorFormat};
use crate::error::Failure;
use crate::exit;

/// What was found about one thing. `docs/doctor.md` says what the fields mean.
#[derive(Debug, Serialize)]
struct Finding {
    name: String,
    part: Part,
    /// All that it cannot do without is there.
    ok: bool,
    /// What it is for.
    about: String,
    /// What is there.
    found: Vec<String>,
    missing: Vec<Missing>,
}

/// To what it belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Part {
    /// Without it nothing can be run.
    Rtf,
    /// Some suites use it.
    Optional,
    /// A fixture manager.
    Fixture,
}

/// What is not there.
#[derive(Debug, Serialize)]
struct Missing {
    what: String,
    /// How it is installed, or made possible.
    install: String,
    /// What of the fixture needs it, if not all does.
    #[serde(rename = "for", skip_serializing_if = "Option::is_none")]
    purpose: Option<String>,
}

/// Looks, and tells. The exit code is 1 when something is missing: of what was
/// asked for, or of what each run needs.
pub fn run(args: &DoctorArgs) -> Outcome {
    let surroundings = RunnerEnvironment::from_current_process().map_err(Failure::own)?;
    let table = fixtures::Table::read(&surroundings).map_err(Failure::own)?;
    let known: Vec<&str> = own::NAMES.into_iter().chain(table.names()).collect();
    if let Some(unknown) = args.names.iter().find(|name| !known.contains(&name.as_str())) {
        let hint = format!("known are {}", known.join(", "));
        return Err(Failure::input(format!("nothing is known of `{unknown}`")).hint(hint));
    }
    let is_asked =
        |name: &str| args.names.is_empty() || args.names.iter().any(|asked| asked == name);
    let mut found = own::look(&surroundings, &is_asked);
    found.extend(table.look(&surroundings, &is_asked));
    match args.format {
        DoctorFormat::Text => show::text(&found),
        DoctorFormat::Json => show::json(&found),
    }?;
    let counts = |finding: &&Finding| !args.names.is_empty() || finding.part == Part::Rtf;
    let is_well = found.iter().filter(counts).all(|finding| finding.ok);
    Ok(ExitCode::from(if is_well { exit::PASSED } else { exit::FAILED }))
}
