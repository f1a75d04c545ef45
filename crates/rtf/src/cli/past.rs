//! Options of the verbs that read past runs.

use std::path::PathBuf;

use clap::Args;
use rtf_report::merge::Keep;
use rtf_run::formats::ReportFormat;

use super::ResultsArgs;
use super::formats::format_parser;

/// Options of `rtf show`.
#[derive(Debug, Args)]
pub struct ShowArgs {
    /// `latest`, a run by name, directory or journal, or a results directory for its newest run
    #[arg(default_value = "latest", value_name = "RUN")]
    pub run: String,

    #[command(flatten)]
    pub results: ResultsArgs,

    /// Print every message, measurement and output
    #[arg(short, long)]
    pub verbose: bool,

    /// Print one test, and exit with its result
    ///
    /// The exit code is 0 if the test does not make the run red, 77 if it skipped itself, and
    /// 1 otherwise.
    #[arg(long, value_name = "SUITE/TEST", conflicts_with = "verbose")]
    pub single_test: Option<String>,

    /// Print suites without their tests, and exit with the result of fixtures, hooks and run
    #[arg(long, conflicts_with_all = ["verbose", "single_test"])]
    pub without_tests: bool,
}

/// Options of `rtf report`.
#[derive(Debug, Args)]
pub struct ReportArgs {
    /// `latest`, a run by name, directory or journal, or a results directory for its newest run
    #[arg(default_value = "latest", value_name = "RUN")]
    pub run: String,

    #[command(flatten)]
    pub results: ResultsArgs,

    /// Report format
    #[arg(long, value_parser = format_parser())]
    pub format: ReportFormat,

    /// Output file [default: standard output]
    #[arg(short, long, value_name = "PATH")]
    pub output: Option<PathBuf>,

    /// Address of the results, for the link in `markdown`
    #[arg(long, value_name = "URL")]
    pub link: Option<String>,
}

/// Options of `rtf merge`.
#[derive(Debug, Args)]
pub struct MergeArgs {
    /// Runs, by name, directory or journal; no test may occur in two of them
    #[arg(required = true, value_name = "RUN")]
    pub runs: Vec<String>,

    #[command(flatten)]
    pub results: ResultsArgs,

    /// Merge even if shards are missing
    #[arg(long)]
    pub partial: bool,

    /// Copy only these attachments: `all`, or `failed`, `sample:NUMBER` or both: those of attempts
    /// that did not pass, and of that many that passed
    #[arg(long, value_name = "ATTACHMENTS", default_value = "all")]
    pub keep: Keep,
}
