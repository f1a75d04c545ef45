//! `rtf man`: the manual pages, for `make install`.

use std::path::Path;
use std::process::ExitCode;

use clap::CommandFactory;

use super::Outcome;
use crate::cli::Cli;
use crate::error::Failure;

/// Writes `rtf.1` and one page for each verb.
pub fn run(folder: &Path) -> Outcome {
    std::fs::create_dir_all(folder).map_err(Failure::own)?;
    clap_mangen::generate_to(Cli::command(), folder).map_err(Failure::own)?;
    Ok(ExitCode::SUCCESS)
}
