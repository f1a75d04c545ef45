//! Options of the verbs about past runs.

use std::path::PathBuf;

use clap::Args;

use super::formats::format_parser;
use super::{Format, ResultsArgs};

/// Which run to show.
#[derive(Debug, Args)]
pub struct ShowArgs {
    /// The run: `latest`, its name, its folder, or its journal
    #[arg(default_value = "latest", value_name = "RUN")]
    pub run: String,

    #[command(flatten)]
    pub results: ResultsArgs,

    /// Show every message, measurement and output
    #[arg(short, long)]
    pub verbose: bool,
}

/// Which report to write.
#[derive(Debug, Args)]
pub struct ReportArgs {
    /// The run: `latest`, its name, its folder, or its journal
    #[arg(default_value = "latest", value_name = "RUN")]
    pub run: String,

    #[command(flatten)]
    pub results: ResultsArgs,

    /// The report's format
    #[arg(long, value_parser = format_parser())]
    pub format: Format,

    /// Where to write it; standard output when it is left out
    #[arg(short, long, value_name = "PATH")]
    pub output: Option<PathBuf>,
}

/// Which runs to merge.
#[derive(Debug, Args)]
pub struct MergeArgs {
    /// The runs: their names, their folders, or their journals; no test may be in two of them
    #[arg(required = true, value_name = "RUN")]
    pub runs: Vec<String>,

    #[command(flatten)]
    pub results: ResultsArgs,

    /// Merge although parts are missing of those that `--shard` made
    #[arg(long)]
    pub partial: bool,
}
