//! The runner's end of the line to its guard.

use std::os::fd::BorrowedFd;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use rtf_model::{HookId, Source, SuiteId, TestId};
use rustix::net::SendFlags;
use tokio::sync::Notify;

use super::note::{Hook, HookBegins, Note};
use super::queue::Queue;
use crate::isolate::Prepared;
use rtf_plan::plan::SuitePlan;
use rtf_process::descriptor_passing::MAX_DESCRIPTORS;
use rtf_process::task::ProcessStream;

/// How often the runner shows that it is alive.
pub const BEAT: Duration = Duration::from_secs(1);

/// The way to the guard. Telling never fails and never waits: without a guard, or
/// when it is gone or does not read, the run goes on.
#[derive(Debug)]
pub struct Link {
    queue: Mutex<Option<Queue>>,
    /// Closed by the guard's death. The runner shows there that it is alive.
    pulse: Option<UnixStream>,
    forked: Instant,
    /// How many of the suites that run have hooks: without, the guard needs to
    /// know nothing of tests and fixtures.
    hooked: AtomicUsize,
    /// Tells that the guard missed something.
    missed: Notify,
}

impl Link {
    pub(super) fn new(socket: UnixStream, pulse: UnixStream, forked: Instant) -> Self {
        let pulse = pulse.set_nonblocking(true).is_ok().then_some(pulse);
        Self { pulse, forked, ..Self::with(Some(Queue::new(socket))) }
    }

    /// A runner without a guard.
    #[must_use]
    pub fn none() -> Self {
        Self::with(None)
    }

    fn with(queue: Option<Queue>) -> Self {
        let (queue, hooked) = (Mutex::new(queue), AtomicUsize::new(0));
        Self { queue, pulse: None, forked: Instant::now(), hooked, missed: Notify::new() }
    }

    /// Shows that the runner is alive, and tells what could not be told before.
    pub fn beat(&self) {
        if let Some(pulse) = &self.pulse {
            // A guard that does not read has enough of them.
            let _ = rustix::net::send(pulse, b".", SendFlags::NOSIGNAL | SendFlags::DONTWAIT);
        }
        self.with_queue(Queue::flush);
    }

    /// Waits until the guard has been told everything. It is who the user waits
    /// for: when it was stopped, the runner may wait, too.
    pub fn finish(&self) {
        self.with_queue(Queue::finish);
    }

    /// Waits until the guard has missed something, because it did not read for long.
    pub async fn guard_missed(&self) {
        self.missed.notified().await;
    }

    fn any_hooks(&self) -> bool {
        self.hooked.load(Ordering::Relaxed) > 0
    }

    /// The run begins; `start` is zero on the clock of its events. `scratch` is
    /// its folder for files that are gone when it is over.
    pub fn run_begins(&self, journal: &Path, scratch: PathBuf, start: Instant) {
        let started = start.saturating_duration_since(self.forked);
        self.tell(&Note::RunBegins { journal: journal.to_owned(), scratch, started });
    }

    /// The run is over.
    pub fn run_ends(&self) {
        self.tell(&Note::RunEnds);
    }

    /// A suite begins: from now on, the guard will run its abort hooks, in its
    /// network, while nobody else gets its numbers.
    pub fn suite_begins(&self, prepared: &Prepared<'_>) {
        let suite = &*prepared.plan;
        if let Some(held) = prepared.held_network() {
            let descriptors: Vec<_> = held.network().namespaces().descriptors().collect();
            self.suite_holds(suite.id, &descriptors, Some(held.pid));
        }
        let locks: Vec<_> = prepared.locks().collect();
        for some in locks.chunks(MAX_DESCRIPTORS) {
            self.suite_holds(suite.id, some, None);
        }
        if !suite.hooks.is_empty() {
            self.hooked.fetch_add(1, Ordering::Relaxed);
            let leases: Vec<_> = prepared.leases().collect();
            for some in leases.chunks(MAX_DESCRIPTORS) {
                self.suite_holds(suite.id, some, None);
            }
            let hooks = suite.hooks.iter().map(|hook| Hook::of(suite, hook)).collect();
            self.tell(&Note::SuiteBegins { suite: suite.id, hooks });
        }
    }

