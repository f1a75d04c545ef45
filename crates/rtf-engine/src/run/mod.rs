//! Runs a plan.
//!
//! [`machine`] decides, without I/O or clock; [`suite_task`] connects it with
//! the processes of [`crate::host`], the probes and the clock. A collapse
//! interrupts a test in `machine/suite.rs`, `fixture_changed`.

mod events;
pub mod machine;
pub mod probe;
pub mod suite_task;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rtf_model::{
    Diagnostic, EventKind, FixturePlanned, HookPlanned, RunStarted, SuitePlanned, TestPlanned,
};
use tokio::sync::watch;

pub use events::{Events, Sink};
pub use machine::{Stop, StopLevel};

use crate::guard::Link;
use crate::host::spawner::Spawner;
use crate::host::task::Shared;
use crate::host::{prepare_process, tree};
use crate::plan::{FixtureBody, FixturePlan, Plan, SuitePlan, TestPlan};

/// What a run needs beside its plan.
#[derive(Debug)]
pub struct RunOptions {
    /// The first event. Its `run` must be unique on this machine.
    pub started: RunStarted,
    /// What the user should look at, found while the plan was made.
    pub warnings: Vec<Diagnostic>,
    /// The run's folder, for attachments.
    pub folder: PathBuf,
    /// The run's journal, which the guard closes when the runner dies.
    pub journal: PathBuf,
    /// The way to the guard.
    pub guard: Arc<Link>,
}

/// Runs every suite of a plan, one after the other.
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
    let scratch = scratch_folder()?;
    let shared = Arc::new(Shared {
        spawner: Spawner::start()?,
        sink: sink.clone(),
        run_folder: options.folder,
        scratch: scratch.clone(),
        guard: options.guard.clone(),
    });
    let events = Events::new(options.started.run.clone(), sink);
    options.guard.run_begins(&options.journal, events.start());
    events.emit(EventKind::RunStarted(options.started));
    for diagnostic in options.warnings {
        events.emit(EventKind::Warning { diagnostic });
    }
    for suite in &plan.suites {
        announce(suite, &events);
    }
    for suite in &plan.suites {
        options.guard.suite_begins(suite);
        suite_task::run_suite(suite, &shared, &events, stops.clone()).await;
        options.guard.suite_ends(suite.id);
    }
    let left = tree::sweep_all();
    if !left.is_empty() {
        let mut diagnostic = Diagnostic::warning(
            "processes-left",
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

/// A folder of this process for files that live as long as a process does.
fn scratch_folder() -> std::io::Result<PathBuf> {
    let path = std::env::temp_dir().join(format!(
        "rtf-{}-{}",
        std::process::id(),
        uuid::Uuid::now_v7().simple()
    ));
    std::fs::create_dir(&path)?;
    Ok(path)
}

fn announce(suite: &SuitePlan, events: &Events) {
    events.emit(EventKind::SuitePlanned(SuitePlanned {
        suite: suite.id,
        name: suite.name.clone(),
        file: suite.file.clone(),
        description: suite.description.clone(),
        environment: suite.environment.clone(),
        tolerates_collapse: suite.tolerates_collapse,
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
        events.emit(EventKind::TestPlanned(planned(suite, test)));
    }
}

fn type_of(fixture: &FixturePlan) -> &str {
    match &fixture.body {
        FixtureBody::Plugin(plugin) => &plugin.plugin_type,
        FixtureBody::Process(_) => "process",
    }
}

fn planned(suite: &SuitePlan, test: &TestPlan) -> TestPlanned {
    TestPlanned {
        test: test.id,
        suite: suite.id,
        name: test.name.clone(),
        plugin_type: test.plugin.plugin_type.to_string(),
        plugin: shown(&test.plugin.file),
        repetitions: test.repetitions,
        tags: test.tags.clone(),
    }
}

fn shown(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}
