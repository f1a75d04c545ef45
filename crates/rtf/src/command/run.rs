//! `rtf run`.

use std::os::fd::AsFd;

use clap::ArgMatches;

use super::{VerbResult, list};
use crate::cli::{ListFormat, RunVerbArgs};
use crate::debug::DebugRequest;
use crate::error::Failure;
use crate::guarded::{self, Supervision};
use crate::request::{OutputRequest, RunRequest, config};
use crate::{outputs, plan, preflight, reports, runner};

/// Runs tests.
pub fn run(args: RunVerbArgs, matches: &ArgMatches) -> VerbResult {
    let RunVerbArgs { run: mut args, debug } = args;
    config::fill_run(&mut args, matches)?;
    let debug = DebugRequest::resolve(&debug, &args)?;
    let output = OutputRequest { progress: debug.is_none(), ..OutputRequest::resolve(&args) };
    let lifeline = args.end_with_stdin.then(|| std::io::stdin().as_fd().try_clone_to_owned());
    let supervision = Supervision {
        lifeline: lifeline.transpose().map_err(Failure::internal)?,
        patience: args.shutdown_timeout,
        keeps_journal: true,
    };
    let run = |guard| {
        let request = RunRequest { debug, ..RunRequest::resolve(&args)? };
        let planned = plan::plan_debugged(&request.tests, request.debug.as_ref())?;
        if args.dry_run {
            return list::print(&planned, ListFormat::Text);
        }
        let reports = reports::open_all(&output.reports, &output.results)?;
        let print = |dir: &_, stdout: &_| outputs::reporters(&output, dir, stdout);
        let prepared = preflight::prepare(&request, reports, print)?;
        runner::run(&request, &planned, prepared, guard)
    };
    guarded::run(supervision, run, |journal, record| outputs::complete(&output, journal, record))
}
