//! `rtf run --executor slurm|kubernetes`: submits shards as tasks of a job, follows them, collects
//! their runs and merges them; `spec/executors.md`. Campaigns use the same jobs.
//!
//! - [`options`]: what the command line says about the executor.
//! - [`submission`]: the directory of a submission.
//! - [`follow`]: waits for the tasks.
//! - [`stop`]: stops the tasks of a job.
//! - [`task_progress`]: prints the state of the tasks, [`progress`] also that of their tests.
//! - [`collect`]: the runs of the tasks, merged.
//! - [`array_task`]: `rtf run` as one of the tasks.

mod array_task;
mod collect;
pub mod follow;
mod options;
mod progress;
pub mod stop;
mod submission;
pub mod task_progress;

use std::fs::File;
use std::path::Path;
use std::process::ExitCode;

use clap::FromArgMatches;
use rtf_plan::plan::Plan;
use rtf_plan::select::{Shard, ShardBy};
use rtf_run::error::Failure;
use rtf_run::{plan, reports, terminal};

use crate::cli::{self, RunArgs, RunVerbArgs, StdoutFormat};
use crate::command::VerbResult;
use crate::request::{self, config};

pub use array_task::{ArrayTask, last_attempt};
pub use options::{cluster, refuse_unused, shards};
use rtf_cluster::{Cluster, ClusterError, Job, JobArray};
use submission::Submission;

/// The file with the exit code of an attempt.
pub const EXIT_CODE: &str = "exit-code";

/// Submits the tests of `rtf run`, follows and merges them.
pub fn run(args: &RunVerbArgs) -> VerbResult {
    refuse_options(args)?;
    let shards = shards(&args.executor.cluster)?;
    // Reports are written at the end, but unusable paths are reported now.
    let output = request::output(&args.run);
    drop(reports::open_all(&output.reports, &output.results)?);
    let (tasks, plan) = plan_all(&args.run, shards)?;
    let results = &args.run.input.results.results;
    let limit = args.run.shutdown_timeout;
    let cluster = cluster(&args.executor.cluster, &plan, results, limit)?;
    let cluster = cluster.ok_or_else(|| Failure::internal("there is no cluster"))?;
    let submission = Submission::create(results, shards, &plan, tasks, cluster)?;
    match args.executor.cluster.kubernetes.print {
        true => print_job(&submission),
        false => supervise(&submission, args),
    }
}

/// Prints the manifest of the job, which the user submits.
fn print_job(submission: &Submission) -> VerbResult {
    let stored = &submission.stored;
    let command = command(submission);
    print_manifest(&stored.cluster, &job_array(submission, &command))?;
    let dir = submission.dir.to_string_lossy();
    terminal::notice(format!(
        "hint: submit it with `kubectl create -f`, then follow it: `rtf run --resume {}`",
        shell_words::quote(&dir)
    ));
    Ok(ExitCode::SUCCESS)
}

/// Prints the manifest of a Job of Kubernetes to standard output.
pub fn print_manifest(cluster: &Cluster, array: &JobArray<'_>) -> Result<(), Failure> {
    let Cluster::Kubernetes(kubernetes) = cluster else {
        return Err(Failure::internal("only Kubernetes has a manifest"));
    };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(Failure::internal)?;
    let manifest = runtime.block_on(kubernetes.prepare(array)).map_err(cluster_failure)?;
    terminal::stdout(|out| out.write_all(manifest.as_bytes()))
}

/// Plans all tests; returns the numbers of the shards that contain any.
fn plan_all(args: &RunArgs, shards: u32) -> Result<(Vec<u32>, Plan), Failure> {
    let shard = Shard { index: 1, count: shards, by: ShardBy::Hash };
    let mut request = request::tests_in_shard(&args.input, Some(shard))?;
    let shard = request.shard.take();
    let planned = plan::plan(&request)?;
    planned.print_warnings()?;
    let tasks = shard.map(|shard| plan::occupied_shards(&planned.plan, shard)).unwrap_or_default();
    Ok((tasks, (*planned.plan).clone()))
}

/// Follows and merges the submission in a directory, with its original options.
pub fn resume(args: &RunVerbArgs) -> VerbResult {
    let [dir] = args.run.input.inputs.as_slice() else {
        let hint = "`rtf run --resume rtf-results/.submissions/NAME`";
        return Err(Failure::input("`--resume` needs one directory").hint(hint));
    };
    let submission = Submission::open(dir)?;
    std::env::set_current_dir(&submission.stored.working_dir).map_err(Failure::input)?;
    let stored =
        ["rtf", "run"].into_iter().map(str::to_owned).chain(submission.stored.args.clone());
    let matches = cli::parser().try_get_matches_from(stored).map_err(Failure::input)?;
    let matches = matches.subcommand().map_or(&matches, |(_, matches)| matches);
    let mut args = RunVerbArgs::from_arg_matches(matches).map_err(Failure::input)?;
    config::fill_run(&mut args.run, matches)?;
    supervise(&submission, &args)
}

/// Submits unless that has happened, follows, and merges.
fn supervise(submission: &Submission, args: &RunVerbArgs) -> VerbResult {
    let lock = submission.lock()?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let stopped_by = runtime.map_err(Failure::internal)?.block_on(async {
        let job = submit(submission, &lock).await.map_err(|error| {
            submission.discard();
            cluster_failure(error)
        })?;
        follow::follow(&job, submission, args.run.shutdown_timeout).await
    })?;
    collect::collect(submission, &args.run, stopped_by)
}

/// The job of the submission, which is submitted unless an earlier process has done so.
async fn submit(submission: &Submission, lock: &File) -> Result<Job, ClusterError> {
    let command = command(submission);
    let array = job_array(submission, &command);
    submission.stored.cluster.submit(&array, submission.is_resumed, lock).await
}

/// The verb of `rtf` and its arguments.
fn command(submission: &Submission) -> Vec<String> {
    std::iter::once("run".to_owned()).chain(submission.stored.args.clone()).collect()
}

fn job_array<'a>(submission: &'a Submission, command: &'a [String]) -> JobArray<'a> {
    let stored = &submission.stored;
    JobArray {
        dir: &submission.dir,
        name: &stored.name,
        tasks: &stored.tasks,
        working_dir: Path::new(&stored.working_dir),
        command,
    }
}

/// A command of the scheduler failed.
pub fn cluster_failure(error: ClusterError) -> Failure {
    let hint = error.hint();
    Failure::input(error).maybe_hint(hint)
}

/// Refuses options that need the tests on this machine.
fn refuse_options(args: &RunVerbArgs) -> Result<(), Failure> {
    let RunVerbArgs { run, debug, .. } = args;
    let refused = [
        ("--rerun", !run.input.select.rerun.is_empty()),
        ("--shard", run.input.select.shard.is_some()),
        ("--dry-run", run.dry_run),
        ("--web", run.web.web.is_some()),
        ("--debug", debug.debug),
        ("--debugger", debug.debugger.is_some()),
        ("--debug-wait", debug.debug_wait),
        ("--end-with-stdin", run.end_with_stdin),
        ("--format", run.format != StdoutFormat::Console),
    ];
    match refused.iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => {
            let executor = args.executor.cluster.executor;
            let error = format!("`{option}` cannot be combined with `--executor {executor}`");
            Err(Failure::input(error))
        }
        None => Ok(()),
    }
}
