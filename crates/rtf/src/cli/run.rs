//! Options of `rtf run`, `rtf watch` and `rtf list`.

use std::num::NonZeroU16;
use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueEnum};
use rtf_plan::suite::parse_duration;
use rtf_process::fork_server::ForkMode;
use rtf_run::formats::{ReportFormat, ReportTarget, parse_report};

use super::inputs::SELECTION;
use super::values::{fork_mode_parser, jobs_parser};
use super::{Annotations, InputArgs, StdoutFormat, WebRunArgs};

/// Options of `rtf run` and `rtf watch`.
#[derive(Debug, Args)]
pub struct RunArgs {
    #[command(flatten)]
    pub input: InputArgs,

    /// Format of standard output
    #[arg(long, value_name = "FORMAT", default_value = "console")]
    pub format: StdoutFormat,

    /// Also write a report: `junit=PATH`, `text=`, `tap=`, `code-quality=`, `github=`,
    /// `markdown=`, `html=` or `otlp=`; `otlp=http://HOST:4318` sends a trace to a collector
    #[arg(long = "report", value_name = "FORMAT=PATH", value_parser = parse_report)]
    pub reports: Vec<(ReportFormat, ReportTarget)>,

    /// Also make PATH a symbolic link to the directory of the run
    #[arg(long, value_name = "PATH")]
    pub symlink: Option<PathBuf>,

    /// Print annotations for a code host, on standard error or in the job log
    #[arg(long, value_name = "HOST", default_value = "auto")]
    pub annotations: Annotations,

    /// Time limit for all tear-downs and hooks after a signal; then rtf kills all
    /// leftover processes
    #[arg(long, value_name = "DURATION", default_value = "60s", value_parser = parse_duration)]
    pub shutdown_timeout: Duration,

    /// End the run, as SIGTERM does, when standard input closes: for programs that start rtf
    #[arg(long)]
    pub end_with_stdin: bool,

    /// End the run like `--end-with-stdin`, and pass questions of tests to a campaign over standard
    /// input, which is a socket
    #[arg(long, hide = true, conflicts_with_all = ["end_with_stdin", "no_input"])]
    pub operator_on_stdin: bool,

    /// Answer no questions of tests: they get their default answers, or are errors
    #[arg(long)]
    pub no_input: bool,

    /// Print every message, measurement and output as it arrives
    #[arg(short, long)]
    pub verbose: bool,

    /// Run up to N suites in parallel, each with separate fixtures
    #[arg(short, long, value_name = "N", default_value = "1", value_parser = jobs_parser())]
    pub jobs: NonZeroU16,

    /// How long a suite waits for its locks [default: no limit]
    #[arg(long, value_name = "DURATION", value_parser = parse_duration)]
    pub lock_timeout: Option<Duration>,

    /// Run only episode ID of a campaign: FILE is the campaign, or the directory of its results
    #[arg(help_heading = SELECTION, long, value_name = "ID", conflicts_with = "rerun")]
    #[arg(value_parser = clap::value_parser!(u64).range(1..))]
    pub episode: Option<u64>,

    /// Run the suite FILE once for each episode of the list LIST, see `rtf campaign episodes`;
    /// `-` reads it from standard input while the episodes run
    #[arg(help_heading = SELECTION, long, value_name = "LIST")]
    #[arg(conflicts_with_all = ["episode", "rerun"])]
    pub episodes: Option<PathBuf>,

    /// Run N episodes at a time, instead of the `slots` of the test
    #[arg(help_heading = SELECTION, long, value_name = "N")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub slots: Option<u32>,

    /// Start no hosts to check the plug-ins: the campaign whose worker this is has done it here
    #[arg(long, hide = true, requires = "episodes")]
    pub checked: bool,

    /// List the selected tests without running them
    #[arg(help_heading = SELECTION, long)]
    pub dry_run: bool,

    /// Fork the hosts of C, C++, Lua and Python tests from a warm host: `auto` (from the
    /// second test on), `always`, or `never`
    #[arg(long, value_name = "WHEN", default_value = "auto", env = "RTF_FORK")]
    #[arg(value_parser = fork_mode_parser(), hide_possible_values = true)]
    pub fork: ForkMode,

    /// Do not import the run into the history
    #[arg(long)]
    pub no_history: bool,

    #[command(flatten)]
    pub web: WebRunArgs,
}

/// Options of `rtf list`.
#[derive(Debug, Args)]
pub struct ListArgs {
    #[command(flatten)]
    pub input: InputArgs,

    /// Output format
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub format: ListFormat,

    /// Also list the monitors of each test: severity, name and formula
    #[arg(long)]
    pub monitors: bool,
}

/// The format of a list of tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ListFormat {
    /// One test per line
    Text,
    /// One JSON document
    Json,
}
