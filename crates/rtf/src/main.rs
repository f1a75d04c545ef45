//! `rtf`, the runner of the Robot Testing Framework.
//!
//! [`command`] describes how a verb gets from its arguments, [`cli`], to its exit code.

mod cli;
mod command;
mod request;
mod testrunner;

use std::process::ExitCode;

use clap::{ArgMatches, FromArgMatches};
use cli::{Cli, Color, ConfigVerb, Verb};
use command::VerbResult;
use rtf_engine::guard;
use rtf_process::{network, start_failure, start_gate};

fn main() -> ExitCode {
    // First of all, because these processes must have one thread only.
    match std::env::args_os().nth(1) {
        Some(first) if first == network::HOLD_ARGUMENT => {
            return if network::hold().is_ok() { ExitCode::SUCCESS } else { ExitCode::FAILURE };
        }
        Some(first) if first == start_gate::WAIT_ARGUMENT => return run_hook_command(),
        _ => {}
    }
    // By default, the signal for such a write kills the process.
    let _ = guard::survive_file_size_limit();
    if testrunner::is_called() {
        return testrunner::main();
    }
    let matches = cli::parser().get_matches();
    let cli = Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    match cli.color {
        Color::Auto => {}
        Color::Always => anstream::ColorChoice::Always.write_global(),
        Color::Never => anstream::ColorChoice::Never.write_global(),
    }
    let verb_matches = matches.subcommand().map_or(&matches, |(_, matches)| matches);
    run(cli.verb, verb_matches).unwrap_or_else(|failure| failure.print())
}

fn run(verb: Verb, matches: &ArgMatches) -> VerbResult {
    match verb {
        Verb::Run(args) => command::run::run(args, matches),
        Verb::Campaign { verb } => command::campaign::run(verb, matches),
        Verb::Watch(args) => command::watch::run(args, matches),
        Verb::Check(args) => command::check::run(args, matches),
        Verb::List(args) => command::list::run(args, matches),
        Verb::Doctor(args) => command::doctor::run(&args),
        Verb::Locks(args) => command::locks::run(&args),
        Verb::Show(args) => command::show::run(args, matches),
        Verb::Report(args) => command::report::run(args, matches),
        Verb::Merge(args) => command::merge::run(args, matches),
        Verb::History { verb } => command::history::run(*verb, matches),
        Verb::Golden { verb } => command::golden::run(verb, matches),
        Verb::Serve(args) => command::serve::run(args, matches),
        Verb::Import { verb } => command::import::run(&verb),
        Verb::Config { verb: ConfigVerb::Show(args) } => command::config::show(&args),
        Verb::New(args) => command::new::run(&args),
        Verb::Init(args) => command::init::run(&args),
        Verb::CmakeDir => command::sdk_dir::cmake(),
        Verb::AmentDir => command::sdk_dir::ament(),
        Verb::AdaDir => command::sdk_dir::ada(),
        Verb::Completions { shell } => command::completions::run(shell),
        Verb::CampaignTask(args) => {
            rtf_coordinator::task::run(&args.array_task, args.shutdown_timeout)
        }
        Verb::Man { dir } => command::man::run(&dir),
    }
}

/// Executes a hook's command once the guard permits it.
fn run_hook_command() -> ExitCode {
    let mut command = std::env::args_os().skip(2).peekable();
    let program = command.peek().map(|program| program.to_string_lossy().into_owned());
    let (code, error) = start_gate::wait(command);
    let program = program.unwrap_or_default();
    let why = start_failure::describe(&program, &error);
    anstream::eprintln!("cannot execute `{program}`: {why}");
    ExitCode::from(u8::try_from(code).unwrap_or(rtf_model::exit_code::BROKEN))
}
