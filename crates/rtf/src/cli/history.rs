//! Options of `rtf history`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

use super::{HistoryGateArgs, InputArgs, ResultsArgs};

/// The database of results.
#[derive(Clone, Debug, Args)]
pub struct HistoryFileArgs {
    /// History database, or its address [default: `history.db` in the results directory]
    #[arg(long, value_name = "FILE", env = "RTF_HISTORY_URL", hide_env_values = true)]
    pub history: Option<String>,
}

/// The question to the history.
#[derive(Debug, Subcommand)]
pub enum HistoryVerb {
    /// List runs, the newest first
    Runs(HistoryRunsArgs),
    /// Show verdicts, durations, measurements and signals of a test over runs
    Show(HistoryShowArgs),
    /// List tests that both passed and failed on one commit, or in one run
    Flaky(HistoryTestsArgs),
    /// List tests by duration, the slowest first
    Slow(HistoryTestsArgs),
    /// Show a measurement or signal over runs
    Trend(HistoryTrendArgs),
    /// List campaigns, the newest first
    Campaigns(HistoryCampaignsArgs),
    /// Show the pass rates of campaigns over commits
    Rates(HistoryCampaignsArgs),
    /// List changes of measurements, signals, durations and rates of campaigns
    Changes(HistoryChangesArgs),
    /// Compare two runs, branches, commits, robots, hosts or profiles
    Compare(HistoryCompareArgs),
    /// Judge whether a run is worse than the runs of the default branch
    Gate(HistoryGateArgs),
    /// Accept changes of measurements with learned limits, in the suite files
    Accept(HistoryAcceptArgs),
    /// Export results, runs, measurements, campaigns or episodes
    Export(HistoryExportArgs),
    /// Remove old runs and campaigns
    Prune(HistoryPruneArgs),
    /// Import runs and campaigns from their files
    Import(HistoryImportArgs),
    /// Check the database
    Doctor(HistoryDoctorArgs),
}

/// Options of all verbs of `rtf history`.
#[derive(Debug, Args)]
pub struct HistoryArgs {
    #[command(flatten)]
    pub results: ResultsArgs,

    #[command(flatten)]
    pub file: HistoryFileArgs,

    /// Output format
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub format: HistoryFormat,
}

/// The format of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum HistoryFormat {
    /// Text for people
    Text,
    /// One JSON document
    Json,
}

const RUN_SELECTION: &str = "Run selection";

/// Which runs a question is about.
#[derive(Clone, Debug, Default, Args)]
pub struct RunSelectArgs {
    /// Only runs of this branch
    #[arg(help_heading = RUN_SELECTION, long, value_name = "NAME")]
    pub branch: Option<String>,

    /// Only runs of this commit; the first digits are enough
    #[arg(help_heading = RUN_SELECTION, long, value_name = "HASH")]
    pub commit: Option<String>,

    /// Only runs with this profile
    #[arg(help_heading = RUN_SELECTION, long, value_name = "NAME")]
    pub profile: Option<String>,

    /// Only runs on this machine
    #[arg(help_heading = RUN_SELECTION, long, value_name = "NAME")]
    pub host: Option<String>,

    /// Only runs since a date or within a time: `2026-11-01`, `30d`
    #[arg(help_heading = RUN_SELECTION, long, value_name = "TIME")]
    pub since: Option<String>,

    /// Only the newest N of the remaining runs
    #[arg(help_heading = RUN_SELECTION, long, value_name = "N")]
    pub last: Option<usize>,
}

/// Which results a question is about.
#[derive(Clone, Debug, Default, Args)]
pub struct ResultSelectArgs {
    /// Only tests that match, as in `rtf run`: `tag(slow) & !type(lua)`
    #[arg(help_heading = super::inputs::SELECTION, short = 'E', long = "filter")]
    #[arg(value_name = "FILTER")]
    pub filters: Vec<String>,

    /// Only results of suites that require this resource, for example `robot:icub`
    #[arg(help_heading = super::inputs::SELECTION, long, value_name = "NAME")]
    pub robot: Option<String>,

    #[command(flatten)]
    pub runs: RunSelectArgs,
}

/// Options of `rtf history runs`.
#[derive(Debug, Args)]
pub struct HistoryRunsArgs {
    #[command(flatten)]
    pub history: HistoryArgs,

    #[command(flatten)]
    pub runs: RunSelectArgs,
}

/// Options of `rtf history campaigns` and `rates`.
#[derive(Debug, Args)]
pub struct HistoryCampaignsArgs {
    /// Only campaigns with this name
    #[arg(value_name = "CAMPAIGN")]
    pub name: Option<String>,

    #[command(flatten)]
    pub history: HistoryArgs,

    #[command(flatten)]
    pub runs: RunSelectArgs,
}

