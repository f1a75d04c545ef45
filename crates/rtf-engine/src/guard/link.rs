//! The runner's connection to its guard.

use std::os::fd::BorrowedFd;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use rtf_model::{HookId, Source, SuiteId, TestId};
use rustix::net::SendFlags;
use tokio::sync::Notify;

use super::fixture_stop::FixtureStop;
use super::message::{GuardMessage, HookSpec, HookStart};
use super::message_queue::MessageQueue;
use crate::fixture_values::FixtureValues;
use crate::isolate::PreparedSuite;
use rtf_plan::plan::SuitePlan;
use rtf_process::descriptor_passing::MAX_DESCRIPTORS;
use rtf_process::task::ProcessStream;

pub const HEARTBEAT_INTERVAL: Duration = Duration::from_secs(1);

/// The connection to the guard. Sending never fails and never blocks: the run continues
/// without a guard, or if the guard has ended or does not read.
#[derive(Debug)]
pub struct Link {
    queue: Mutex<Option<MessageQueue>>,
    /// Carries heartbeats; closed by the guard's death.
    heartbeat: Option<UnixStream>,
    forked: Instant,
    messages_lost: Notify,
}

impl Link {
    pub(super) fn new(socket: UnixStream, heartbeat: UnixStream, forked: Instant) -> Self {
        let heartbeat = heartbeat.set_nonblocking(true).is_ok().then_some(heartbeat);
        Self { heartbeat, forked, ..Self::with(Some(MessageQueue::new(socket))) }
    }

    /// A runner without a guard.
    pub fn none() -> Self {
        Self::with(None)
    }

    fn with(queue: Option<MessageQueue>) -> Self {
        Self {
            queue: Mutex::new(queue),
            heartbeat: None,
            forked: Instant::now(),
            messages_lost: Notify::new(),
        }
    }

    /// Sends a heartbeat, and queued messages.
    pub(crate) fn send_heartbeat(&self) {
        if let Some(heartbeat) = &self.heartbeat {
            // Fails if the guard does not read, and has unread heartbeats.
            let _ = rustix::net::send(heartbeat, b".", SendFlags::NOSIGNAL | SendFlags::DONTWAIT);
        }
        self.with_queue(MessageQueue::flush);
    }

    /// Waits until all messages were sent. The user waits for the guard: if it was stopped, the
    /// runner may wait, too.
    pub fn finish(&self) {
        self.with_queue(MessageQueue::finish);
    }

    /// Waits until messages were lost, because the guard did not read for a long time.
    pub(crate) async fn wait_for_lost_messages(&self) {
        self.messages_lost.notified().await;
    }

    /// The run starts; `start` is zero on the clock of its events. `scratch_dir` is its
    /// directory for temporary files.
    pub(crate) fn run_started(&self, journal: &Path, scratch_dir: PathBuf, start: Instant) {
        let started = start.saturating_duration_since(self.forked);
        self.send(&GuardMessage::RunStarted { journal: journal.to_owned(), scratch_dir, started });
    }

    pub(crate) fn run_finished(&self) {
        self.send(&GuardMessage::RunFinished);
    }

    /// A suite starts: the guard keeps its exclusive resources, and runs its abort hooks.
    pub(crate) fn suite_started(&self, prepared: &PreparedSuite<'_>) {
        let suite = &*prepared.plan;
        if let Some(held) = prepared.held_network() {
            let descriptors: Vec<_> = held.network().namespaces().descriptors().collect();
            self.send_resources(suite.id, &descriptors, Some(held.pid));
        }
        let locks: Vec<_> = prepared.locks().collect();
        for locks in locks.chunks(MAX_DESCRIPTORS) {
            self.send_resources(suite.id, locks, None);
        }
        if !suite.hooks.is_empty() {
            let leases: Vec<_> = prepared.leases().collect();
            for leases in leases.chunks(MAX_DESCRIPTORS) {
                self.send_resources(suite.id, leases, None);
            }
            let hooks = suite.hooks.iter().map(|hook| HookSpec::new(suite, hook)).collect();
            self.send(&GuardMessage::SuiteStarted { suite: suite.id, hooks });
            if suite.refers_to_values {
                self.fixture_values(suite, FixtureValues::new(suite));
            }
        }
    }

