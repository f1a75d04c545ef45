//! The whole way of a run, under a guard: request → plan → preflight → run → finish.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use rtf_engine::guard::Lifeline;
use rtf_model::Record;
use rtf_report::background_writer::BackgroundWriter;

use crate::VerbResult;
use crate::control::ControlChannels;
use crate::debug::DebugRequest;
use crate::error::Failure;
use crate::finish::ResultTargets;
use crate::guarded::{self, Supervision};
use crate::plan::Planned;
use crate::request::{OutputRequest, RunRequest};
use crate::{history, operator, outputs, plan, preflight, reports, run as execution};

/// What is known before the guard forks the runner.
pub struct Invocation {
    /// The output and the reports.
    pub output: OutputRequest,
    /// Where the results go.
    pub targets: ResultTargets,
    /// The guard ends the run when this closes.
    pub lifeline: Option<Lifeline>,
    /// How long the runner may not answer before the guard kills it.
    pub patience: Duration,
}

/// Runs. `resolve` makes the request in the runner's process, so that the guard stays small.
/// With `show`, the plan is only shown.
pub fn run(
    invocation: Invocation,
    resolve: impl FnOnce() -> Result<RunRequest, Failure>,
    show: Option<fn(&Planned) -> VerbResult>,
) -> VerbResult {
    let Invocation { output, targets, lifeline, patience } = invocation;
    let supervision = Supervision { lifeline, patience, keeps_journal: true };
    let run = |guard| {
        let mut request = resolve()?;
        if request.debug.as_ref().is_some_and(DebugRequest::takes_terminal) {
            request.attendance = request.attendance.without_terminal(request.web.is_some());
        }
        let mut planned = plan::plan_debugged(&request.tests, request.debug.as_ref())?;
        if let Some(show) = show {
            return show(&planned);
        }
        if history::is_learning(&planned.plan) {
            planned.learn(&request.database, &request.tests);
        }
        let reports = reports::open_all(&output.reports, &output.results)?;
        let attendance = request.attendance.clone();
        let print = |dir: &_, stdout: &BackgroundWriter, control: &Arc<ControlChannels>| {
            let operator =
                operator::of_run(&attendance, control, stdout).map_err(Failure::internal)?;
            Ok(outputs::reporters(&output, dir, stdout, operator))
        };
        let prepared = preflight::prepare(&request, reports, print)?;
        if let Some(stream) = request.tests.episode_stream.take() {
            stream.start(prepared.control.clone()).map_err(Failure::internal)?;
        }
        execution::run(&request, &planned, prepared, guard, &targets)
    };
    let complete = |journal: &Path, record: &Record| {
        outputs::complete(&output, journal, record);
        targets.finish(record);
    };
    guarded::run(supervision, run, complete)
}
