//! Options that choose where tests and episodes run.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueEnum};
use rtf_executor::ArrayTask;
use rtf_plan::suite::parse_duration;

const EXECUTOR: &str = "Executor";

/// The largest number of tasks: Slurm's default `MaxArraySize` permits no larger array. Kubernetes
/// would permit more.
const MAX_SHARDS: i64 = 1000;

/// Where the tests of `rtf run` run.
#[derive(Clone, Debug, Default, Args)]
pub struct ExecutorArgs {
    #[command(flatten)]
    pub cluster: ClusterArgs,

    /// Follow and merge the submission whose directory is FILE, with its original options
    #[arg(help_heading = EXECUTOR, long, conflicts_with_all = ["rerun", "shards", "args"])]
    pub resume: bool,

    /// Run a task of a submission
    #[arg(long, hide = true, value_name = "TASK")]
    pub array_task: Option<ArrayTask>,
}

/// The executor, and its tasks.
#[derive(Clone, Debug, Default, Args)]
pub struct ClusterArgs {
    /// Where to run: on this machine (`local`), or in a cluster (`slurm`, `kubernetes`)
    #[arg(help_heading = EXECUTOR, long, value_name = "EXECUTOR", default_value = "local")]
    #[arg(hide_possible_values = true)]
    pub executor: Executor,

    /// Split the tests or episodes into N shards, which the executor runs as tasks
    #[arg(help_heading = EXECUTOR, long, value_name = "N", group = "sharding")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=MAX_SHARDS))]
    pub shards: Option<u32>,

    /// Pass an argument to `sbatch` (`--partition=sim`) or `kubectl` (`--namespace=sim`)
    #[arg(help_heading = EXECUTOR, long = "executor-arg", value_name = "ARG")]
    #[arg(allow_hyphen_values = true)]
    pub args: Vec<String>,

    /// Request a licence of Slurm or an extended resource of Kubernetes for each resource that the
    /// suites require
    #[arg(help_heading = EXECUTOR, long = "executor-licenses")]
    pub licenses: bool,

    #[command(flatten)]
    pub kubernetes: KubernetesArgs,
}

/// Options of `--executor kubernetes`.
#[derive(Clone, Debug, Default, Args)]
pub struct KubernetesArgs {
    /// Kubernetes: the container image with `rtf` and the suites
    #[arg(help_heading = EXECUTOR, long = "executor-image", value_name = "IMAGE")]
    pub image: Option<String>,

    /// Kubernetes: the PersistentVolumeClaim of the results directory
    #[arg(help_heading = EXECUTOR, long = "executor-claim", value_name = "CLAIM")]
    pub claim: Option<String>,

    /// Kubernetes: merge FILE (YAML or JSON) into the Job: resources, node selectors, variables
    #[arg(help_heading = EXECUTOR, long = "executor-patch", value_name = "FILE")]
    pub patch: Option<PathBuf>,

    /// Kubernetes: print the Job instead of submitting it
    #[arg(help_heading = EXECUTOR, long = "executor-print")]
    pub print: bool,
}

/// Options of a task with episodes of a campaign, which the executor starts.
#[derive(Clone, Debug, Args)]
pub struct CampaignTaskArgs {
    /// The task
    #[arg(long, value_name = "TASK")]
    pub array_task: ArrayTask,

    /// Time limit for all tear-downs and hooks after a signal
    #[arg(long, value_name = "DURATION", default_value = "60s", value_parser = parse_duration)]
    pub shutdown_timeout: Duration,
}

/// Where tests and episodes run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Executor {
    /// This machine
    #[default]
    Local,
    /// A Slurm cluster
    Slurm,
    /// A Kubernetes cluster
    Kubernetes,
}

/// The name, as on the command line.
impl std::fmt::Display for Executor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Local => "local",
            Self::Slurm => "slurm",
            Self::Kubernetes => "kubernetes",
        })
    }
}
