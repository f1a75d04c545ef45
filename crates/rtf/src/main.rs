//! `rtf`, the runner of the Robot Testing Framework.
//!
//! [`cli`] is what was typed, [`command`] does it, one module a verb, and
//! [`exit`] says what the exit code means. Everything else is in the libraries.

mod cli;
mod command;
mod error;
mod exit;
mod guarded;
mod render;

use std::process::ExitCode;

use clap::Parser;
use cli::{Cli, Color, Command};

fn main() -> ExitCode {
    let cli = Cli::parse();
    match cli.color {
        Color::Auto => {}
        Color::Always => anstream::ColorChoice::Always.write_global(),
        Color::Never => anstream::ColorChoice::Never.write_global(),
    }
    let outcome = match &cli.command {
        Command::Run(args) => guarded::run(args),
        Command::Check(args) => command::check::run(args),
        Command::List(args) => command::list::run(args),
        Command::Show(args) => command::show::run(args),
        Command::Report(args) => command::report::run(args),
        Command::Completions { shell } => command::completions::run(*shell),
        Command::Man { folder } => command::man::run(folder),
    };
    outcome.unwrap_or_else(|failure| failure.show())
}
