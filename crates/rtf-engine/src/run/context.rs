//! The resources of a run that its suites share.

use std::os::fd::BorrowedFd;
use std::path::PathBuf;
use std::sync::Arc;

use rtf_model::Source;
use rtf_process::task::{HostId, ProcessOwner, ProcessStream, TaskContext};

use crate::events::EventSink;
use crate::guard::{FixtureStop, Link};

/// The resources of a run that its suites share.
#[derive(Debug)]
pub struct RunContext {
    pub tasks: Arc<TaskContext>,
    pub sink: Arc<dyn EventSink>,
    /// A directory for files that are removed at the end of the run.
    pub scratch_dir: PathBuf,
    pub guard: Arc<Link>,
    /// How the only test is debugged.
    pub debug: Option<DebugOptions>,
    /// Why no operator can answer questions of tests, if none can.
    pub unattended: Option<String>,
}

/// How the only test of a run is debugged, see `spec/debugging.md`.
#[derive(Clone, Copy, Debug)]
pub struct DebugOptions {
    pub mode: DebugMode,
    /// Called with the id of its process when that has the terminal, or waits.
    pub notify: fn(DebugMode, i32),
}

/// How a test is connected to a debugger.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DebugMode {
    /// Its process has the terminal.
    Terminal,
    /// Its process waits before the test until a debugger is attached.
    Wait,
}

impl RunContext {
    /// Returns the owner of a process that belongs to this test, fixture or hook.
    /// `stop` is how a fixture is stopped.
    pub(super) fn process_owner(
        &self,
        source: Source,
        stop: Option<FixtureStop>,
    ) -> Arc<dyn ProcessOwner> {
        let (sink, guard) = (self.sink.clone(), self.guard.clone());
        let debug = self.debug.filter(|_| matches!(source, Source::Test(_)));
        Arc::new(SourceOwner { source, sink, guard, debug, stop })
    }
}

/// The directory for attachments of a process, relative to the run's.
pub(super) fn attachments_dir(source: Source, host: HostId) -> String {
    match source {
        Source::Test(id) => format!("attachments/{id}/{}", host.0),
        Source::Fixture(id) => format!("attachments/fixture-{id}/{}", host.0),
        Source::Hook(id) => format!("attachments/hook-{id}/{}", host.0),
    }
}

/// Notifies the guard of a process, and reports its backlog.
#[derive(Debug)]
struct SourceOwner {
    source: Source,
    sink: Arc<dyn EventSink>,
    guard: Arc<Link>,
    debug: Option<DebugOptions>,
    stop: Option<FixtureStop>,
}

impl ProcessOwner for SourceOwner {
    fn process_started(&self, pid: i32, streams: &[(ProcessStream, BorrowedFd<'_>)]) {
        self.guard.process_started(self.source, pid, streams, self.stop.as_ref());
        if let Some(debug) = self.debug.filter(|debug| debug.mode == DebugMode::Terminal) {
            (debug.notify)(debug.mode, pid);
        }
    }

    fn process_ended(&self, pid: i32) {
        self.guard.process_ended(self.source, pid);
    }

    fn debugger_awaited(&self, pid: i32) {
        if let Some(debug) = self.debug {
            (debug.notify)(debug.mode, pid);
        }
    }

    fn backlog(&self) -> usize {
        self.sink.backlog(self.source)
    }
}
