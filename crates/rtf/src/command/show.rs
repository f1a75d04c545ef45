//! `rtf show`: prints a past run, even if its runner was killed.

use std::path::Path;

use clap::ArgMatches;
use rtf_report::console::{Console, ConsoleOptions};
use rtf_report::journal;

use super::VerbResult;
use crate::cli::ShowArgs;
use crate::exit;
use crate::outputs::console_options;
use crate::request::{config, past_run};

/// Prints a past run.
pub fn run(mut args: ShowArgs, matches: &ArgMatches) -> VerbResult {
    config::fill_past_results(&mut args.results, matches)?;
    let journal = past_run::find_journal(&args.results.results, &args.run)?;
    let dir = journal.parent().unwrap_or(Path::new("."));
    let options = ConsoleOptions { progress: false, ..console_options(dir, args.verbose) };
    let mut console = Console::stdout(options);
    let stored = journal::replay(&journal, &mut console).map_err(past_run::unreadable)?;
    Ok(exit::of_run(&stored.record))
}
