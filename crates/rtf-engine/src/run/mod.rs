//! Runs a plan.
//!
//! [`machine`] decides, without I/O or clock; [`suite_task`] connects it with
//! the processes of [`rtf_process`] and the clock. A collapse
//! interrupts a test in `machine/suite/mod.rs`, `on_fixture_failure`.

mod clock;
mod context;
mod control;
mod deadlines;
mod events;
mod fail_limit;
mod lineup;
pub mod machine;
mod probes;
pub mod suite_task;

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

pub use context::RunContext;
pub use control::{Control, Controls};
pub use events::{Events, Sink};
use fail_limit::FailLimit;
use lineup::Lineup;
pub use machine::{Stop, StopLevel};

use crate::guard::Link;
use crate::isolate::Prepared;
use crate::locks::{self, LockOptions};
use rtf_plan::plan::{FixtureBody, FixturePlan, Plan, SuitePlan, TestPlan};
use rtf_process::cgroup::Cgroups;
use rtf_process::fork_server::ForkMode;
use rtf_process::spawner::Spawner;
use rtf_process::task::TaskContext;
use rtf_process::{prepare_process, tree};

/// What a run needs beside its plan.
#[derive(Debug)]
pub struct RunOptions {
    /// The first event. Its `run` must be unique on this machine.
    pub started: RunStarted,
    /// What the user should look at, found while the plan was made.
    pub warnings: Vec<Diagnostic>,
    /// The run's directory, for attachments.
    pub run_dir: PathBuf,
    /// The run's journal, which the guard closes when the runner dies.
    pub journal: PathBuf,
    /// The way to the guard.
    pub guard: Arc<Link>,
    /// When hosts are forked.
    pub fork_mode: ForkMode,
    /// After how many tests that did not pass the rest is skipped.
    pub max_fail: Option<u32>,
    /// For how long tests are repeated; none repeats as often as is planned.
    pub time: Option<Duration>,
    /// How many suites run at the same time at the most.
    pub jobs: NonZeroUsize,
    /// What is asked of the run while it goes on.
    pub controls: Controls,
    /// How locks are waited for.
    pub locks: LockOptions,
}

/// Runs every suite of a plan, as many at the same time as the options say.
///
/// # Errors
/// Nothing could be started: a thread, a folder or a system call is missing.
pub async fn execute(
    plan: &Plan,
    options: RunOptions,
    sink: Arc<dyn Sink>,
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
    };
    let events = Events::new(options.started.run.clone(), sink);
    options.guard.run_begins(&options.journal, scratch.clone(), events.start());
    events.emit(EventKind::RunStarted(options.started));
    for diagnostic in options.warnings {
        events.emit(EventKind::Warning { diagnostic });
    }
    for suite in &plan.suites {
        announce(suite, options.time.is_some(), &events);
    }
    let (stopped, controls) = (stops.clone(), options.controls);
    let fails = FailLimit::new(options.max_fail);
    let asked = suite_task::Asked { stops: stopped, controls, fails, until: None };
    let (context, events, locks, time) = (&context, &events, &options.locks, options.time);
    let all = AllSuites { context, events, locks, asked, time };
    tokio::select! {
        () = all.run(&plan.suites, options.jobs) => {}
        () = warn_when_guard_missed(&options.guard, events) => {}
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
    options.guard.run_ends();
    let _ = std::fs::remove_dir_all(scratch);
    Ok(())
}

/// Never ends.
async fn warn_when_guard_missed(guard: &Link, events: &Events) {
    guard.guard_missed().await;
    let text = "the guard does not read what the run tells it, and has missed some: \
        should the runner die now, it may not know which hooks have to run";
    let diagnostic = Diagnostic::warning("guard-missed", text)
        .hint("its process may have been stopped: `kill -CONT` lets it go on");
    events.emit(EventKind::Warning { diagnostic });
    std::future::pending().await
}

/// What all suites of a run have in common.
struct AllSuites<'a> {
    context: &'a RunContext,
    events: &'a Events,
    locks: &'a LockOptions,
    asked: suite_task::Asked,
    /// For how long tests are repeated.
    time: Option<Duration>,
}

impl AllSuites<'_> {
    async fn run(&self, suites: &[SuitePlan], jobs: NonZeroUsize) {
        let mut lineup = Lineup::new(suites, jobs);
        let mut running = FuturesUnordered::new();
        loop {
            while let Some(suite) = lineup.next() {
                running.push(self.one(suite, lineup.turns()));
            }
            let Some(ended) = running.next().await else { return };
            lineup.ended(ended);
        }
    }

    /// One suite from its locks until it has given everything back; it is the
    /// first of so many turns.
    async fn one<'p>(&self, suite: &'p SuitePlan, turns: u32) -> &'p SuitePlan {
        let Self { context, events, locks, asked, time } = self;
        let (mut stops, mut controls) = (asked.stops.clone(), asked.controls.clone());
        let locks = locks::wait(suite, locks, events, (&mut stops, &mut controls)).await;
        let run = events.run_token();
        let TaskContext { spawner, run_dir, .. } = &*context.tasks;
        let prepared = Prepared::get(suite, locks, run, run_dir, spawner).await;
        context.guard.suite_begins(&prepared);
        // Suites that come one after the other share the time.
        let now = events.now();
        let until = time.map(|time| now + time.saturating_sub(now) / turns);
        let asked = suite_task::Asked { until, ..asked.clone() };
        suite_task::run_suite(&prepared, context, events, asked).await;
        context.guard.suite_ends(&prepared);
        prepared.give_back(spawner).await;
        suite
    }
}

/// A folder of this process for files that live as long as a process does.
fn create_scratch_dir() -> std::io::Result<PathBuf> {
    let path = std::env::temp_dir().join(format!(
        "rtf-{}-{}",
        std::process::id(),
        uuid::Uuid::now_v7().simple()
    ));
    std::fs::create_dir(&path).map_err(|error| {
        let text =
            format!("the folder `{}` for temporary files cannot be made: {error}", path.display());
        let advice = "`TMPDIR` names the folder for them";
        std::io::Error::new(error.kind(), format!("{text}; {advice}"))
    })?;
    Ok(path)
}

fn announce(suite: &SuitePlan, timed: bool, events: &Events) {
    events.emit(EventKind::SuitePlanned(SuitePlanned {
        suite: suite.id,
        name: suite.name.clone(),
        file: suite.file.clone(),
        description: suite.description.clone(),
        environment: suite.environment.clone(),
        tolerates_collapse: suite.tolerates_collapse,
        parallel: suite.parallel,
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
    for test in &suite.tests {
        events.emit(EventKind::TestPlanned(planned(suite, test, timed)));
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
        repetitions: test.repetitions,
        timed,
        tags: test.tags.clone(),
    }
}

fn shown(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}
