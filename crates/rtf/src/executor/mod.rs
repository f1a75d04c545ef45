//! `rtf run --executor slurm`: submits shards as tasks of a job array, follows them, collects
//! their runs and merges them; `spec/executors.md`. Campaigns use the same job arrays.
//!
//! - [`slurm`]: a job array whose tasks each execute a command. Knows no tests.
//! - [`submission`]: the directory of a submission.
//! - [`follow`]: waits for the tasks.
//! - [`stop`]: stops the tasks of a job.
//! - [`task_progress`]: prints the state of the tasks, [`progress`] also that of their tests.
//! - [`collect`]: the runs of the tasks, merged.
//! - [`array_task`]: `rtf run` as one of the tasks.

mod array_task;
mod collect;
pub mod follow;
mod progress;
pub mod slurm;
pub mod stop;
mod submission;
pub mod task_progress;

use std::fs::File;
use std::path::Path;

use clap::FromArgMatches;

use crate::cli::{self, ClusterArgs, RunArgs, RunVerbArgs, StdoutFormat};
use crate::command::VerbResult;
use crate::error::Failure;
use crate::plan;
use crate::reports;
use crate::request::{OutputRequest, TestsRequest, config};
use rtf_plan::plan::Plan;
use rtf_plan::select::{Shard, ShardBy};

pub use array_task::{ArrayTask, last_attempt};
use slurm::{JobArray, JobId, SlurmError};
use submission::Submission;

/// The file with the exit code of an attempt.
pub const EXIT_CODE: &str = "exit-code";

/// Submits the tests of `rtf run`, follows and merges them.
pub fn run(args: &RunVerbArgs) -> VerbResult {
    refuse_options(args)?;
    let shards = shards(&args.executor.cluster)?;
    // Reports are written at the end, but unusable paths are reported now.
    let output = OutputRequest::resolve(&args.run);
    drop(reports::open_all(&output.reports, &output.results)?);
    let (tasks, plan) = plan_all(&args.run, shards)?;
    let submission = Submission::create(
        &args.run.input.results.results,
        shards,
        &plan,
        tasks,
        slurm_options(&args.executor.cluster, &plan),
    )?;
    supervise(&submission, args)
}

/// The number of tasks.
pub fn shards(args: &ClusterArgs) -> Result<u32, Failure> {
    args.shards.ok_or_else(|| {
        Failure::input("`--executor slurm` needs the number of shards").hint("add `--shards N`")
    })
}

/// Plans all tests; returns the numbers of the shards that contain any.
fn plan_all(args: &RunArgs, shards: u32) -> Result<(Vec<u32>, Plan), Failure> {
    let shard = Shard { index: 1, count: shards, by: ShardBy::Hash };
    let mut request = TestsRequest::resolve_shard(&args.input, Some(shard))?;
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
        let job = find_or_submit(submission, &lock).await.map_err(|error| {
            submission.discard();
            slurm_failure(error)
        })?;
        follow::follow(&job, submission, args.run.shutdown_timeout).await
    })?;
    collect::collect(submission, &args.run, stopped_by)
}

/// The job of the submission: stored, known to Slurm by its name, or submitted now.
async fn find_or_submit(submission: &Submission, lock: &File) -> Result<JobId, SlurmError> {
    let stored = &submission.stored;
    let command: Vec<_> =
        [stored.program.clone(), "run".to_owned()].into_iter().chain(stored.args.clone()).collect();
    let array = JobArray {
        dir: &submission.dir,
        name: &stored.name,
        tasks: &stored.tasks,
        working_dir: Path::new(&stored.working_dir),
        options: &stored.options,
        command: &command,
    };
    match submission.is_resumed {
        true => array.find_or_submit(lock).await,
        false => array.submit(lock).await,
    }
}

/// A command of Slurm failed.
pub fn slurm_failure(error: SlurmError) -> Failure {
    let hint = error.hint();
    Failure::input(error).maybe_hint(hint)
}

/// The arguments of `sbatch`.
pub fn slurm_options(args: &ClusterArgs, plan: &Plan) -> Vec<String> {
    let mut options = args.args.clone();
    if args.licenses {
        let suites = plan.suites.iter();
        let required = suites.flat_map(|suite| &suite.settings.requires);
        let mut licenses: Vec<_> = required.map(|it| format!("{}:1", license(&it.name))).collect();
        licenses.sort();
        licenses.dedup();
        if !licenses.is_empty() {
            options.push(format!("--licenses={}", licenses.join(",")));
        }
    }
    options
}

/// The licence for a resource: Slurm gives `:` and other characters a meaning.
fn license(resource: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
    resource.chars().map(|c| if is_plain(c) { c } else { '_' }).collect()
}

/// Refuses options that have no effect on this machine.
pub fn refuse_local(args: &ClusterArgs) -> Result<(), Failure> {
    let given = [
        ("--shards", args.shards.is_some()),
        ("--executor-arg", !args.args.is_empty()),
        ("--executor-licenses", args.licenses),
    ];
    match given.iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => {
            let error = format!("`{option}` has no effect without `--executor slurm`");
            Err(Failure::input(error).hint("add `--executor slurm`"))
        }
        None => Ok(()),
    }
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
            let error = format!("`{option}` cannot be combined with `--executor slurm`");
            Err(Failure::input(error))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn licenses_have_plain_names() {
        assert_eq!(license("robot:left-arm"), "robot_left-arm");
        assert_eq!(license("a,b c"), "a_b_c");
    }
}
