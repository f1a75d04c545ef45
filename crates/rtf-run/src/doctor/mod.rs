//! Checks a machine for missing dependencies.

mod components;
mod fixtures;

use rtf_plan::plan::RunnerEnvironment;
use serde::Serialize;

use crate::error::Failure;

/// The result of a check; `docs/how-to/doctor.md` documents the fields.
#[derive(Debug, Serialize)]
pub struct CheckResult {
    pub name: String,
    pub part: Component,
    /// Whether all mandatory dependencies were found.
    pub ok: bool,
    /// The purpose of the component.
    pub about: String,
    pub found: Vec<String>,
    pub missing: Vec<Missing>,
}

/// A kind of component.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Component {
    /// Every run needs it.
    Rtf,
    /// Some suites need it.
    Optional,
    /// A fixture manager.
    Fixture,
}

/// A missing dependency.
#[derive(Debug, Serialize)]
pub struct Missing {
    pub what: String,
    /// How to install or enable it.
    pub install: String,
    /// The option that needs it, if it is not mandatory.
    #[serde(rename = "for", skip_serializing_if = "Option::is_none")]
    pub purpose: Option<String>,
}

/// Checks the components with these names; all, if there are none.
pub fn check(names: &[String]) -> Result<Vec<CheckResult>, Failure> {
    let runner = RunnerEnvironment::from_current_process().map_err(Failure::internal)?;
    let table = fixtures::NeedsTable::read(&runner).map_err(Failure::internal)?;
    let known: Vec<&str> = components::NAMES.into_iter().chain(table.names()).collect();
    if let Some(unknown) = names.iter().find(|name| !known.contains(&name.as_str())) {
        let hint = format!("known names are {}", known.join(", "));
        return Err(Failure::input(format!("unknown name `{unknown}`")).hint(hint));
    }
    let is_selected =
        |name: &str| names.is_empty() || names.iter().any(|selected| selected == name);
    let mut findings = components::check(&runner, &is_selected);
    findings.extend(table.check(&runner, &is_selected));
    Ok(findings)
}
