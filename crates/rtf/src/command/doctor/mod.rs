//! `rtf doctor`: prints which dependencies are missing; [`rtf_run::doctor`] finds them.

mod print;

use std::process::ExitCode;

use rtf_run::doctor::{CheckResult, Component, check};
use rtf_run::exit;

use super::VerbResult;
use crate::cli::{DoctorArgs, DoctorFormat};

/// Checks components. The exit code is 1 if one of `names` lacks a dependency; without
/// names, if a component that every run needs does.
pub fn run(args: &DoctorArgs) -> VerbResult {
    let findings = check(&args.names)?;
    match args.format {
        DoctorFormat::Text => print::text(&findings),
        DoctorFormat::Json => print::json(&findings),
    }?;
    let counts = |finding: &&CheckResult| !args.names.is_empty() || finding.part == Component::Rtf;
    let is_ok = findings.iter().filter(counts).all(|finding| finding.ok);
    Ok(ExitCode::from(if is_ok { exit::PASSED } else { exit::FAILED }))
}
