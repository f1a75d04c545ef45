//! The arguments of `rtf golden`.

use clap::{Args, Subcommand};

use super::ResultsArgs;

/// What to do with stored trajectories and pictures.
#[derive(Debug, Subcommand)]
pub enum GoldenVerb {
    /// Store the trajectories and pictures of a run as references of later runs
    Accept(GoldenAcceptArgs),
}

/// Options of `rtf golden accept`.
#[derive(Debug, Args)]
pub struct GoldenAcceptArgs {
    /// `latest`, or a run by name, directory or journal
    #[arg(value_name = "RUN")]
    pub run: String,

    /// Accept only this test, as `SUITE/TEST` or by its name; all tests without it
    #[arg(value_name = "TEST")]
    pub test: Option<String>,

    #[command(flatten)]
    pub results: ResultsArgs,

    /// Also replace references that still fit
    #[arg(long)]
    pub all: bool,

    /// Print what would be stored
    #[arg(long)]
    pub dry_run: bool,
}
