//! What a cluster runs: the tests of `rtf run --executor`, and what one of its tasks runs.

use std::path::PathBuf;

use clap::{ArgMatches, FromArgMatches};
use rtf_executor::{
    ArrayTask, ClusterOptions, Executor, KubernetesOptions, Submission, refuse_unused,
};
use rtf_plan::select::{Shard, ShardBy};
use rtf_run::error::Failure;
use rtf_run::history;

use crate::cli::{
    self, Annotations, ClusterArgs, ExecutorOption, RunArgs, RunVerbArgs, StdoutFormat,
};

/// The executor, with options that have an effect.
pub fn options(args: &ClusterArgs) -> Result<ClusterOptions, Failure> {
    let kubernetes = &args.kubernetes;
    let options = ClusterOptions {
        executor: match args.executor {
            ExecutorOption::Local => Executor::Local,
            ExecutorOption::Slurm => Executor::Slurm,
            ExecutorOption::Kubernetes => Executor::Kubernetes,
        },
        shards: args.shards,
        args: args.args.clone(),
        licenses: args.licenses,
        kubernetes: KubernetesOptions {
            image: kubernetes.image.clone(),
            claim: kubernetes.claim.clone(),
            patch: kubernetes.patch.clone(),
            print: kubernetes.print,
        },
    };
    refuse_unused(&options)?;
    Ok(options)
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
pub fn fill_task(
    task: &ArrayTask,
    args: &mut RunArgs,
    options: &ClusterOptions,
) -> Result<(), Failure> {
    if task.is_cancelled() {
        return Err(Failure::input("the submission was cancelled"));
    }
    let Some(count) = options.shards.filter(|count| (1..=*count).contains(&task.number)) else {
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
pub fn fill_submission(args: &mut RunVerbArgs, options: &ClusterOptions) -> Result<(), Failure> {
    refuse_local_options(args, options.executor)?;
    let count = rtf_executor::shards(options)?;
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
        ("--end-with-stdin", run.end_with_stdin),
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
