//! `rtf run`.

use std::os::fd::AsFd;

use clap::ArgMatches;
use rtf_executor::Executor;
use rtf_plan::select::{Shard, ShardBy};
use rtf_run::error::Failure;
use rtf_run::pipeline::{self, Invocation};
use rtf_run::request::{OutputRequest, RunRequest};

use super::{VerbResult, list};
use crate::cli::{ListFormat, RunVerbArgs};
use crate::request::{self, cluster, config};

/// Runs tests, here or in a cluster.
pub fn run(mut args: RunVerbArgs, matches: &ArgMatches) -> VerbResult {
    if args.executor.resume {
        let (submission, request) = cluster::resumed(&args.run)?;
        return rtf_executor::supervise(&submission, &request);
    }
    config::fill_run(&mut args.run, matches)?;
    let options = cluster::cluster(&args.executor.cluster)?;
    match &args.executor.array_task {
        Some(task) => cluster::fill_task(task, &mut args.run, &options)?,
        None if options.executor != Executor::Local => {
            cluster::refuse_local_options(&args, options.executor)?;
            let shard = |count| Some(Shard { index: 1, count, by: ShardBy::Hash });
            let tests = |count| request::tests_in_shard(&args.run.input, shard(count));
            return rtf_executor::run(&options, &cluster::collect(&args.run)?, tests);
        }
        None => {}
    }
    let RunVerbArgs { run: args, debug, .. } = args;
    let debug = request::debug(&debug, &args)?;
    let lifeline = args.end_with_stdin.then(|| std::io::stdin().as_fd().try_clone_to_owned());
    let invocation = Invocation {
        output: OutputRequest { progress: debug.is_none(), ..request::output(&args) },
        targets: request::targets(&args, debug.is_some())?,
        lifeline: lifeline.transpose().map_err(Failure::internal)?,
        patience: args.shutdown_timeout,
    };
    let show: Option<fn(&_) -> _> =
        args.dry_run.then_some(|planned| list::print(planned, ListFormat::Text, false));
    let resolve = || Ok(RunRequest { debug, ..request::run(&args)? });
    pipeline::run(invocation, resolve, show)
}
