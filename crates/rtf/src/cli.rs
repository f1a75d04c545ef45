//! The command line.

mod doctor;
mod formats;
mod past;
mod values;
mod web;

use std::num::NonZeroU16;
use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand, ValueEnum};
use rtf_plan::select::Shard;
use rtf_plan::suite::parse_duration;
use rtf_process::fork_server::ForkMode;

pub use doctor::{DoctorArgs, DoctorFormat};
pub use formats::{Annotations, Format, Shown, parse_report};
pub use past::{MergeArgs, ReportArgs, ShowArgs};
pub use values::{forks, unset_when_empty};
use values::{forks_parser, jobs_parser, parse_seed, parse_setting};
pub use web::{ServeArgs, WebAccessArgs, WebRunArgs};

/// Tests of robots: plug-ins in any language, on top of fixtures that are
/// watched while the tests run
#[derive(Debug, Parser)]
#[command(name = "rtf", version, propagate_version = true, max_term_width = 100)]
#[command(after_long_help = AFTER_HELP)]
pub struct Cli {
    /// When to use colours
    #[arg(long, value_name = "WHEN", default_value = "auto", global = true)]
    pub color: Color,

    #[command(subcommand)]
    pub command: Command,
}

const AFTER_HELP: &str = "\
Exit codes:
  0    everything passed
  1    a test did not pass, or a fixture collapsed or broke
  2    bad input, or no tests: nothing was started
  3    rtf could not do its own work, for example write a report
  4    a hook failed: the robot may not be in a safe state, whatever else happened
  5    the runner died (SIGKILL, out of memory, a defect): its guard stopped everything
  128+N  the run was ended by signal N (130 for Ctrl-C)";

/// When to use colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Color {
    /// On a terminal, unless `NO_COLOR` is set
    #[default]
    Auto,
    /// Always
    Always,
    /// Never
    Never,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run suites, plug-ins and folders
    Run(RunArgs),
    /// Run again whenever a suite, a plug-in or an `rtf.toml` changes
    Watch(RunArgs),
    /// Find every problem of suites and plug-ins, start nothing
    Check(CheckArgs),
    /// List the tests that `run` would run
    List(ListArgs),
    /// Tell what is missing on this machine, and how it is installed
    Doctor(DoctorArgs),
    /// Show who has the locks of this machine, or wait for some
    Locks(LocksArgs),
    /// Show a past run, or what is there of one that was killed
    Show(ShowArgs),
    /// Write a report of a past run
    Report(ReportArgs),
    /// Make one run of several, as of the parts that `--shard` made
    Merge(MergeArgs),
    /// Show runs in a browser, past ones and those that go on
    Serve(ServeArgs),
    /// Tell what `rtf.toml` and others set
    Config {
        /// What to tell
        #[command(subcommand)]
        verb: ConfigVerb,
    },
    /// Print a shell's completions
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Write the manual pages into a folder
    #[command(hide = true)]
    Man {
        /// The folder
        folder: PathBuf,
    },
}

/// What to tell of settings.
#[derive(Debug, Subcommand)]
pub enum ConfigVerb {
    /// Print what holds for a suite, and where each value comes from
    Show(ConfigArgs),
}

/// About what.
#[derive(Debug, Args)]
pub struct ConfigArgs {
    /// A suite, a plug-in or a folder
    #[arg(value_name = "FILE", default_value = ".")]
    pub input: PathBuf,

    #[command(flatten)]
    pub profile: ProfileArgs,
}

/// What to run.
#[derive(Debug, Args)]
pub struct InputArgs {
    /// Suites (.xml), plug-ins, and folders of either
    ///
    /// A suite's file may be followed by `::` and the name of one of its tests.
    #[arg(required_unless_present = "rerun", value_name = "FILE")]
    pub inputs: Vec<PathBuf>,

    /// Descend into folders
    #[arg(short, long)]
    pub recursive: bool,

    /// The parameter string of plug-ins that are given by name
    #[arg(long, value_name = "TEXT", allow_hyphen_values = true)]
    pub param: Option<String>,

    /// The environment string of plug-ins that are given by name
    #[arg(long, value_name = "TEXT", allow_hyphen_values = true)]
    pub environment: Option<String>,

    /// How often plug-ins that are given by name are run
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub repetition: Option<u32>,

    #[command(flatten)]
    pub profile: ProfileArgs,

    #[command(flatten)]
    pub select: SelectArgs,

    #[command(flatten)]
    pub repeat: RepeatArgs,
}

/// What of `rtf.toml` holds.
#[derive(Clone, Debug, Default, Args)]
pub struct ProfileArgs {
    /// The profile of `rtf.toml` that holds: `real`, `sim`, `ci`, …
    #[arg(long, value_name = "NAME", env = "RTF_PROFILE")]
    pub profile: Option<String>,

    /// Set a parameter: suites find it as `${param:NAME}`, tests in RTF_PARAM_NAME
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse_setting)]
    pub set: Vec<(String, String)>,
}

const CHOOSING: &str = "Choosing tests";

/// Which tests, and in which order.
#[derive(Clone, Debug, Default, Args)]
pub struct SelectArgs {
    /// Only tests that this holds for: `tag(slow) & !type(lua)`; several add up
    #[arg(help_heading = CHOOSING, short = 'E', long = "filter", value_name = "FILTER")]
    pub filters: Vec<String>,

    /// Only those that failed, or were interrupted, in a past run: FILE is then the run, `latest`
    /// unless it is given. They get what that run gave them
    #[arg(help_heading = CHOOSING, long, value_name = "WHICH", value_delimiter = ',')]
    pub rerun: Vec<Rerun>,

