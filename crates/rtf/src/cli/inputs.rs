//! Options that name and select tests.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueEnum};
use rtf_plan::select::Shard;
use rtf_plan::suite::parse_duration;

use super::HistoryFileArgs;
use super::values::{parse_seed, parse_setting};

/// The inputs, and which of their tests to run how often. Options of `rtf check`.
#[derive(Debug, Args)]
pub struct InputArgs {
    /// Suites (.xml), plug-ins, and directories of either
    ///
    /// Append `::` and the name of a test to a suite file to run only this test.
    #[arg(required_unless_present = "rerun", value_name = "FILE")]
    pub inputs: Vec<PathBuf>,

    /// Search directories recursively
    #[arg(short, long)]
    pub recursive: bool,

    /// Parameter string of the plug-ins named by FILE
    #[arg(long, value_name = "TEXT", allow_hyphen_values = true)]
    pub param: Option<String>,

    /// Environment string of the plug-ins named by FILE
    #[arg(long, value_name = "TEXT", allow_hyphen_values = true)]
    pub environment: Option<String>,

    /// Run the plug-ins named by FILE N times
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub repetition: Option<u32>,

    #[command(flatten)]
    pub profile: ProfileArgs,

    #[command(flatten)]
    pub results: ResultsArgs,

    #[command(flatten)]
    pub history: HistoryFileArgs,

    #[command(flatten)]
    pub select: SelectArgs,

    #[command(flatten)]
    pub repeat: RepeatArgs,
}

/// The profile and parameters of `rtf.toml`.
#[derive(Clone, Debug, Default, Args)]
pub struct ProfileArgs {
    /// Use this profile of `rtf.toml`: `real`, `sim`, `ci`, …
    #[arg(long, value_name = "NAME", env = "RTF_PROFILE")]
    pub profile: Option<String>,

    /// Set a parameter, which suites read as `${param:NAME}` and tests as RTF_PARAM_NAME
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse_setting)]
    pub set: Vec<(String, String)>,
}

impl ProfileArgs {
    /// The arguments for another process.
    pub fn to_options(&self) -> Vec<String> {
        let profile = self.profile.iter().map(|profile| format!("--profile={profile}"));
        let set = self.set.iter().map(|(name, value)| format!("--set={name}={value}"));
        profile.chain(set).collect()
    }

    /// Adds the arguments of another process, which those of this one precede.
    pub fn add_options(&mut self, options: &[String]) {
        for option in options {
            if let Some(profile) = option.strip_prefix("--profile=") {
                self.profile.get_or_insert_with(|| profile.to_owned());
            }
            let setting = option.strip_prefix("--set=").and_then(|it| parse_setting(it).ok());
            let is_new = |it: &(String, String)| self.set.iter().all(|(name, _)| *name != it.0);
            self.set.extend(setting.filter(is_new));
        }
    }
}

/// Where runs are stored.
#[derive(Debug, Args)]
pub struct ResultsArgs {
    /// Results directory, with one directory per run
    #[arg(long, value_name = "DIR", default_value = "rtf-results", env = "RTF_RESULTS")]
    pub results: PathBuf,
}

pub(super) const SELECTION: &str = "Test selection";

/// Which tests to run, and in which order.
#[derive(Clone, Debug, Default, Args)]
pub struct SelectArgs {
    /// Run only tests that match: `tag(slow) & !type(lua)`
    ///
    /// With several filters, a test runs if any of them matches it.
    #[arg(help_heading = SELECTION, short = 'E', long = "filter", value_name = "FILTER")]
    pub filters: Vec<String>,

    /// Run only tests that failed or were interrupted in the past run FILE, by default `latest`
    ///
    /// The files, parameters, environment string and order are those of that run.
    #[arg(help_heading = SELECTION, long, value_name = "VERDICT", value_delimiter = ',')]
    pub rerun: Vec<RerunOption>,

    /// Run tests in random order; to repeat an order, give the seed that its run printed
    #[arg(help_heading = SELECTION, long, value_name = "SEED", value_parser = parse_seed)]
    #[arg(num_args = 0..=1, require_equals = true)]
    pub shuffle: Option<Option<u64>>,

    /// Order tests by their results in the history: as in their `file`, `failed-first`, or
    /// `slowest-first`
    #[arg(help_heading = SELECTION, long, value_name = "ORDER", conflicts_with = "shuffle")]
    #[arg(hide_possible_values = true)]
    pub order: Option<OrderOption>,

    /// Run only one shard of the tests: `2/5` is the second of five
    #[arg(help_heading = SELECTION, long, value_name = "N/OF", group = "sharding")]
    pub shard: Option<Shard>,

    /// Assign tests to shards by `hash` of their names, by `count`, or by past durations:
    /// `duration=history`, `duration=RUN`, or `duration=FILE.json` from `rtf history slow`
    #[arg(help_heading = SELECTION, long, value_name = "METHOD", requires = "sharding")]
    #[arg(default_value = "hash")]
    pub shard_by: String,
}

const REPETITION: &str = "Repetition";

/// How often each test is run.
#[derive(Clone, Debug, Default, Args)]
pub struct RepeatArgs {
    /// Run each test N times as often as its suite says
    #[arg(help_heading = REPETITION, long, value_name = "N")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub repeat: Option<u32>,

    /// Repeat all tests, round after round, until the time is up: `90s`, `8h`
    #[arg(help_heading = REPETITION, long = "for", value_name = "DURATION")]
    #[arg(value_parser = parse_duration)]
    pub time: Option<Duration>,

    /// Retry a failed test up to N times; overrides its suite
    #[arg(help_heading = REPETITION, long, value_name = "N")]
    #[arg(value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    pub retries: Option<u32>,

    /// Result of a test that passes only on a retry [default: pass]
    #[arg(help_heading = REPETITION, long, value_name = "RESULT")]
    pub flaky_result: Option<FlakyResult>,

    /// Fail the run if a test or a case skips itself
    #[arg(help_heading = REPETITION, long)]
    pub no_skips: bool,

    /// Skip the remaining tests after N tests have failed
    #[arg(help_heading = REPETITION, long, value_name = "N")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..))]
    pub max_fail: Option<u32>,

    /// Skip the remaining tests after the first failure, as `--max-fail 1`
    #[arg(help_heading = REPETITION, long, conflicts_with = "max_fail")]
    pub until_fail: bool,
}

impl RepeatArgs {
    /// The number of failed tests after which the remaining tests are skipped.
    pub fn max_fail(&self) -> Option<u32> {
        if self.until_fail { Some(1) } else { self.max_fail }
    }
}

/// The order of tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum OrderOption {
    /// As in their files
    File,
    /// Tests that failed last, then the others
    FailedFirst,
    /// The slowest tests first
    SlowestFirst,
}

/// The result of a test that passes only on a retry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FlakyResult {
    /// The run can be green
    Pass,
    /// The run is not green
    Fail,
}

/// The verdicts in a past run that `--rerun` selects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RerunOption {
    /// Tests whose verdict is not green
    Failed,
    /// Tests that were interrupted, skipped, or never started
    Interrupted,
}
