//! The arguments of `rtf run`, read once, from top to bottom.

use std::borrow::Cow;

use clap::ArgMatches;
use rtf_executor::{ClusterOptions, CollectRequest, Submission};
use rtf_run::error::Failure;
use rtf_run::request::TestsRequest;

use super::local_run::{self, LocalRun};
use super::{cluster, config, inputs, output};
use crate::cli::{Executor, ExecutorArgs, RunVerbArgs};

/// What `rtf run` does.
pub enum RunVerbRequest {
    /// Runs tests on this machine.
    Local(Box<LocalRun>),
    /// Submits tests to a cluster.
    Submission(Box<SubmissionRequest>),
    /// Follows and merges an earlier submission.
    Resumed(Box<Submission>, CollectRequest),
}

/// Tests for a cluster.
pub struct SubmissionRequest {
    pub options: ClusterOptions,
    /// The tests, in shards.
    pub tests: TestsRequest,
    pub collect: CollectRequest,
}

/// Resolves the arguments.
pub fn resolve(args: RunVerbArgs, matches: &ArgMatches) -> Result<RunVerbRequest, Failure> {
    let stored = args.executor.resume.then(|| cluster::reopen(&args.run.input.inputs));
    let (resumed, mut args, matches) = match stored.transpose()? {
        Some((submission, args, matches)) => (Some(submission), args, Cow::Owned(matches)),
        None => (None, args, Cow::Borrowed(matches)),
    };
    config::fill_run(&mut args.run, &matches)?;
    let ExecutorArgs { cluster: cluster_args, array_task, .. } = args.executor.clone();
    cluster::refuse_unused(&cluster_args)?;
    let is_local = cluster_args.executor == Executor::Local || array_task.is_some();
    match &array_task {
        Some(task) => cluster::fill_task(task, &mut args.run, cluster_args.shards)?,
        None if is_local => {}
        None => cluster::fill_submission(&mut args)?,
    }
    let debug = local_run::debug(&args.debug, &args.run)?;
    let output = output::output(&args.run, debug.is_some());
    let targets = output::targets(&args.run, debug.is_some())?;
    let args = args.run;
    if is_local {
        let run = LocalRun::new(args, debug, (output, targets))?;
        return Ok(RunVerbRequest::Local(Box::new(run)));
    }
    let shutdown_timeout = args.shutdown_timeout;
    let collect = CollectRequest { output, targets, symlink: args.symlink, shutdown_timeout };
    if let Some(submission) = resumed {
        return Ok(RunVerbRequest::Resumed(Box::new(submission), collect));
    }
    let results = &collect.output.results;
    let options = cluster::options(&cluster_args, results, shutdown_timeout)?;
    let tests = inputs::tests(&args.input)?;
    Ok(RunVerbRequest::Submission(Box::new(SubmissionRequest { options, tests, collect })))
}
