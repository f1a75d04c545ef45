//! The host's end of the channel, which its threads share.

mod attachments;
mod cases;
mod episodes;
mod faults;
mod findings;
mod program;
mod questions;
mod requests;

use std::collections::{BTreeMap, VecDeque};
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use rtf_model::protocol::{CHANNEL_VARIABLE, Notification, QuestionEnd};
use rtf_model::{Location, Measurement, Message, MessageKind, Outcome, TrajectoryCheck};
use serde_json::Value;

use crate::cases::Cases;
use crate::decode::Incoming;
use crate::outcome::RequestOutcome;
use crate::sampling::{Sample, Sampling};
use crate::unix;
use crate::writer::Writer;
use episodes::EpisodeQueue;
pub use episodes::TakenEpisode;
pub use faults::FaultRequest;
pub use questions::Inquiry;

/// Why there is no channel to the runner.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The process was not started by a runner.
    #[error("`{CHANNEL_VARIABLE}` is not set: a host is started by `rtf`")]
    NotSet,
    /// The variable does not name a descriptor.
    #[error("`{CHANNEL_VARIABLE}` is `{0}`, expected `fd:N`")]
    Malformed(String),
    /// The descriptor is not usable.
    #[error("cannot use the descriptor {fd} of `{CHANNEL_VARIABLE}`")]
    Descriptor {
        fd: i32,
        /// The system's reason.
        source: std::io::Error,
    },
}

/// The connection to the runner. Cheap to clone; every function may be called
/// from any thread.
#[derive(Clone, Debug)]
pub struct Session(Arc<SharedSession>);

#[derive(Debug)]
struct SharedSession {
    channel: Arc<UnixStream>,
    writer: Writer,
    /// Lock order: before the state.
    sampling: Mutex<Sampling>,
    /// Lock order: before the samples.
    cases: Cases,
    state: Mutex<SessionState>,
    changed: Condvar,
    stop: AtomicBool,
}

#[derive(Debug, Default)]
struct SessionState {
    incoming: VecDeque<Incoming>,
    closed: bool,
    /// A plug-in is loaded: without the runner, no process could stop it.
    has_plugin: bool,
    /// Whether the host carries out a request.
    busy: bool,
    /// The number of the last request that began.
    request: Option<u64>,
    stop_reason: Option<String>,
    /// The directory for copies of attached files, and how many were attached.
    attachments_dir: Option<PathBuf>,
    attached: u64,
    outcome: RequestOutcome,
    /// Questions that a thread of the plug-in waits for, with their ends.
    questions: BTreeMap<u32, Option<QuestionEnd>>,
    last_question: u32,
    episodes: EpisodeQueue,
}

impl Session {
    /// Opens the channel that the runner left, and removes its variable from the
    /// environment. Call it first, while the process has one thread.
    ///
    /// # Errors
    /// The process was not started as a host.
    pub fn open() -> Result<Self, OpenError> {
        let value = std::env::var_os(CHANNEL_VARIABLE).ok_or(OpenError::NotSet)?;
        let value = value.to_string_lossy();
        let fd = value.strip_prefix("fd:").and_then(|number| number.parse().ok());
        let fd = fd.ok_or_else(|| OpenError::Malformed(value.clone().into_owned()))?;
        unix::remove_variable(CHANNEL_VARIABLE);
        unix::restore_sigpipe();
        let channel = unix::take_channel(fd);
        channel.map(Self::over).map_err(|source| OpenError::Descriptor { fd, source })
    }

    /// A session over a channel that is already open.
    #[must_use]
    pub fn over(channel: UnixStream) -> Self {
        let channel = Arc::new(channel);
        Self::new(Writer::new(Arc::clone(&channel)), channel)
    }

    /// A session without a runner: [`Self::take_sent`] returns its lines. For tests that need many
    /// sessions.
    ///
    /// # Errors
    /// The system has no more descriptors.
    pub fn without_runner() -> std::io::Result<Self> {
        let channel = Arc::new(UnixStream::pair()?.0);
        Ok(Self::new(Writer::keeping(Arc::clone(&channel)), channel))
    }

    /// The lines that a session [without a runner](Self::without_runner) has sent since the last call.
    #[must_use]
    pub fn take_sent(&self) -> Vec<u8> {
        self.0.writer.take_kept()
    }

