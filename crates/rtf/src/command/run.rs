//! `rtf run`.

use std::os::fd::AsFd;
use std::path::Path;
use std::sync::Arc;

use clap::ArgMatches;
use rtf_model::Record;
use rtf_report::background_writer::BackgroundWriter;

use super::{VerbResult, list};
use crate::cli::{ExecutorOption, ListFormat, RunVerbArgs};
use crate::control::ControlChannels;
use crate::debug::DebugRequest;
use crate::error::Failure;
use crate::guarded::{self, Supervision};
use crate::request::{self, OutputRequest, RunRequest, config, history_target};
use crate::{executor, history, operator, outputs, plan, preflight, reports, runner};

/// Runs tests.
pub fn run(args: RunVerbArgs, matches: &ArgMatches) -> VerbResult {
    if args.executor.resume {
        return executor::resume(&args);
    }
    let mut args = args;
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
    let debug = DebugRequest::resolve(&debug, &args)?;
    let output = OutputRequest { progress: debug.is_none(), ..OutputRequest::resolve(&args) };
    let lifeline = args.end_with_stdin.then(|| std::io::stdin().as_fd().try_clone_to_owned());
    let supervision = Supervision {
        lifeline: lifeline.transpose().map_err(Failure::internal)?,
        patience: args.shutdown_timeout,
        keeps_journal: true,
    };
    let run = |guard| {
        let mut request = RunRequest { debug, ..RunRequest::resolve(&args)? };
        if request.debug.as_ref().is_some_and(DebugRequest::takes_terminal) {
            request.attendance = request.attendance.without_terminal(request.web.is_some());
        }
        // A session with a debugger says nothing about the test.
        request.history = request.history.filter(|_| request.debug.is_none());
        let mut planned = plan::plan_debugged(&request.tests, request.debug.as_ref())?;
        if args.dry_run {
            return list::print(&planned, ListFormat::Text, false);
        }
        if history::is_learning(&planned.plan) {
            let url = args.input.history.history.as_deref();
            planned.learn(&history::resolve(url, &request.results)?, &request.tests);
        }
        let reports = reports::open_all(&output.reports, &output.results)?;
        let can_answer = request.attendance.console;
        let print = |dir: &_, stdout: &BackgroundWriter, control: &Arc<ControlChannels>| {
            let operator = can_answer.then(|| operator::start(control.clone(), stdout.clone()));
            let operator = operator.transpose().map_err(Failure::internal)?;
            Ok(outputs::reporters(&output, dir, stdout, operator))
        };
        let prepared = preflight::prepare(&request, reports, print)?;
        if let Some(stream) = request.tests.episode_stream.take() {
            stream.start(prepared.control.clone()).map_err(Failure::internal)?;
        }
        runner::run(&request, &planned, prepared, guard)
    };
    let complete = |journal: &Path, record: &Record| {
        outputs::complete(&output, journal, record);
        if let Ok(Some(history)) = history_target(&args) {
            history::import_run(&history, record);
        }
        for collector in request::collectors(&args).into_iter().flatten() {
            collector.push(record);
        }
    };
    guarded::run(supervision, run, complete)
}
