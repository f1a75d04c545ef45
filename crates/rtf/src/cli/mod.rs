//! The command line: verbs and options, as the user gives them.

mod campaign;
mod debug;
mod doctor;
mod executor;
mod formats;
mod gate;
mod golden;
mod history;
mod import;
mod inputs;
mod past;
mod project;
mod run;
mod values;
mod web;

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Command, CommandFactory, Parser, Subcommand, ValueEnum};
use rtf_plan::suite::parse_duration;

pub use campaign::{
    CampaignCompareArgs, CampaignFormat, CampaignInvarianceArgs, CampaignPlanArgs, CampaignRunArgs,
    CampaignSearchArgs, CampaignShowArgs, CampaignShowFormat, CampaignShrinkArgs, CampaignVerb,
};
pub use debug::{DebugArgs, RunVerbArgs};
pub use doctor::{DoctorArgs, DoctorFormat};
pub use executor::{CampaignTaskArgs, ClusterArgs, Executor, ExecutorArgs};
pub use formats::{Annotations, StdoutFormat};
pub use gate::{GateFormat, HistoryGateArgs};
pub use golden::{GoldenAcceptArgs, GoldenVerb};
pub use history::{
    ExportFormat, ExportTable, HistoryAcceptArgs, HistoryArgs, HistoryCampaignsArgs,
    HistoryChangesArgs, HistoryCompareArgs, HistoryDoctorArgs, HistoryExportArgs, HistoryFileArgs,
    HistoryFormat, HistoryImportArgs, HistoryPruneArgs, HistoryRunsArgs, HistoryShowArgs,
    HistoryTestsArgs, HistoryTrendArgs, HistoryVerb, ResultSelectArgs, RunSelectArgs,
};
pub use import::{ImportOutput, ImportVerb};
pub use inputs::{
    FlakyResult, InputArgs, OrderOption, ProfileArgs, RepeatArgs, RerunOption, ResultsArgs,
};
pub use past::{MergeArgs, ReportArgs, ShowArgs};
pub use project::{InitArgs, Language, NewArgs, ProjectKind};
pub use run::{ListArgs, ListFormat, RunArgs};
pub use values::parse_fork_mode;
use values::unset_when_empty;
pub use web::{ServeArgs, WebAccessArgs, WebRunArgs};

/// Run tests on robots: plug-ins in any language, on fixtures that rtf monitors
/// while the tests run
#[derive(Debug, Parser)]
#[command(name = "rtf", version, propagate_version = true, max_term_width = 100)]
#[command(after_long_help = AFTER_HELP)]
pub struct Cli {
    /// When to use colours
    #[arg(long, value_name = "WHEN", default_value = "auto", global = true)]
    pub color: Color,

    #[command(subcommand)]
    pub verb: Verb,
}

/// The parser of the command line.
pub fn parser() -> Command {
    unset_when_empty(Cli::command())
}

const AFTER_HELP: &str = "\
Exit codes:
  0    everything passed
  1    a test did not pass, or a fixture collapsed or broke
  2    bad input, or no tests: nothing was started
  3    rtf itself failed, for example because it could not write a report
  4    a hook failed: the robot may not be in a safe state
  5    the runner died (SIGKILL, out of memory, a bug); its guard stopped everything
  6    a campaign needs more episodes to decide about its claim
  128+N  signal N ended the run (130 for Ctrl-C)";

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

/// The verb.
#[derive(Debug, Subcommand)]
pub enum Verb {
    /// Run suites and plug-ins
    Run(RunVerbArgs),
    /// Run a suite many times with varied parameters, and judge a claim about its pass rate
    Campaign {
        /// The verb
        #[command(subcommand)]
        verb: CampaignVerb,
    },
    /// Rerun the tests whenever a suite, a plug-in or an `rtf.toml` changes
    Watch(RunArgs),
    /// Report the problems of suites and plug-ins without running them
    Check(InputArgs),
    /// List the tests that `rtf run` would run
    List(ListArgs),
    /// Check this machine for missing dependencies
    Doctor(DoctorArgs),
    /// List the locks that are held on this machine, or wait for locks
    Locks(LocksArgs),
    /// Show a past run, even if its runner was killed
    Show(ShowArgs),
    /// Write a report of a past run
    Report(ReportArgs),
    /// Merge several runs into one, for example the shards of `--shard`
    Merge(MergeArgs),
    /// Show results of many runs: flaky and slow tests, trends, comparisons
    History {
        /// The question
        #[command(subcommand)]
        verb: Box<HistoryVerb>,
    },
    /// Store trajectories and pictures of a run, with which later runs are compared
    Golden {
        /// What to do
        #[command(subcommand)]
        verb: GoldenVerb,
    },
    /// Show active and past runs in a browser
    Serve(ServeArgs),
    /// Write a suite with the tests of a build directory or workspace
    Import {
        /// Where the tests are
        #[command(subcommand)]
        verb: ImportVerb,
    },
    /// Show the configuration from `rtf.toml`, the command line and variables
    Config {
        /// The verb
        #[command(subcommand)]
        verb: ConfigVerb,
    },
    /// Write a small project that runs at once: a suite, a test or a fixture
    New(NewArgs),
    /// Add `rtf.toml`, `.gitignore` and jobs for GitHub and GitLab to a project
    Init(InitArgs),
    /// Print the directory of the CMake packages, for `rtf_DIR`
    CmakeDir,
    /// Print the directory of `ament_cmake_rtf`, to be copied into a colcon workspace
    AmentDir,
    /// Print the directory of the Ada SDK, for `gprbuild -aP`
    AdaDir,
    /// Print shell completions
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Run a task of `rtf campaign run --executor`
    #[command(hide = true)]
    CampaignTask(CampaignTaskArgs),
    /// Write the manual pages to a directory
    #[command(hide = true)]
    Man {
        /// The directory
        dir: PathBuf,
    },
}

/// The verb of `rtf config`.
#[derive(Debug, Subcommand)]
pub enum ConfigVerb {
    /// Print the effective settings of a suite and the source of each value
    Show(ConfigArgs),
}

/// Options of `rtf config show`.
#[derive(Debug, Args)]
pub struct ConfigArgs {
    /// A suite, a plug-in or a directory
    #[arg(value_name = "FILE", default_value = ".")]
    pub input: PathBuf,

    #[command(flatten)]
    pub profile: ProfileArgs,
}

/// Options of `rtf locks`.
#[derive(Debug, Args)]
pub struct LocksArgs {
    /// Only these resources
    #[arg(value_name = "NAME")]
    pub names: Vec<String>,

    /// Wait until the resources are free
    #[arg(long, requires = "names")]
    pub wait: bool,

    /// How long to wait [default: no limit]
    #[arg(long, value_name = "DURATION", value_parser = parse_duration, requires = "wait")]
    pub timeout: Option<Duration>,
}
