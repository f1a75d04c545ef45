//! Runs a plan: connects engine, reporters and signals.

use std::io;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use rtf_engine::guard::Link;
use rtf_engine::run::{EventSink, RunOptions, execute};
use rtf_engine::signal::{self, SignalListener};
use rtf_model::{EVENTS_VERSION, Event, Manifest, RunStarted, Source};
use rtf_report::background_writer::BackgroundWriter;
use rtf_report::run_dir::RunDir;
use rtf_report::{Fanout, FanoutHandle, FanoutResult};
use rtf_web::WebServer;
use tokio::runtime::Runtime;

use crate::VerbResult;
use crate::control::ControlChannels;
use crate::debug::DebugRequest;
use crate::error::Failure;
use crate::finish::ResultTargets;
use crate::plan::Planned;
use crate::preflight::Prepared;
use crate::request::RunRequest;
use crate::{exit, history, origin, terminal, web};

/// How long the results may take to be written before the reason is printed.
const LATE: Duration = Duration::from_secs(2);

/// Runs, and serves the run for as long as requested.
pub fn run(
    request: &RunRequest,
    planned: &Planned,
    prepared: Prepared,
    guard: Link,
    targets: &ResultTargets,
) -> VerbResult {
    let Prepared { dir, reporters, stdout, server, control } = prepared;
    let fanout = Fanout::start(reporters).map_err(Failure::internal)?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(Failure::internal)?;
    let mut signals = {
        let _context = runtime.enter();
        SignalListener::install().map_err(Failure::internal)?
    };
    let guard = Arc::new(guard);
    let options = run_options(request, planned, &dir, &control, &guard).map_err(Failure::internal);
    let ended = options.and_then(|options| {
        run_plan(&runtime, planned, options, &control, fanout.handle()).map_err(Failure::internal)
    });
    let finished =
        runtime.block_on(finish_reports(fanout, &stdout, &dir.path)).map_err(Failure::internal)?;
    guard.finish();
    targets.finish(&finished.record);
    let code = ended.map(|killed_by| exit_code(killed_by, finished));
    let linger = request.web.as_ref().and_then(|web| web.linger);
    if let (Some(server), Some(time)) = (&server, linger)
        && !control.is_interrupted()
    {
        runtime.block_on(web::linger(server, time, &mut signals));
    }
    // An error of the server does not concern the run.
    drop(server.map(WebServer::stop));
    code
}

fn run_options(
    request: &RunRequest,
    planned: &Planned,
    dir: &RunDir,
    control: &ControlChannels,
    guard: &Arc<Link>,
) -> io::Result<RunOptions> {
    Ok(RunOptions {
        started: run_started(request, planned, dir),
        warnings: planned.warnings.clone(),
        journal: dir.journal().canonicalize()?,
        run_dir: dir.path.canonicalize()?,
        guard: guard.clone(),
        fork_mode: request.fork_mode,
        max_fail: request.max_fail,
        controls: control.controls.subscribe(),
        locks: request.locks.clone(),
        jobs: request.jobs.into(),
        debug: request.debug.as_ref().map(DebugRequest::options),
        unattended: request.attendance.unattended.clone(),
        soak_time: request.tests.manifest.for_ms.map(Duration::from_millis),
    })
}

fn run_started(request: &RunRequest, planned: &Planned, dir: &RunDir) -> RunStarted {
    let tests = &request.tests;
    let working_dir = &tests.options.runner.current_dir;
    let manifest = Manifest {
        jobs: Some(request.jobs.get().into()).filter(|jobs| *jobs > 1),
        revision: request.revision.finish(),
        origin: Some(origin::find()),
        selected_from: planned.selected_from,
        shard_assignment: planned.shard_assignment.map(|hash| format!("{hash:016x}")),
        ..tests.manifest.clone()
    };
    RunStarted {
        version: EVENTS_VERSION,
        run: dir.name.clone(),
        rtf: env!("CARGO_PKG_VERSION").to_owned(),
        started_at: dir.started_at.clone(),
        command: std::env::args_os()
            .map(|arg| history::without_password(&arg.to_string_lossy()))
            .collect(),
        working_dir: working_dir.to_string_lossy().into_owned(),
        suites: u32::try_from(planned.plan.suites.len()).unwrap_or(u32::MAX),
        tests: planned.plan.tests,
        manifest: Box::new(manifest),
    }
}

/// Runs the plan; returns the signal that ended the runner before the run had ended.
fn run_plan(
    runtime: &Runtime,
    planned: &Planned,
    options: RunOptions,
    control: &ControlChannels,
    events: FanoutHandle,
) -> io::Result<Option<i32>> {
    let (stops, guard, plan) = (&control.stops, options.guard.clone(), planned.plan.clone());
    let stop = stops.subscribe();
    let sink: Arc<dyn EventSink> = Arc::new(FanoutSink(events));
    runtime.block_on(async {
        // Unlike this future, a spawned task is woken without a system call.
        let run = tokio::spawn(async move { execute(&plan, options, sink, stop).await });
        tokio::select! {
            biased;
            signal = signal::forward(stops, &guard, control.shutdown_timeout) => signal.map(Some),
            ended = run => ended.map_err(io::Error::other)?.map(|()| None),
        }
    })
}

/// Waits until the reporters have finished. A signal ends only the wait for the reader
/// of standard output.
async fn finish_reports(
    fanout: Fanout,
    stdout: &BackgroundWriter,
    dir: &Path,
) -> io::Result<FanoutResult> {
    let mut signals = SignalListener::install()?;
    let mut joined = tokio::task::spawn_blocking(|| fanout.join());
    let mut late = Box::pin(tokio::time::sleep(LATE));
    let mut is_late = false;
    let joined = loop {
        tokio::select! {
            joined = &mut joined => break joined,
            _ = signals.next() => stdout.abandon(),
            () = &mut late, if !is_late => {
                is_late = true;
                notify_late(stdout, dir);
            }
        }
    };
    Ok(joined.unwrap_or_else(|error| std::panic::resume_unwind(error.into_panic())))
}

/// A slow disk delays no test and no verdict, but the end of the run.
fn notify_late(stdout: &BackgroundWriter, dir: &Path) {
    if !stdout.is_waiting() {
        terminal::notice(format_args!(
            "the run ended {} s ago, but its results are not yet written: the disk with `{}` is slow",
            LATE.as_secs(),
            dir.display()
        ));
    }
}

/// Prints the reporters' errors.
fn exit_code(killed_by: Option<i32>, finished: FanoutResult) -> ExitCode {
    let has_errors = !finished.errors.is_empty();
    for error in finished.errors {
        Failure::internal(error).print();
    }
    match killed_by {
        Some(signal) => ExitCode::from(exit::of_signal(signal)),
        None if has_errors => ExitCode::from(exit::BROKEN),
        None => exit::of_run(&finished.record),
    }
}

/// Passes events to the reporters.
#[derive(Debug)]
struct FanoutSink(FanoutHandle);

impl EventSink for FanoutSink {
    fn emit(&self, event: Event) {
        self.0.send(event);
    }

    fn backlog(&self, source: Source) -> usize {
        self.0.backlog(source)
    }
}