    fn suite_holds(&self, suite: SuiteId, beside: &[BorrowedFd<'_>], holder: Option<i32>) {
        let note = Note::SuiteHolds { suite, descriptors: beside.len(), holder };
        self.tell_with(&note, beside);
    }

    /// A suite is over.
    pub fn suite_ends(&self, prepared: &Prepared<'_>) {
        let holds = prepared.held_network().is_some() || prepared.locks().next().is_some();
        let has_hooks = !prepared.plan.hooks.is_empty();
        if has_hooks || holds {
            self.tell(&Note::SuiteEnds { suite: prepared.plan.id });
        }
        if has_hooks {
            self.hooked.fetch_sub(1, Ordering::Relaxed);
        }
    }

    /// A test of a suite begins.
    pub fn test_begins(&self, suite: &SuitePlan, test: TestId, name: &str) {
        if !suite.hooks.is_empty() {
            self.tell(&Note::TestBegins { suite: suite.id, test, name: name.to_owned() });
        }
    }

    /// A test of a suite is over.
    pub fn test_ends(&self, suite: &SuitePlan, test: TestId) {
        if !suite.hooks.is_empty() {
            self.tell(&Note::TestEnds { suite: suite.id, test });
        }
    }

    /// A hook is about to be started; to be told before its process is.
    pub fn hook_begins(&self, hook: HookBegins) {
        self.tell(&Note::HookBegins(hook));
    }

    /// A process was started. The streams of a hook's or fixture's process are
    /// kept by the guard, too, so that it can go on without the runner.
    pub fn process_started(
        &self,
        source: Source,
        pid: i32,
        streams: &[(ProcessStream, BorrowedFd<'_>)],
    ) {
        let (names, descriptors): (Vec<_>, Vec<_>) = streams.iter().copied().unzip();
        let note = match source {
            Source::Test(_) => return,
            _ if !self.any_hooks() => return,
            Source::Hook(hook) => Note::HookStarted { hook, pid, streams: names },
            Source::Fixture(_) => Note::FixtureStarted { pid, streams: names },
        };
        self.tell_with(&note, &descriptors);
    }

    /// A hook is over; to be told before anybody else is.
    pub fn hook_ends(&self, hook: HookId, problem: Option<String>) {
        self.tell(&Note::HookEnds { hook, problem });
    }

    /// A process has ended. The guard needs to know as long as there are hooks.
    pub fn process_ended(&self, source: Source, pid: i32) {
        if matches!(source, Source::Fixture(_)) && self.any_hooks() {
            self.tell(&Note::FixtureEnds { pid });
        }
    }

    /// Waits for the guard's death; for ever when there is no guard.
    pub async fn guard_died(&self) {
        let pulse = self.pulse.as_ref().and_then(|pulse| pulse.try_clone().ok());
        match pulse.and_then(|pulse| tokio::net::UnixStream::from_std(pulse).ok()) {
            // The guard never writes there: what can be read is its end.
            Some(pulse) => drop(pulse.readable().await),
            None => std::future::pending().await,
        }
    }

    fn tell(&self, note: &Note) {
        self.tell_with(note, &[]);
    }

    fn tell_with(&self, note: &Note, descriptors: &[BorrowedFd<'_>]) {
        self.with_queue(|queue| {
            let before = queue.missed;
            let told = queue.tell(note, descriptors);
            if queue.missed && !before {
                self.missed.notify_one();
            }
            told
        });
    }

    fn with_queue(&self, act: impl FnOnce(&mut Queue) -> std::io::Result<()>) {
        let mut slot = self.queue.lock().unwrap_or_else(PoisonError::into_inner);
        if slot.as_mut().is_some_and(|queue| act(queue).is_err()) {
            // The guard is gone, which is noticed by its pulse.
            *slot = None;
        }
    }
}