    /// In a random order; the number that decides it is shown, and repeats it
    #[arg(help_heading = CHOOSING, long, value_name = "SEED", value_parser = parse_seed)]
    #[arg(num_args = 0..=1, require_equals = true)]
    pub shuffle: Option<Option<u64>>,

    /// Only one part of the tests, of several: `2/5`
    #[arg(help_heading = CHOOSING, long, value_name = "N/OF")]
    pub shard: Option<Shard>,

    /// What decides to which part a test belongs: its `hash`, its place in the `count`, or its
    /// `duration` in the run that follows as `duration=RUN`
    #[arg(help_heading = CHOOSING, long, value_name = "WHAT", requires = "shard", default_value = "hash")]
    pub shard_by: String,
}

const REPEATING: &str = "Repeating tests";

/// How often each test is run.
#[derive(Clone, Debug, Default, Args)]
pub struct RepeatArgs {
    /// Run each test N times as often as its suite says
    #[arg(help_heading = REPEATING, long, value_name = "N")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub repeat: Option<u32>,

    /// Repeat all tests, round by round, until this time is over: `90s`, `8h`
    #[arg(help_heading = REPEATING, long = "for", value_name = "DURATION")]
    #[arg(value_parser = parse_duration)]
    pub time: Option<Duration>,

    /// Try a test that fails up to N times again, whatever its suite says
    #[arg(help_heading = REPEATING, long, value_name = "N")]
    #[arg(value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    pub retries: Option<u32>,

    /// What a test that passes only when it is tried again counts as [default: pass]
    #[arg(help_heading = REPEATING, long, value_name = "RESULT")]
    pub flaky_result: Option<FlakyResult>,

    /// Skip the rest as soon as N tests have not passed
    #[arg(help_heading = REPEATING, long, value_name = "N")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..))]
    pub max_fail: Option<u32>,

    /// Skip the rest as soon as a test has not passed
    #[arg(help_heading = REPEATING, long, conflicts_with = "max_fail")]
    pub until_fail: bool,
}

impl RepeatArgs {
    /// After how many tests that have not passed the rest is skipped.
    pub fn most_fails(&self) -> Option<u32> {
        if self.until_fail { Some(1) } else { self.max_fail }
    }
}

/// What a flaky test counts as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FlakyResult {
    /// The run can be green
    Pass,
    /// The run is not green
    Fail,
}

/// Which locks to show.
#[derive(Debug, Args)]
pub struct LocksArgs {
    /// Only these resources
    #[arg(value_name = "NAME")]
    pub names: Vec<String>,

    /// Wait until nobody has one of them
    #[arg(long, requires = "names")]
    pub wait: bool,

    /// How long to wait; for ever, unless told
    #[arg(long, value_name = "DURATION", value_parser = parse_duration, requires = "wait")]
    pub timeout: Option<Duration>,
}

/// What of a past run is run again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Rerun {
    /// Tests that failed, in whatever way
    Failed,
    /// Tests that were interrupted, skipped, or never begun
    Interrupted,
}

/// What to list.
#[derive(Debug, Args)]
pub struct ListArgs {
    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub results: ResultsArgs,

    /// The form of the list
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub format: ListFormat,
}

/// The form of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ListFormat {
    /// One test a line
    Text,
    /// One JSON document
    Json,
}

/// What to check.
#[derive(Debug, Args)]
pub struct CheckArgs {
    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub results: ResultsArgs,
}

/// How to run it.
#[derive(Debug, Args)]
pub struct RunArgs {
    #[command(flatten)]
    pub input: InputArgs,

    #[command(flatten)]
    pub results: ResultsArgs,

    /// What standard output has of the run
    #[arg(long, value_name = "FORMAT", default_value = "console")]
    pub format: Shown,

    /// Also write a report: `junit=PATH`, `text=`, `tap=`, `code-quality=` or `github=`
    #[arg(long = "report", value_name = "FORMAT=PATH", value_parser = parse_report)]
    pub reports: Vec<(Format, PathBuf)>,

    /// Tell a code host, on standard error or in the log, what went wrong
    #[arg(long, value_name = "HOST", default_value = "auto")]
    pub annotations: Annotations,

    /// How long tear-downs and hooks may take altogether, once a signal ends the
    /// run; then what is left is killed
    #[arg(long, value_name = "DURATION", default_value = "60s", value_parser = parse_duration)]
    pub shutdown_timeout: Duration,

    /// End the run, as SIGTERM does, when standard input ends: for programs that
    /// start rtf, whose death it then notices
    #[arg(long)]
    pub end_with_stdin: bool,

    /// Show every message, measurement and output as it comes
    #[arg(short, long)]
    pub verbose: bool,

    /// How many suites run at the same time, each with fixtures of its own
    #[arg(short, long, value_name = "N", default_value = "1", value_parser = jobs_parser())]
    pub jobs: NonZeroU16,

    /// How long a suite waits for the locks that it requires; for ever, unless told
    #[arg(long, value_name = "DURATION", value_parser = parse_duration)]
    pub lock_timeout: Option<Duration>,

    /// Only list the tests that would be run
    #[arg(help_heading = CHOOSING, long)]
    pub dry_run: bool,

    /// Fork the hosts of C, C++, Lua and Python tests from one that is ready: `auto` (from the
    /// second test on), `always`, or `never`
    #[arg(long, value_name = "WHEN", default_value = "auto", env = "RTF_FORK")]
    #[arg(value_parser = forks_parser(), hide_possible_values = true)]
    pub fork: ForkMode,

    #[command(flatten)]
    pub web: WebRunArgs,
}

/// Where runs are kept.
#[derive(Debug, Args)]
pub struct ResultsArgs {
    /// The folder of the runs' folders
    #[arg(long, value_name = "DIR", default_value = "rtf-results", env = "RTF_RESULTS")]
    pub results: PathBuf,
}
