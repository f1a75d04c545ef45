//! Runs a plan.
//!
//! [`machine`] decides, without I/O or clock; [`suite_task`] connects it with the processes
//! of [`rtf_process`] and the clock.

mod clock;
mod context;
mod control_queue;
mod deadlines;
mod fail_limit;
pub mod machine;
mod probes;
mod sources;
mod suite_queue;
mod suite_task;

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use futures_util::StreamExt;
use futures_util::stream::FuturesUnordered;
use rtf_model::{
    Diagnostic, EventKind, FixturePlanned, HookPlanned, RunStarted, SuitePlanned, TestPlanned,
};
use tokio::sync::watch;

use context::RunContext;
pub use context::{DebugMode, DebugOptions};
use fail_limit::FailLimit;
use sources::SourceHashes;
use suite_queue::SuiteQueue;
use suite_task::SuiteRequests;

pub use crate::control::{Control, Controls, QuestionReply, Stop, StopLevel};
pub use crate::events::{EventSink, Events};
use crate::guard::Link;
use crate::isolate::PreparedSuite;
use crate::locks::{self, LockOptions};
use rtf_plan::plan::{FixtureBody, FixturePlan, Plan, SuitePlan, TestPlan};
use rtf_process::cgroup::Cgroups;
use rtf_process::fork_server::ForkMode;
use rtf_process::spawner::Spawner;
use rtf_process::task::TaskContext;
use rtf_process::{prepare_process, tree};

#[derive(Debug)]
pub struct RunOptions {
    /// The first event. Its `run` must be unique on this machine.
    pub started: RunStarted,
    /// The warnings of the planner.
    pub warnings: Vec<Diagnostic>,
    /// The run's directory, for attachments.
    pub run_dir: PathBuf,
    /// The run's journal, which the guard closes if the runner dies.
    pub journal: PathBuf,
    pub guard: Arc<Link>,
    /// When hosts are forked.
    pub fork_mode: ForkMode,
    /// The number of tests that did not pass after which the rest is skipped.
    pub max_fail: Option<u32>,
    /// For how long tests are repeated; `None` repeats them as planned.
    pub soak_time: Option<Duration>,
    /// How many suites run in parallel, at most.
    pub jobs: NonZeroUsize,
    /// The requests to the running run.
    pub controls: Controls,
    pub locks: LockOptions,
    /// How the only test is debugged.
    pub debug: Option<DebugOptions>,
    /// Why no operator can answer questions of tests, if none can.
    pub unattended: Option<String>,
}

/// Runs every suite of a plan.
///
/// # Errors
/// The run cannot start: the system refuses a thread, a directory or a system call.
pub async fn execute(
    plan: &Plan,
    options: RunOptions,
    sink: Arc<dyn EventSink>,
    stops: watch::Receiver<Option<Stop>>,
) -> std::io::Result<()> {
    prepare_process()?;
    let scratch = create_scratch_dir()?;
    let context = RunContext {
        tasks: Arc::new(TaskContext {
            spawner: Spawner::start(options.fork_mode)?,
            run_dir: options.run_dir,
            cgroups: Cgroups::create(),
        }),
        sink: sink.clone(),
        scratch_dir: scratch.clone(),
        guard: options.guard.clone(),
        debug: options.debug,
        unattended: options.unattended,
    };
    let events = Events::new(options.started.run.clone(), sink);
    options.guard.run_started(&options.journal, scratch.clone(), events.start());
    events.emit(EventKind::RunStarted(options.started));
    for diagnostic in options.warnings {
        events.emit(EventKind::Warning { diagnostic });
    }
    for suite in &plan.suites {
        let is_timed = options.soak_time.is_some() || !suite.episodes.is_empty();
        emit_planned(suite, is_timed, &events);
    }
    let (stopped, controls) = (stops.clone(), options.controls);
    let fails = FailLimit::new(options.max_fail);
    let requests = SuiteRequests { stops: stopped, controls, fails, soak_until: None };
    let (context, events, locks) = (&context, &events, &options.locks);
    let scheduler =
        SuiteScheduler { context, events, locks, requests, soak_time: options.soak_time };
    tokio::select! {
        () = scheduler.run(&plan.suites, options.jobs) => {}
        () = warn_of_lost_messages(&options.guard, events) => {}
    }
    context.tasks.spawner.stop_fork_servers(None).await;
    let left = tree::sweep_all();
    if !left.is_empty() {
        let mut diagnostic = Diagnostic::warning(
            "processes-leaked",
            "processes were left at the end of the run and were killed",
        );
        for process in left {
            diagnostic = diagnostic.note(format!("{} {}", process.pid, process.command));
        }
        events.emit(EventKind::Warning { diagnostic });
    }
    let interrupted = stops.borrow().as_ref().map(|stop| stop.reason.clone());
    events.emit(EventKind::RunFinished { interrupted });
    options.guard.run_finished();
    let _ = std::fs::remove_dir_all(scratch);
    Ok(())
}

