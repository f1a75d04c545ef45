//! `rtf completions`: a shell's completions, on standard output.

use std::io::Write;
use std::process::ExitCode;

use clap::CommandFactory;
use clap_complete::Shell;

use super::Outcome;
use crate::cli::Cli;
use crate::error::Failure;

/// Prints the completions.
pub fn run(shell: Shell) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "rtf", &mut script);
    Failure::unless_reader_left(std::io::stdout().write_all(&script))?;
    Ok(ExitCode::SUCCESS)
}
