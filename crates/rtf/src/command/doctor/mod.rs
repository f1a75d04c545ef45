//! `rtf doctor`: reports missing dependencies of this machine and how to install them.
//!
//! [`components`] checks the dependencies of rtf itself, [`fixtures`] those of the
//! fixture managers that come with it; [`mod@print`] prints the findings.

mod components;
mod fixtures;
mod print;

use std::process::ExitCode;

use rtf_plan::plan::RunnerEnvironment;
use rtf_run::error::Failure;
use rtf_run::exit;
use serde::Serialize;

use super::VerbResult;
use crate::cli::{DoctorArgs, DoctorFormat};

/// The result of a check; `docs/how-to/doctor.md` documents the fields.
#[derive(Debug, Serialize)]
struct CheckResult {
    name: String,
    part: Component,
    /// Whether all mandatory dependencies were found.
    ok: bool,
    /// The purpose of the component.
    about: String,
    found: Vec<String>,
    missing: Vec<Missing>,
}

/// A kind of component.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Component {
    /// Every run needs it.
    Rtf,
    /// Some suites need it.
    Optional,
    /// A fixture manager.
    Fixture,
}

/// A missing dependency.
#[derive(Debug, Serialize)]
struct Missing {
    what: String,
    /// How to install or enable it.
    install: String,
    /// The option that needs it, if it is not mandatory.
    #[serde(rename = "for", skip_serializing_if = "Option::is_none")]
    purpose: Option<String>,
}

/// Checks components. The exit code is 1 if one of `names` lacks a dependency; without
/// names, if a component that every run needs does.
pub fn run(args: &DoctorArgs) -> VerbResult {
    let runner = RunnerEnvironment::from_current_process().map_err(Failure::internal)?;
    let table = fixtures::NeedsTable::read(&runner).map_err(Failure::internal)?;
    let known: Vec<&str> = components::NAMES.into_iter().chain(table.names()).collect();
    if let Some(unknown) = args.names.iter().find(|name| !known.contains(&name.as_str())) {
        let hint = format!("known names are {}", known.join(", "));
        return Err(Failure::input(format!("unknown name `{unknown}`")).hint(hint));
    }
    let is_selected =
        |name: &str| args.names.is_empty() || args.names.iter().any(|selected| selected == name);
    let mut findings = components::check(&runner, &is_selected);
    findings.extend(table.check(&runner, &is_selected));
    match args.format {
        DoctorFormat::Text => print::text(&findings),
        DoctorFormat::Json => print::json(&findings),
    }?;
    let counts = |finding: &&CheckResult| !args.names.is_empty() || finding.part == Component::Rtf;
    let is_ok = findings.iter().filter(counts).all(|finding| finding.ok);
    Ok(ExitCode::from(if is_ok { exit::PASSED } else { exit::FAILED }))
}
