//! `rtf merge`: merges several runs into one, and prints it.

use clap::ArgMatches;
use rtf_report::merge::MergeOptions;
use rtf_run::{exit, merge};

use super::VerbResult;
use crate::cli::MergeArgs;
use crate::request::config;

/// Merges runs and prints the merged run.
pub fn run(mut args: MergeArgs, matches: &ArgMatches) -> VerbResult {
    config::fill_past_results(&mut args.results, matches)?;
    let options = MergeOptions { partial: args.partial, keep: args.keep };
    let (_, record) = merge::merge(&args.results.results, &args.runs, options)?;
    Ok(exit::of_run(&record))
}
