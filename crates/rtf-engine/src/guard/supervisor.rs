//! The guard while the runner is alive: forwards signals, receives messages, and waits.

use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use rtf_model::{ExitStatus, LeakedProcess};
use rtf_process::{cgroup, signal_process, tree};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::Lifeline;
use super::heartbeat::{CHECK_INTERVAL, Heartbeat};
use super::message_receiver::MessageReceiver;
use super::recovery::{Recovery, SWEEP_LIMIT, recover};
use super::unix::{self, GuardSignals};

/// The exit code of a Rust program that panicked.
const PANICKED: i32 = 101;
/// How long the runner may take to end after the third request.
const LAST_GRACE: Duration = Duration::from_secs(5);
/// How long the guard waits for a killed runner. One that hangs in the kernel must not
/// prevent the hooks.
const KILL_LIMIT: Duration = Duration::from_secs(5);
/// A runner without a heartbeat for this long is silent.
const SILENT: Duration = Duration::from_secs(3);
/// The shortest time after which a silent runner is killed: a machine may be very busy.
pub const MIN_PATIENCE: Duration = Duration::from_secs(5);
/// A silent runner has handled at most this many requests: its hooks are run.
const MAX_HANDLED_REQUESTS: u32 = 2;

#[derive(Debug)]
pub struct Guard {
    runner: i32,
    receiver: MessageReceiver,
    signals: GuardSignals,
    forked: Instant,
    heartbeat: Heartbeat,
    /// How long the runner may be silent.
    patience: Duration,
    /// When the runner is killed, after the third request.
    kill_at: Option<Instant>,
    /// Why the runner was killed, and when the guard stops waiting for it.
    killed: Option<(String, Instant)>,
    /// The run ends when this is closed.
    lifeline: Option<Lifeline>,
}

/// How the run ended.
#[derive(Debug)]
pub enum GuardOutcome {
    /// The runner ended in order.
    RunnerExited {
        code: u8,
        /// Its leftover processes, which were killed: normally none.
        left: Vec<LeakedProcess>,
    },
    RunnerDied(Recovery),
}

impl Lifeline {
    /// A socket has events only when it is closed: its data would wake the guard all the time.
    fn polled(&self) -> PollFd<'_> {
        match self {
            Self::Input(line) => PollFd::new(line, PollFlags::IN),
            Self::Socket(line) => PollFd::new(line, PollFlags::RDHUP),
        }
    }

    fn has_ended(&self) -> bool {
        let has_event = matches!(poll(&mut [self.polled()], Some(&Timespec::default())), Ok(1..));
        has_event
            && match self {
                Self::Input(line) => {
                    matches!(rustix::io::read(line, &mut [0; 4096]), Ok(0) | Err(_))
                }
                Self::Socket(_) => true,
            }
    }
}

impl Guard {
    pub(super) fn new(
        runner: i32,
        [messages, heartbeat]: [UnixStream; 2],
        signals: GuardSignals,
        forked: Instant,
    ) -> Self {
        Self {
            runner,
            receiver: MessageReceiver::new(messages),
            signals,
            forked,
            heartbeat: Heartbeat::new(heartbeat),
            patience: MIN_PATIENCE,
            kill_at: None,
            killed: None,
            lifeline: None,
        }
    }

    /// Kills the runner when it is silent for this long.
    pub(super) fn with_patience(self, patience: Duration) -> Self {
        Self { patience: patience.max(MIN_PATIENCE), ..self }
    }

    /// Requests the end of the run when `lifeline` is closed.
    pub(super) fn with_lifeline(self, lifeline: Option<Lifeline>) -> Self {
        Self { lifeline, ..self }
    }

    /// Waits for the end of the runner, and recovers if it died.
    pub fn supervise(mut self) -> GuardOutcome {
        let status = loop {
            self.wait();
            for signal in self.signals.read() {
                self.forward(signal);
            }
            self.check_lifeline();
            let has_received = self.receiver.receive();
            self.heartbeat.receive(has_received || !self.is_running());
            self.kill_if_due();
            match unix::ended(self.runner) {
                Ok(None) if self.killed.as_ref().is_some_and(|(_, end)| *end <= Instant::now()) => {
                    break ExitStatus::Signal(libc::SIGKILL);
                }
                Ok(None) => {}
                Ok(Some(status)) => break status,
                // No other process reaps it; if one did, it has ended.
                Err(_) => break ExitStatus::Code(-1),
            }
        };
        // Its last messages.
        self.receiver.receive();
        let runner = self.runner;
        let outcome = self.conclude(status);
        cgroup::remove_groups_of(runner);
        outcome
    }