    fn send_resources(&self, suite: SuiteId, fds: &[BorrowedFd<'_>], holder: Option<i32>) {
        let message = GuardMessage::SuiteResources { suite, descriptors: fds.len(), holder };
        self.send_with(&message, fds);
    }

    pub(crate) fn suite_finished(&self, prepared: &PreparedSuite<'_>) {
        let has_resources = prepared.held_network().is_some() || prepared.locks().next().is_some();
        let has_hooks = !prepared.plan.hooks.is_empty();
        if has_hooks || has_resources {
            self.send(&GuardMessage::SuiteFinished { suite: prepared.plan.id });
        }
    }

    /// The fixtures of a suite have provided these values, which its hooks can use.
    pub(crate) fn fixture_values(&self, suite: &SuitePlan, values: FixtureValues) {
        if !suite.hooks.is_empty() {
            self.send(&GuardMessage::FixtureValues { suite: suite.id, values });
        }
    }

    pub(crate) fn test_started(&self, suite: &SuitePlan, test: TestId, name: &str) {
        if !suite.hooks.is_empty() {
            self.send(&GuardMessage::TestStarted { suite: suite.id, test, name: name.to_owned() });
        }
    }

    pub(crate) fn test_finished(&self, suite: &SuitePlan, test: TestId) {
        if !suite.hooks.is_empty() {
            self.send(&GuardMessage::TestFinished { suite: suite.id, test });
        }
    }

    /// A hook is about to start. Call it before its process is started.
    pub(crate) fn hook_starting(&self, start: HookStart) {
        self.send(&GuardMessage::HookStarting(start));
    }

    /// A process was started. The guard also keeps the streams of a hook's or fixture's
    /// process, so that it can continue without the runner. `stop` is how a fixture is stopped.
    pub(crate) fn process_started(
        &self,
        source: Source,
        pid: i32,
        streams: &[(ProcessStream, BorrowedFd<'_>)],
        stop: Option<&FixtureStop>,
    ) {
        let (names, descriptors): (Vec<_>, Vec<_>) = streams.iter().copied().unzip();
        let message = match (source, stop) {
            (Source::Hook(hook), _) => GuardMessage::HookStarted { hook, pid, streams: names },
            (Source::Fixture(_), Some(stop)) => {
                GuardMessage::FixtureStarted { pid, streams: names, stop: stop.clone() }
            }
            (Source::Test(_) | Source::Fixture(_), _) => return,
        };
        self.send_with(&message, &descriptors);
    }

    /// A hook has finished. Call it before its event is emitted.
    pub(crate) fn hook_finished(&self, hook: HookId, problem: Option<String>) {
        self.send(&GuardMessage::HookFinished { hook, problem });
    }

    pub(crate) fn process_ended(&self, source: Source, pid: i32) {
        if matches!(source, Source::Fixture(_)) {
            self.send(&GuardMessage::FixtureEnded { pid });
        }
    }

    /// Waits for the guard's death. Never returns without a guard.
    pub(crate) async fn guard_died(&self) {
        let socket = self.heartbeat.as_ref().and_then(|socket| socket.try_clone().ok());
        match socket.and_then(|socket| tokio::net::UnixStream::from_std(socket).ok()) {
            // The guard never writes: the socket becomes readable at its end.
            Some(socket) => drop(socket.readable().await),
            None => std::future::pending().await,
        }
    }

    fn send(&self, message: &GuardMessage) {
        self.send_with(message, &[]);
    }

    fn send_with(&self, message: &GuardMessage, descriptors: &[BorrowedFd<'_>]) {
        self.with_queue(|queue| {
            let had_lost = queue.has_lost_messages;
            let sent = queue.send(message, descriptors);
            if queue.has_lost_messages && !had_lost {
                self.messages_lost.notify_one();
            }
            sent
        });
    }

    fn with_queue(&self, act: impl FnOnce(&mut MessageQueue) -> std::io::Result<()>) {
        let mut slot = self.queue.lock().unwrap_or_else(PoisonError::into_inner);
        if slot.as_mut().is_some_and(|queue| act(queue).is_err()) {
            // The guard has ended, which the heartbeat socket shows.
            *slot = None;
        }
    }
}
