//! A run that is split over the nodes of a cluster: shards are submitted as tasks of a job, followed,
//! and their runs merged; `spec/executors.md`. Campaigns use the same jobs.
//!
//! - [`options`]: what is submitted where.
//! - [`submission`]: the directory of a submission.
//! - [`follow`]: waits for the tasks.
//! - [`stop`]: stops the tasks of a job.
//! - [`task_progress`]: prints the state of the tasks, [`progress`] also that of their tests.
//! - [`collect`]: the runs of the tasks, merged.
//! - [`array_task`]: one of the tasks.

mod array_task;
mod collect;
pub mod follow;
mod options;
mod progress;
pub mod stop;
mod submission;
pub mod task_progress;

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use rtf_cluster::{Cluster, ClusterError, Job, JobArray};
use rtf_plan::plan::Plan;
use rtf_run::error::Failure;
use rtf_run::finish::ResultTargets;
use rtf_run::request::{OutputRequest, TestsRequest};
use rtf_run::{VerbResult, plan, reports, terminal};

pub use array_task::{ArrayTask, last_attempt};
pub use options::ClusterOptions;
pub use stop::STOP_GRACE;
pub use submission::{Submission, utf8_text};

/// The file with the exit code of an attempt.
pub const EXIT_CODE: &str = "exit-code";

/// What is done with the tasks and their runs.
pub struct CollectRequest {
    /// The output and the reports at the end.
    pub output: OutputRequest,
    /// Where the merged run goes.
    pub targets: ResultTargets,
    /// A further symbolic link to the directory of the merged run.
    pub symlink: Option<PathBuf>,
    /// How long the tasks may take to end after a signal.
    pub shutdown_timeout: Duration,
}

/// Submits the tests, which are divided into shards, follows and merges them.
pub fn run(options: ClusterOptions, tests: TestsRequest, request: &CollectRequest) -> VerbResult {
    // Reports are written at the end, but unusable paths are reported now.
    let output = &request.output;
    drop(reports::open_all(&output.reports, &output.results)?);
    let (tasks, plan) = plan_all(tests)?;
    let print = options.print;
    let submission = Submission::create(&output.results, options, &plan, tasks)?;
    match print {
        true => print_job(&submission),
        false => supervise(&submission, request),
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

/// Prints the manifest of a job to standard output.
pub fn print_manifest(cluster: &Cluster, array: &JobArray<'_>) -> Result<(), Failure> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(Failure::internal)?;
    let manifest = runtime.block_on(cluster.manifest(array));
    let manifest = manifest.map_err(|error| cluster_failure(cluster, error))?;
    let no_manifest = || Failure::internal(format!("{} has no manifest", cluster.name()));
    let manifest = manifest.ok_or_else(no_manifest)?;
    terminal::stdout(|out| out.write_all(manifest.as_bytes()))
}

/// Plans all tests; returns the numbers of the shards that contain any.
fn plan_all(mut request: TestsRequest) -> Result<(Vec<u32>, Plan), Failure> {
    let shard = request.shard.take();
    let planned = plan::plan(&request)?;
    planned.print_warnings()?;
    let tasks = shard.map(|shard| plan::occupied_shards(&planned.plan, shard)).unwrap_or_default();
    Ok((tasks, (*planned.plan).clone()))
}

/// Submits unless that has happened, follows, and merges.
pub fn supervise(submission: &Submission, request: &CollectRequest) -> VerbResult {
    let lock = submission.lock()?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let stopped_by = runtime.map_err(Failure::internal)?.block_on(async {
        let job = submit(submission, &lock).await.map_err(|error| {
            submission.discard();
            cluster_failure(&submission.stored.cluster, error)
        })?;
        follow::follow(&job, submission, request.shutdown_timeout).await
    })?;
    collect::collect(submission, request, stopped_by)
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
        resources: &stored.resources,
    }
}

/// A command of the scheduler failed.
pub fn cluster_failure(cluster: &Cluster, error: ClusterError) -> Failure {
    let hint = cluster.hint(&error);
    Failure::input(error).maybe_hint(hint)
}
