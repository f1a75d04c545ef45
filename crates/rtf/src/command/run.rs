//! `rtf run`.

use std::os::fd::AsFd;

use clap::ArgMatches;
use rtf_run::error::Failure;
use rtf_run::pipeline::{self, Invocation};
use rtf_run::request::{OutputRequest, RunRequest};

use super::{VerbResult, list};
use crate::cli::{ExecutorOption, ListFormat, RunVerbArgs};
use crate::executor;
use crate::request::{self, config};

/// Runs tests, here or in a cluster.
pub fn run(mut args: RunVerbArgs, matches: &ArgMatches) -> VerbResult {
    if args.executor.resume {
        return executor::resume(&args);
    }
    config::fill_run(&mut args.run, matches)?;
    executor::refuse_unused(&args.executor.cluster)?;
    match &args.executor.array_task {
        Some(task) => task.apply(&mut args.run, &args.executor.cluster)?,
        None if args.executor.cluster.executor != ExecutorOption::Local => {
            return executor::run(&args);
        }
        None => {}
    }
    let RunVerbArgs { run: args, debug, .. } = args;
    let debug = request::debug(&debug, &args)?;
    let lifeline = args.end_with_stdin.then(|| std::io::stdin().as_fd().try_clone_to_owned());
    let invocation = Invocation {
        output: OutputRequest { progress: debug.is_none(), ..request::output(&args) },
        finish: request::finish(&args, debug.is_some())?,
        lifeline: lifeline.transpose().map_err(Failure::internal)?,
        patience: args.shutdown_timeout,
    };
    let show: Option<fn(&_) -> _> =
        args.dry_run.then_some(|planned| list::print(planned, ListFormat::Text, false));
    let resolve = || Ok(RunRequest { debug, ..request::run(&args)? });
    pipeline::run(invocation, resolve, show)
}
