//! `rtf man`: writes the manual pages, for `make install`.

use std::path::Path;
use std::process::ExitCode;

use clap::CommandFactory;
use rtf_run::error::Failure;

use super::VerbResult;
use crate::cli::Cli;

/// Writes `rtf.1` and one page for each verb.
pub fn run(dir: &Path) -> VerbResult {
    std::fs::create_dir_all(dir).map_err(Failure::internal)?;
    clap_mangen::generate_to(Cli::command(), dir).map_err(Failure::internal)?;
    Ok(ExitCode::SUCCESS)
}
