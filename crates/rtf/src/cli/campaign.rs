//! Options of `rtf campaign`.

use std::num::NonZeroU16;
use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Subcommand};
use rtf_plan::suite::parse_duration;

use super::values::jobs_parser;
use super::{ProfileArgs, ResultsArgs};

/// The verb of `rtf campaign`.
#[derive(Debug, Subcommand)]
pub enum CampaignVerb {
    /// Run the episodes of a campaign
    Run(Box<CampaignRunArgs>),
    /// Print the list of episodes, as JSON lines
    Episodes {
        /// The campaign (.xml)
        #[arg(value_name = "FILE")]
        file: PathBuf,
    },
}

/// Options of `rtf campaign run`.
#[derive(Debug, Args)]
pub struct CampaignRunArgs {
    /// The campaign (.xml)
    #[arg(required_unless_present = "resume", value_name = "FILE")]
    pub file: Option<PathBuf>,

    /// Run episodes on N workers in parallel, each with separate fixtures
    #[arg(short, long, value_name = "N", default_value = "1", value_parser = jobs_parser())]
    pub workers: NonZeroU16,

    /// Continue an earlier campaign, whose results are in the directory DIR
    #[arg(long, value_name = "DIR", conflicts_with_all = ["file", "profile", "set"])]
    pub resume: Option<PathBuf>,

    /// Time limit for all tear-downs and hooks after a signal; then rtf kills all
    /// leftover processes
    #[arg(long, value_name = "DURATION", default_value = "60s", value_parser = parse_duration)]
    pub shutdown_timeout: Duration,

    #[command(flatten)]
    pub profile: ProfileArgs,

    #[command(flatten)]
    pub results: ResultsArgs,
}