    fn new(writer: Writer, channel: Arc<UnixStream>) -> Self {
        Self(Arc::new(SharedSession {
            writer,
            channel,
            sampling: Mutex::default(),
            cases: Cases::default(),
            state: Mutex::default(),
            changed: Condvar::new(),
            stop: AtomicBool::new(false),
        }))
    }

    /// Sends a message of the plug-in. A failure or an error is a problem of the present
    /// request.
    pub fn message(&self, mut message: Message) {
        message.case = self.0.cases.current();
        match message.kind {
            MessageKind::Report | MessageKind::Check => {}
            MessageKind::Failure => self.record_reported(Outcome::Failed),
            MessageKind::Error => self.record_reported(Outcome::Error),
        }
        self.notify(&Notification::Message(message));
    }

    /// Sends a measurement and returns whether it is within its limits; outside
    /// them it is a failure.
    pub fn measure(&self, mut measurement: Measurement) -> bool {
        measurement.case = self.0.cases.current();
        let is_within = measurement.is_within_limits();
        if !is_within {
            self.record_reported(Outcome::Failed);
        }
        self.notify(&Notification::Measured(measurement));
        is_within
    }

    /// Sends a measurement whose value is judged otherwise: outside its limits, it is no failure
    /// of the plug-in.
    pub fn report_judged(&self, mut measurement: Measurement) {
        measurement.case = self.0.cases.current();
        self.notify(&Notification::Measured(measurement));
    }

    /// Takes a sample and returns whether it is within its limits; outside them it
    /// is a failure. It is sent in a batch: at the latest before the next other message,
    /// before a wait, and before the answer.
    pub fn sample(&self, sample: &Sample<'_>) -> bool {
        let case = self.0.cases.current();
        let mut sampling = self.sampling();
        let is_within = sampling.add(sample, case);
        if !is_within {
            self.record_reported(Outcome::Failed);
        }
        sampling.send_due(&self.0.writer);
        is_within
    }

    /// Checks the samples of a signal so far against a stored trajectory. The runner compares, so
    /// the plug-in does not learn the result.
    pub fn check_trajectory(&self, mut check: TrajectoryCheck) {
        check.case = self.0.cases.current();
        self.notify(&Notification::Trajectory(check));
    }

    /// Reports an error of the plug-in that it did not report itself.
    pub(crate) fn error(&self, text: String, location: Option<Location>) {
        self.message(Message::new(MessageKind::Error, text, location));
    }

    pub fn collapsed(&self, reason: &str) {
        self.notify(&Notification::Collapsed { reason: reason.to_owned() });
    }

    /// Provides a value of the fixture. The runner checks the name and the value. Has no
    /// effect in a forked child.
    pub fn provide(&self, name: String, value: Value) {
        if self.0.cases.is_forked_child() {
            return;
        }
        self.flush();
        let provided = Notification::Provided { name, value };
        if !self.0.writer.send(None, &provided) {
            let text = "a value and its name are longer than a line of the protocol";
            self.error(text.to_owned(), None);
        }
    }

    /// Sends the stacks that the runner asked for.
    pub fn stack(&self, text: String) {
        self.notify(&Notification::Stack { text });
    }

    /// Whether the plug-in was asked to stop.
    #[must_use]
    pub fn interrupted(&self) -> bool {
        self.0.stop.load(Ordering::Acquire)
    }

    /// Sleeps. Returns true as soon as the plug-in is asked to stop.
    #[must_use]
    pub fn wait(&self, duration: Duration) -> bool {
        self.sampling().send_before(duration, &self.0.writer);
        let state = self.state();
        let waiting = |state: &mut SessionState| state.stop_reason.is_none();
        let (state, _) = self
            .0
            .changed
            .wait_timeout_while(state, duration, waiting)
            .unwrap_or_else(PoisonError::into_inner);
        state.stop_reason.is_some()
    }

    /// The channel, for the thread that reads it.
    pub(crate) fn channel(&self) -> Arc<UnixStream> {
        Arc::clone(&self.0.channel)
    }

    /// Sends all samples.
    pub(crate) fn flush(&self) {
        self.sampling().send(&self.0.writer);
    }

    /// Sends a notification, after the samples that were taken before.
    fn notify(&self, notification: &Notification) {
        self.flush();
        self.0.writer.notify(notification);
    }

    fn sampling(&self) -> MutexGuard<'_, Sampling> {
        self.0.sampling.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn state(&self) -> MutexGuard<'_, SessionState> {
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
