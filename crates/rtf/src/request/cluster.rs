//! What a cluster runs: the tests of `rtf run --executor`, and what one of its tasks runs.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{ArgMatches, FromArgMatches};
use rtf_cluster::Cluster;
use rtf_cluster::kubernetes::Kubernetes;
use rtf_cluster::slurm::Slurm;
use rtf_executor::{ArrayTask, ClusterOptions, STOP_GRACE, Submission, utf8_text};
use rtf_plan::select::{Shard, ShardBy};
use rtf_run::error::Failure;
use rtf_run::history;

use crate::cli::{self, Annotations, ClusterArgs, Executor, RunArgs, RunVerbArgs, StdoutFormat};

/// The cluster, and the tasks for it. Tasks write into `results`, and end within
/// `shutdown_timeout`.
pub fn options(
    args: &ClusterArgs,
    results: &Path,
    shutdown_timeout: Duration,
) -> Result<ClusterOptions, Failure> {
    let shards = shards(args)?;
    let cluster = match args.executor {
        Executor::Local => return Err(Failure::internal("this machine is no cluster")),
        Executor::Slurm => Cluster::Slurm(slurm(args)?),
        Executor::Kubernetes => Cluster::Kubernetes(kubernetes(args, results, shutdown_timeout)?),
    };
    let (licenses, print) = (args.licenses, args.kubernetes.print);
    Ok(ClusterOptions { cluster, shards, licenses, print })
}

fn slurm(args: &ClusterArgs) -> Result<Slurm, Failure> {
    let program = std::env::current_exe().map_err(Failure::internal)?;
    Ok(Slurm { program: utf8_text(program.into())?, options: args.args.clone() })
}

fn kubernetes(
    args: &ClusterArgs,
    results: &Path,
    shutdown_timeout: Duration,
) -> Result<Kubernetes, Failure> {
    let kubernetes = args.kubernetes.clone();
    let image = kubernetes.image.ok_or_else(|| {
        Failure::input("`--executor kubernetes` needs an image with `rtf` and the suites")
            .hint("add `--executor-image IMAGE`")
    })?;
    if kubernetes.claim.is_none() && kubernetes.patch.is_none() {
        let error = "`--executor kubernetes` needs a shared volume for the results";
        let hint = "add `--executor-claim CLAIM`, or mount one with `--executor-patch FILE`";
        return Err(Failure::input(error).hint(hint));
    }
    let mount = std::path::absolute(results).map_err(Failure::internal)?;
    Ok(Kubernetes {
        image,
        claim: kubernetes.claim,
        mount: utf8_text(mount.into())?,
        grace_secs: (shutdown_timeout + STOP_GRACE).as_secs(),
        patch: kubernetes.patch.map(|path| read(&path)).transpose()?,
        options: args.args.clone(),
    })
}

fn read(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path)
        .map_err(|error| Failure::input(format!("cannot read `{}`: {error}", path.display())))
}

/// The number of tasks.
fn shards(args: &ClusterArgs) -> Result<u32, Failure> {
    args.shards.ok_or_else(|| {
        let error = format!("`--executor {}` needs the number of shards", args.executor);
        Failure::input(error).hint("add `--shards N`")
    })
}

/// Refuses options that have no effect with the executor.
pub fn refuse_unused(args: &ClusterArgs) -> Result<(), Failure> {
    const ALL: &[Executor] = &[Executor::Slurm, Executor::Kubernetes];
    const KUBERNETES: &[Executor] = &[Executor::Kubernetes];
    let kubernetes = &args.kubernetes;
    let given = [
        ("--shards", args.shards.is_some(), ALL),
        ("--executor-arg", !args.args.is_empty(), ALL),
        ("--executor-licenses", args.licenses, ALL),
        ("--executor-image", kubernetes.image.is_some(), KUBERNETES),
        ("--executor-claim", kubernetes.claim.is_some(), KUBERNETES),
        ("--executor-patch", kubernetes.patch.is_some(), KUBERNETES),
        ("--executor-print", kubernetes.print, KUBERNETES),
    ];
    let unused =
        given.iter().find(|(_, is_given, users)| *is_given && !users.contains(&args.executor));
    let Some((option, _, users)) = unused else { return Ok(()) };
    let users: Vec<_> = users.iter().map(|user| format!("`--executor {user}`")).collect();
    let users = users.join(" or ");
    let error = format!("`{option}` has no effect without {users}");
    Err(Failure::input(error).hint(format!("add {users}")))
}

/// An earlier submission, and its original arguments. Enters its working directory.
pub fn reopen(inputs: &[PathBuf]) -> Result<(Submission, RunVerbArgs, ArgMatches), Failure> {
    let [dir] = inputs else {
        let hint = "`rtf run --resume rtf-results/.submissions/NAME`";
        return Err(Failure::input("`--resume` needs one directory").hint(hint));
    };
    let submission = Submission::open(dir)?;
    std::env::set_current_dir(&submission.stored.working_dir).map_err(Failure::input)?;
    let stored =
        ["rtf", "run"].into_iter().map(str::to_owned).chain(submission.stored.args.clone());
    let mut matches = cli::parser().try_get_matches_from(stored).map_err(Failure::input)?;
    let matches = matches.remove_subcommand().map_or(matches, |(_, matches)| matches);
    let args = RunVerbArgs::from_arg_matches(&matches).map_err(Failure::input)?;
    Ok((submission, args, matches))
}

/// Replaces the options of a task that concern the results: the submitting process merges them.
pub fn fill_task(task: &ArrayTask, args: &mut RunArgs, shards: Option<u32>) -> Result<(), Failure> {
    if task.is_cancelled() {
        return Err(Failure::input("the submission was cancelled"));
    }
    let Some(count) = shards.filter(|count| (1..=*count).contains(&task.number)) else {
        return Err(Failure::input(format!("there is no task {}", task.number)));
    };
    let results = &mut args.input.results.results;
    let history = &mut args.input.history.history;
    if history.is_none() {
        let database = history::default_database(results);
        *history = Some(database.to_string_lossy().into_owned());
    }
    *results = task.attempt_dir();
    args.input.select.shard = Some(Shard { index: task.number, count, by: ShardBy::Hash });
    args.reports.clear();
    args.symlink = None;
    args.annotations = Annotations::None;
    args.no_history = true;
    Ok(())
}

/// Divides the tests into shards, unless options need the tests on this machine.
pub fn fill_submission(args: &mut RunVerbArgs) -> Result<(), Failure> {
    let cluster = &args.executor.cluster;
    refuse_local_options(args, cluster.executor)?;
    let count = shards(cluster)?;
    args.run.input.select.shard = Some(Shard { index: 1, count, by: ShardBy::Hash });
    Ok(())
}

/// Refuses options that need the tests on this machine.
fn refuse_local_options(args: &RunVerbArgs, executor: Executor) -> Result<(), Failure> {
    let RunVerbArgs { run, debug, .. } = args;
    let refused = [
        ("--rerun", !run.input.select.rerun.is_empty()),
        ("--shard", run.input.select.shard.is_some()),
        ("--dry-run", run.dry_run),
        ("--web", run.web.web.is_some()),
        ("--debug", debug.debug),
        ("--debugger", debug.debugger.is_some()),
        ("--debug-wait", debug.debug_wait),
        ("--end-with-stdin", run.end_with_stdin || run.operator_on_stdin),
        ("--format", run.format != StdoutFormat::Console),
    ];
    match refused.iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => {
            let error = format!("`{option}` cannot be combined with `--executor {executor}`");
            Err(Failure::input(error))
        }
        None => Ok(()),
    }
}
