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
mod settings;
mod testrunner;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches};
use cli::{Cli, Color, Command, ConfigVerb};
use rtf_engine::guard;
use rtf_process::{network, start_gate};

fn main() -> ExitCode {
    // Before anything else: these processes must have one thread only.
    match std::env::args_os().nth(1) {
        Some(first) if first == network::HOLD_ARGUMENT => {
            return if network::hold().is_ok() { ExitCode::SUCCESS } else { ExitCode::FAILURE };
        }
        Some(first) if first == start_gate::WAIT_ARGUMENT => return wait_at_gate(),
        _ => {}
    }
    // Without it, such a write would end the process without a word.
    let _ = guard::survive_file_size_limit();
    if testrunner::is_called() {
        return testrunner::main();
    }
    let matches = cli::unset_when_empty(Cli::command()).get_matches();
    let mut cli = Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    match cli.color {
        Color::Auto => {}
        Color::Always => anstream::ColorChoice::Always.write_global(),
        Color::Never => anstream::ColorChoice::Never.write_global(),
    }
    if let Err(failure) = settings::settle(&mut cli.command, &matches) {
        return failure.show();
    }
    let outcome = match &cli.command {
        Command::Run(args) => guarded::run(args),
        Command::Watch(args) => command::watch::run(args),
        Command::Check(args) => command::check::run(args),
        Command::List(args) => command::list::run(args),
        Command::Doctor(args) => command::doctor::run(args),
        Command::Locks(args) => command::locks::run(args),
        Command::Show(args) => command::show::run(args),
        Command::Report(args) => command::report::run(args),
        Command::Merge(args) => command::merge::run(args),
        Command::Serve(args) => command::serve::run(args),
        Command::Config { verb: ConfigVerb::Show(args) } => command::config::show(args),
        Command::Completions { shell } => command::completions::run(*shell),
        Command::Man { folder } => command::man::run(folder),
    };
    outcome.unwrap_or_else(|failure| failure.show())
}

/// Becomes a hook's command once it may begin.
fn wait_at_gate() -> ExitCode {
    let mut command = std::env::args_os().skip(2).peekable();
    let program = command.peek().map(|program| program.to_string_lossy().into_owned());
    let (code, error) = start_gate::wait(command);
    anstream::eprintln!("`{}` cannot be executed: {error}", program.unwrap_or_default());
    ExitCode::from(u8::try_from(code).unwrap_or(exit::BROKEN))
}