/// Options of `rtf history accept`.
#[derive(Debug, Args)]
pub struct HistoryAcceptArgs {
    #[command(flatten)]
    pub input: InputArgs,

    /// Only changes of this measurement. Repeatable
    #[arg(long = "measurement", value_name = "NAME")]
    pub measurements: Vec<String>,

    /// Only list the changes
    #[arg(long)]
    pub dry_run: bool,
}

/// Options of `rtf history show`.
#[derive(Debug, Args)]
pub struct HistoryShowArgs {
    /// The test, or a case of it
    #[arg(value_name = "SUITE/TEST[::CASE]")]
    pub test: String,

    #[command(flatten)]
    pub history: HistoryArgs,

    #[command(flatten)]
    pub select: ResultSelectArgs,
}

/// Options of `rtf history flaky` and `slow`.
#[derive(Debug, Args)]
pub struct HistoryTestsArgs {
    #[command(flatten)]
    pub history: HistoryArgs,

    #[command(flatten)]
    pub select: ResultSelectArgs,

    /// Also list the cases of tests
    #[arg(long)]
    pub cases: bool,

    /// List at most N tests
    #[arg(short = 'n', long, value_name = "N")]
    pub limit: Option<usize>,
}

/// Options of `rtf history trend`.
#[derive(Debug, Args)]
pub struct HistoryTrendArgs {
    /// The name of a measurement or signal
    #[arg(value_name = "MEASUREMENT")]
    pub name: String,

    #[command(flatten)]
    pub history: HistoryArgs,

    #[command(flatten)]
    pub select: ResultSelectArgs,
}

/// Options of `rtf history changes`.
#[derive(Debug, Args)]
pub struct HistoryChangesArgs {
    #[command(flatten)]
    pub history: HistoryArgs,

    #[command(flatten)]
    pub select: ResultSelectArgs,

    /// Also search the cases of tests
    #[arg(long)]
    pub cases: bool,

    /// List only changes of at least this size, in percent of the limits' span or of the
    /// mean before; of rates, the difference in percent
    #[arg(long, value_name = "PERCENT", default_value = "5")]
    pub min_size: f64,
}

/// Options of `rtf history compare`.
#[derive(Debug, Args)]
pub struct HistoryCompareArgs {
    /// `latest`, a run by name or id, or `branch:NAME`, `commit:HASH`, `robot:NAME`,
    /// `host:NAME`, `profile:NAME`
    #[arg(value_name = "A")]
    pub a: String,

    /// The same, for the other side
    #[arg(value_name = "B")]
    pub b: String,

    #[command(flatten)]
    pub history: HistoryArgs,

    #[command(flatten)]
    pub select: ResultSelectArgs,
}

/// Options of `rtf history export`.
#[derive(Debug, Args)]
pub struct HistoryExportArgs {
    /// Output format
    #[arg(long, value_name = "FORMAT")]
    pub format: ExportFormat,

    /// The rows to export
    #[arg(long, value_name = "TABLE", default_value = "results")]
    pub table: ExportTable,

    /// Output file [default: standard output]
    #[arg(short, long, value_name = "PATH")]
    pub output: Option<PathBuf>,

    #[command(flatten)]
    pub results: ResultsArgs,

    #[command(flatten)]
    pub file: HistoryFileArgs,

    #[command(flatten)]
    pub select: ResultSelectArgs,
}

/// The format of an export.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ExportFormat {
    /// Comma-separated values
    Csv,
    /// One JSON document
    Json,
    /// Apache Parquet, with typed columns
    Parquet,
}

/// The rows of an export.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ExportTable {
    /// A row per test or case and run
    Results,
    /// A row per run
    Runs,
    /// A row per measurement or signal and run
    Points,
    /// A row per campaign
    Campaigns,
    /// A row per episode that has run, and campaign
    Episodes,
}

/// Options of `rtf history prune`.
#[derive(Debug, Args)]
pub struct HistoryPruneArgs {
    /// Keep the newest N runs and campaigns, or those since a date or within a time: `500`, `90d`,
    /// `2026-11-01`
    #[arg(long, value_name = "N|TIME")]
    pub keep: String,

    /// List them without removing them
    #[arg(long)]
    pub dry_run: bool,

    #[command(flatten)]
    pub history: HistoryArgs,
}

/// Options of `rtf history import`.
#[derive(Debug, Args)]
pub struct HistoryImportArgs {
    /// Results directories, directories of runs or campaigns, or journals [default: the results directory]
    #[arg(value_name = "DIR")]
    pub dirs: Vec<PathBuf>,

    #[command(flatten)]
    pub history: HistoryArgs,
}

/// Options of `rtf history doctor`.
#[derive(Debug, Args)]
pub struct HistoryDoctorArgs {
    #[command(flatten)]
    pub history: HistoryArgs,
}
