//! What a cluster runs: the tests of `rtf run --executor`, and what one of its tasks runs.

use clap::FromArgMatches;
use rtf_executor::{
    ArrayTask, ClusterOptions, CollectRequest, Executor, KubernetesOptions, Submission,
    refuse_unused,
};
use rtf_plan::select::{Shard, ShardBy};
use rtf_run::error::Failure;
use rtf_run::history;

use super::config;
use crate::cli::{
    self, Annotations, ClusterArgs, ExecutorOption, RunArgs, RunVerbArgs, StdoutFormat,
};

/// The executor, with options that have an effect.
pub fn cluster(args: &ClusterArgs) -> Result<ClusterOptions, Failure> {
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

/// What is done with the tasks and their runs.
pub fn collect(args: &RunArgs) -> Result<CollectRequest, Failure> {
    Ok(CollectRequest {
        output: super::output(args),
        targets: super::targets(args, false)?,
        symlink: args.symlink.clone(),
        shutdown_timeout: args.shutdown_timeout,
    })
}

/// An earlier submission, with its original options.
pub fn resumed(args: &RunArgs) -> Result<(Submission, CollectRequest), Failure> {
    let [dir] = args.input.inputs.as_slice() else {
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
    let request = collect(&args.run)?;
    Ok((submission, request))
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

/// Refuses options that need the tests on this machine.
pub fn refuse_local_options(args: &RunVerbArgs, executor: Executor) -> Result<(), Failure> {
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
