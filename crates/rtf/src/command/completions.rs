//! `rtf completions`: prints shell completions.

use std::process::ExitCode;

use clap::CommandFactory;
use clap_complete::Shell;
use rtf_run::terminal;

use super::VerbResult;
use crate::cli::Cli;

/// Prints the completions of a shell.
pub fn run(shell: Shell) -> VerbResult {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "rtf", &mut script);
    terminal::raw_stdout(|out| out.write_all(&script))?;
    Ok(ExitCode::SUCCESS)
}
