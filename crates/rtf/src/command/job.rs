//! One run of a plan: engine, reporters and signals together.

use std::num::NonZeroU16;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use rtf_engine::guard::Link;
use rtf_engine::locks::LockOptions;
use rtf_engine::run::{EventSink, RunOptions, execute};
use rtf_engine::signal::{self, Signals};
use rtf_model::{EVENTS_VERSION, Event, Manifest, RunStarted, Source};
use rtf_process::fork_server::ForkMode;
use rtf_report::background_writer::BackgroundWriter;
use rtf_report::run_dir::RunDir;
use rtf_report::{Fanout, FanoutHandle, FanoutResult, Reporter};
use tokio::runtime::Runtime;

use super::planning::Planned;
use super::web::Asks;
use super::{Outcome, revision};
use crate::error::Failure;
use crate::exit;

/// What is run, and how.
pub struct Job<'a> {
    /// The plan.
    pub planned: &'a Planned,
    /// Where the run is kept.
    pub folder: &'a RunDir,
    /// Which hosts are forked.
    pub forks: ForkMode,
    /// What may be asked of it while it goes on.
    pub asks: &'a Asks,
    /// After how many tests that have not passed the rest is skipped.
    pub max_fail: Option<u32>,
    /// How locks are waited for.
    pub locks: LockOptions,
    /// How many suites run at the same time at the most.
    pub jobs: NonZeroU16,
    /// Where standard output is written.
    pub outlet: &'a BackgroundWriter,
}

impl Job<'_> {
    /// Runs under a guard; `reporters` tell of it, in this order.
    pub fn perform(&self, reporters: Vec<Box<dyn Reporter>>, guard: Link) -> Outcome {
        let fanout = Fanout::start(reporters).map_err(Failure::own)?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(Failure::own)?;
        let guard = Arc::new(guard);
        let ended = self.run_plan(&runtime, fanout.handle(), guard.clone());
        let finished = runtime.block_on(self.reported(fanout)).map_err(Failure::own)?;
        guard.finish();
        let killed_by = ended.map_err(Failure::own)?;
        let wrote_all = finished.errors.is_empty();
        for error in finished.errors {
            Failure::own(error).show();
        }
        Ok(match killed_by {
            Some(signal) => ExitCode::from(u8::try_from(128 + signal).unwrap_or(exit::FAILED)),
            None if wrote_all => exit::of_run(&finished.record),
            None => ExitCode::from(exit::BROKEN),
        })
    }

    /// Runs the plan; `Some` with the signal that ended `rtf` the hard way.
    fn run_plan(
        &self,
        runtime: &Runtime,
        events: FanoutHandle,
        guard: Arc<Link>,
    ) -> std::io::Result<Option<i32>> {
        let Asks { stops, controls, shutdown_timeout } = self.asks;
        let stopped = stops.subscribe();
        let options = RunOptions {
            started: self.started(),
            warnings: self.planned.warnings.clone(),
            journal: self.folder.journal().canonicalize()?,
            run_dir: self.folder.path.canonicalize()?,
            guard: guard.clone(),
            fork_mode: self.forks,
            max_fail: self.max_fail,
            controls: controls.subscribe(),
            locks: self.locks.clone(),
            jobs: self.jobs.into(),
            soak_time: self.planned.manifest.for_ms.map(Duration::from_millis),
        };
        let sink: Arc<dyn EventSink> = Arc::new(Reports(events));
        let plan = self.planned.plan.clone();
        runtime.block_on(async {
            // A task of its own is woken without a system call, other than this future.
            let run = async move { execute(&plan, options, sink, stopped).await };
            tokio::select! {
                biased;
                signal = signal::forward(stops, &guard, *shutdown_timeout) => signal.map(Some),
                done = tokio::spawn(run) => done.map_err(std::io::Error::other)?.map(|()| None),
            }
        })
    }

    /// Waits until everything is reported. The run is over, so a signal ends only the wait
    /// for whoever reads standard output.
    async fn reported(&self, fanout: Fanout) -> std::io::Result<FanoutResult> {
        let mut signals = Signals::install()?;
        let mut joined = tokio::task::spawn_blocking(|| fanout.join());
        let joined = tokio::select! {
            joined = &mut joined => joined,
            _ = signals.next() => {
                self.outlet.abandon();
                joined.await
            }
        };
        Ok(joined.unwrap_or_else(|error| std::panic::resume_unwind(error.into_panic())))
    }

    fn started(&self) -> RunStarted {
        let plan = &self.planned.plan;
        let jobs = Some(self.jobs.get().into()).filter(|jobs| *jobs > 1);
        let revision = revision::of(&self.planned.folder);
        let manifest = Manifest { jobs, revision, ..self.planned.manifest.clone() };
        RunStarted {
            version: EVENTS_VERSION,
            run: self.folder.name.clone(),
            rtf: env!("CARGO_PKG_VERSION").to_owned(),
            started_at: self.folder.started_at.clone(),
            command: std::env::args_os().map(|arg| arg.to_string_lossy().into_owned()).collect(),
            working_dir: self.planned.folder.to_string_lossy().into_owned(),
            suites: u32::try_from(plan.suites.len()).unwrap_or(u32::MAX),
            tests: plan.tests,
            manifest: Box::new(manifest),
        }
    }
}

/// The way of a run's events to the reporters.
#[derive(Debug)]
struct Reports(FanoutHandle);

impl EventSink for Reports {
    fn emit(&self, event: Event) {
        self.0.send(event);
    }

    fn backlog(&self, source: Source) -> usize {
        self.0.backlog(source)
    }
}
