//! `rtf campaign`.

mod compare;
mod comparison_text;
mod invariance;
mod plan;
mod run;
mod search;
mod show;
mod shrink;
mod trials;

use std::path::Path;
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_run::{campaign, terminal};

use super::VerbResult;
use crate::cli::CampaignVerb;

/// Runs a campaign, or prints its episodes.
pub fn run(verb: CampaignVerb, matches: &ArgMatches) -> VerbResult {
    let verb_matches = matches.subcommand().map_or(matches, |(_, matches)| matches);
    match verb {
        CampaignVerb::Run(args) => run::run(*args, verb_matches),
        CampaignVerb::Compare(args) => compare::run(&args),
        CampaignVerb::Invariance(args) => invariance::run(args, verb_matches),
        CampaignVerb::Plan(args) => plan::run(&args),
        CampaignVerb::Search(args) => search::run(args, verb_matches),
        CampaignVerb::Shrink(args) => shrink::run(args, verb_matches),
        CampaignVerb::Show(args) => show::run(&args, verb_matches),
        CampaignVerb::Episodes { file } => print_episodes(&file),
    }
}

fn print_episodes(file: &Path) -> VerbResult {
    let loaded = campaign::load(file)?;
    loaded.print_warnings()?;
    let list = loaded.episodes.to_json_lines();
    terminal::stdout(|out| out.write_all(list.as_bytes()))?;
    Ok(ExitCode::SUCCESS)
}