/// Warns if the guard has missed messages. Never returns.
async fn warn_of_lost_messages(guard: &Link, events: &Events) {
    guard.wait_for_lost_messages().await;
    let text = "the guard does not read the runner's messages, and has missed some: \
        if the runner dies now, the guard may not know which hooks must run";
    let diagnostic = Diagnostic::warning("guard-missed", text)
        .hint("its process may have been stopped: `kill -CONT` continues it");
    events.emit(EventKind::Warning { diagnostic });
    std::future::pending().await
}

/// Runs the suites, several in parallel.
struct SuiteScheduler<'a> {
    context: &'a RunContext,
    events: &'a Events,
    locks: &'a LockOptions,
    requests: SuiteRequests,
    soak_time: Option<Duration>,
}

impl SuiteScheduler<'_> {
    async fn run(&self, suites: &[SuitePlan], jobs: NonZeroUsize) {
        let mut queue = SuiteQueue::new(suites, jobs);
        let mut running = FuturesUnordered::new();
        loop {
            while let Some(suite) = queue.next() {
                running.push(self.run_suite(suite, queue.remaining_rounds()));
            }
            let Some(finished) = running.next().await else { return };
            queue.finished(finished);
        }
    }

    /// Runs a suite, from acquiring its locks to releasing all its resources. Suites that run one
    /// after the other share the soak time: `rounds` are left.
    async fn run_suite<'p>(&self, suite: &'p SuitePlan, rounds: u32) -> &'p SuitePlan {
        let Self { context, events, locks, requests, soak_time } = self;
        let (mut stops, mut controls) = (requests.stops.clone(), requests.controls.clone());
        let locks = locks::wait(suite, locks, events, (&mut stops, &mut controls)).await;
        let run = events.run_token();
        let TaskContext { spawner, run_dir, .. } = &*context.tasks;
        let prepared = PreparedSuite::prepare(suite, locks, run, run_dir, spawner).await;
        context.guard.suite_started(&prepared);
        let now = events.now();
        let soak_until = soak_time.map(|time| now + time.saturating_sub(now) / rounds);
        let requests = SuiteRequests { soak_until, ..requests.clone() };
        suite_task::run_suite(&prepared, context, events, requests).await;
        context.guard.suite_finished(&prepared);
        prepared.release(spawner).await;
        suite
    }
}

/// Creates a directory for files that are removed at the end of the run.
fn create_scratch_dir() -> std::io::Result<PathBuf> {
    let path = std::env::temp_dir().join(format!(
        "rtf-{}-{}",
        std::process::id(),
        uuid::Uuid::now_v7().simple()
    ));
    std::fs::create_dir(&path).map_err(|error| {
        let text = format!(
            "the directory `{}` for temporary files cannot be made: {error}",
            path.display()
        );
        let advice = "`TMPDIR` names the directory for them";
        std::io::Error::new(error.kind(), format!("{text}; {advice}"))
    })?;
    Ok(path)
}

fn emit_planned(suite: &SuitePlan, timed: bool, events: &Events) {
    events.emit(EventKind::SuitePlanned(SuitePlanned {
        suite: suite.id,
        name: suite.name.clone(),
        file: suite.file.clone(),
        description: suite.settings.description.clone(),
        environment: suite.settings.environment.clone(),
        tolerates_collapse: suite.settings.tolerates_collapse,
        parallel: suite.settings.parallel,
        skips_fail: suite.settings.skips_fail,
        requires: suite.settings.requires.iter().map(|it| it.name.clone()).collect(),
    }));
    for fixture in &suite.fixtures {
        events.emit(EventKind::FixturePlanned(FixturePlanned {
            fixture: fixture.id,
            suite: suite.id,
            name: fixture.name.clone(),
            plugin_type: type_of(fixture).to_owned(),
        }));
    }
    for hook in &suite.hooks {
        let (hook, suite, name, on) = (hook.id, suite.id, hook.name.clone(), hook.on.clone());
        events.emit(EventKind::HookPlanned(HookPlanned { hook, suite, name, on }));
    }
    let mut hashes = SourceHashes::of_suite(suite);
    for test in &suite.tests {
        let (plugin_hash, source_hash) = (hashes.of_plugin(&test.plugin), hashes.of_test(test));
        let planned = TestPlanned { plugin_hash, source_hash, ..planned(suite, test, timed) };
        events.emit(EventKind::TestPlanned(planned));
    }
}

fn type_of(fixture: &FixturePlan) -> &str {
    match &fixture.body {
        FixtureBody::Plugin(plugin) => &plugin.plugin_type,
        FixtureBody::Process(_) => "process",
        FixtureBody::Attached(_) => "attached",
    }
}

fn planned(suite: &SuitePlan, test: &TestPlan, timed: bool) -> TestPlanned {
    TestPlanned {
        test: test.id,
        suite: suite.id,
        name: test.name.clone(),
        plugin_type: test.plugin.plugin_type.to_string(),
        plugin: shown(&test.plugin.file),
        plugin_hash: None,
        source_hash: None,
        repetitions: test.settings.repetitions,
        timed,
        tags: test.tags.clone(),
        parameters: test.parameters().to_vec(),
        was: test.was.as_deref().map(str::to_owned),
        learned: test.learned.clone(),
        expected: test.expected.clone(),
    }
}

fn shown(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}