    /// Whether a run is in progress, so that the runner must send heartbeats.
    fn is_running(&self) -> bool {
        self.receiver.state.run.is_some() && !self.receiver.state.is_finished
    }

    fn wait(&self) {
        let mut fds = vec![PollFd::new(&self.signals, PollFlags::IN)];
        fds.extend(self.receiver.socket().map(|socket| PollFd::new(socket, PollFlags::IN)));
        fds.extend(self.lifeline.as_ref().map(Lifeline::polled));
        fds.extend(self.heartbeat.socket().map(|socket| PollFd::new(socket, PollFlags::IN)));
        let due = self.killed.as_ref().map(|(_, end)| *end).or(self.kill_at);
        let due = due.map(|at| at.saturating_duration_since(Instant::now()));
        let timeout = due.into_iter().chain(self.is_running().then_some(CHECK_INTERVAL)).min();
        let timeout = timeout.and_then(|left| Timespec::try_from(left).ok());
        // A signal interrupts it, and is in the pipe.
        let _ = poll(&mut fds, timeout.as_ref());
    }

    fn kill_if_due(&mut self) {
        if self.killed.is_some() {
            return;
        }
        let silence = self.heartbeat.silence();
        let late = self.kill_at.is_some_and(|at| at <= Instant::now());
        let why = if silence >= self.patience || (late && silence >= SILENT) {
            // The runner did not handle the last requests: its hooks did not run.
            self.signals.requests.lower(MAX_HANDLED_REQUESTS);
            let state = if tree::is_stopped(self.runner) { "it was stopped, and" } else { "it" };
            format!("{state} did not answer for {} s: the guard killed it", silence.as_secs())
        } else if late {
            let secs = LAST_GRACE.as_secs();
            format!("it did not end within {secs} s of the third request: the guard killed it")
        } else {
            return;
        };
        signal_process(self.runner, libc::SIGKILL);
        self.killed = Some((why, Instant::now() + KILL_LIMIT));
    }

    fn check_lifeline(&mut self) {
        if self.lifeline.as_ref().is_some_and(Lifeline::has_ended) {
            self.lifeline = None;
            if self.signals.requests.record(Instant::now()) {
                self.forward(libc::SIGTERM);
            }
        }
    }

    fn forward(&mut self, signal: i32) {
        match signal {
            // A run that supervises a robot must not be suspended.
            libc::SIGCHLD | libc::SIGTSTP => {}
            _ => {
                signal_process(self.runner, signal);
                // A stopped runner must handle it.
                signal_process(self.runner, libc::SIGCONT);
            }
        }
        if self.signals.requests_kill() && self.kill_at.is_none() {
            self.kill_at = Some(Instant::now() + LAST_GRACE);
        }
    }

    fn conclude(mut self, status: ExitStatus) -> GuardOutcome {
        let is_running = self.is_running();
        let state = std::mem::take(&mut self.receiver.state);
        let (code, reason) = match status {
            ExitStatus::Signal(_) if let Some((why, _)) = self.killed => (None, why),
            ExitStatus::Code(PANICKED) => (None, format!("it panicked ({status})")),
            ExitStatus::Code(_) if is_running => {
                (None, format!("it ended with {status} before the run was over"))
            }
            ExitStatus::Code(code) => (u8::try_from(code).ok(), String::new()),
            // The user ended it before the run started.
            ExitStatus::Signal(signal)
                if state.run.is_none() && self.signals.requests.count() > 0 =>
            {
                (u8::try_from(128 + signal).ok(), String::new())
            }
            ExitStatus::Signal(_) => (None, status.to_string()),
        };
        match code {
            Some(code) => {
                let left = tree::kill_until_none_is_left(SWEEP_LIMIT);
                GuardOutcome::RunnerExited { code, left }
            }
            None => GuardOutcome::RunnerDied(recover(state, reason, self.signals, self.forked)),
        }
    }
}
