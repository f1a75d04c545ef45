//! The host's end of the channel, shared by its threads.

use std::collections::VecDeque;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use rtf_model::protocol::{Answer, CHANNEL_VARIABLE, Notification, Reply, RpcError};
use rtf_model::{Attachment, Measurement, Message, MessageKind, Outcome, Phase};
use serde::Serialize;

use crate::decode::Incoming;
use crate::sampling::{Sample, Sampling};
use crate::unix;
use crate::verdict::Judge;
use crate::writer::Writer;

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
        /// The descriptor.
        fd: i32,
        /// The system's reason.
        source: std::io::Error,
    },
}

/// The connection to the runner. Cheap to clone; every function may be called
/// from any thread.
#[derive(Clone, Debug)]
pub struct Session(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    channel: Arc<UnixStream>,
    writer: Writer,
    /// Taken before the state, never after it.
    sampling: Mutex<Sampling>,
    state: Mutex<State>,
    changed: Condvar,
    stop: AtomicBool,
}

#[derive(Debug, Default)]
struct State {
    incoming: VecDeque<Incoming>,
    closed: bool,
    /// A plug-in is loaded: without the runner nobody would stop it.
    engaged: bool,
    /// A request is being carried out.
    busy: bool,
    /// The number of the one that was taken last.
    request: Option<u64>,
    stop_reason: Option<String>,
    /// Where the copies of attached files go, and how many there are.
    attachments_dir: Option<PathBuf>,
    attached: u64,
    judge: Judge,
}

impl Session {
    /// Opens the channel that the runner left, and removes its traces from the
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
        Self(Arc::new(Shared {
            writer: Writer::new(Arc::clone(&channel)),
            channel,
            sampling: Mutex::default(),
            state: Mutex::default(),
            changed: Condvar::new(),
            stop: AtomicBool::new(false),
        }))
    }

    /// Sends a message of the plug-in. A failure or an error counts for the
    /// request that is being carried out.
    pub fn message(&self, message: Message) {
        if !matches!(message.kind, MessageKind::Report | MessageKind::Check) {
            self.note(|judge| judge.note_message(&message));
        }
        self.notify(&Notification::Message(message));
    }

    /// Sends a measurement and tells whether it is within its limits; outside
    /// them it counts as a failure.
    pub fn measure(&self, measurement: Measurement) -> bool {
        let holds = measurement.is_within_limits();
        if !holds {
            self.note(|judge| judge.note_measurement(&measurement));
        }
        self.notify(&Notification::Measured(measurement));
        holds
    }

    /// Takes a sample and tells whether it is within its limits; outside them it
    /// counts as a failure. It is sent with others, at the latest before the next
    /// other message, before a wait, and at the end of the request.
    pub fn sample(&self, sample: &Sample<'_>) -> bool {
        let mut sampling = self.sampling();
        let problem = sampling.take(sample);
        let holds = problem.is_none();
        problem.into_iter().for_each(|text| self.note(|judge| judge.note_failure(&text)));
        sampling.send_due(&self.0.writer);
        holds
    }

    /// Keeps a copy of a file with the test's result. Afterwards the plug-in may
    /// change or remove the file.
    ///
    /// # Errors
    /// It cannot be copied.
    pub fn attach(&self, mut attachment: Attachment) -> std::io::Result<()> {
        let mut source = unix::open_regular(Path::new(&attachment.path))?;
        // Without such a folder the runner copies the file, as soon as it can.
        if let Some(copy) = self.place_for_copy(&attachment.name) {
            std::fs::create_dir_all(copy.parent().unwrap_or(&copy))?;
            std::io::copy(&mut source, &mut std::fs::File::create(&copy)?)?;
            attachment.path = copy.to_string_lossy().into_owned();
        }
        self.notify(&Notification::Attached(attachment));
        Ok(())
    }

    /// Where the next attached file goes: `3-plot.png`.
    fn place_for_copy(&self, name: &str) -> Option<PathBuf> {
        let safe = |c: char| if c.is_alphanumeric() || ".-_".contains(c) { c } else { '_' };
        let mut state = self.state();
        state.attached += 1;
        let number = state.attached;
        let name: String = name.chars().map(safe).collect();
        state.attachments_dir.as_ref().map(|folder| folder.join(format!("{number}-{name}")))
    }

    /// Says where the copies of attached files go.
    pub(crate) fn keep_in(&self, folder: Option<PathBuf>) {
        self.state().attachments_dir = folder;
    }

    /// Reports that the fixture is not well any more.
    pub fn collapsed(&self, reason: &str) {
        self.notify(&Notification::Collapsed { reason: reason.to_owned() });
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

    /// Sleeps. True at once when the plug-in is asked to stop.
    #[must_use]
    pub fn wait(&self, duration: Duration) -> bool {
        self.sampling().send_before(duration, &self.0.writer);
        let state = self.state();
        let waiting = |state: &mut State| state.stop_reason.is_none();
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

    /// Takes a request that came in.
    pub(crate) fn push(&self, incoming: Incoming) {
        self.state().incoming.push_back(incoming);
        self.0.changed.notify_all();
    }

    /// Asks the plug-in to stop; whether there is one. If not, the runner's
    /// request crossed the answer. With a number, only that request is meant.
    pub(crate) fn request_stop(&self, reason: &str, request: Option<u64>) -> bool {
        // Whoever has it just now is about to send.
        if let Ok(mut sampling) = self.0.sampling.try_lock() {
            sampling.send(&self.0.writer);
        }
        let mut state = self.state();
        let is_asked = match (request, state.busy) {
            (None, busy) => busy || !state.incoming.is_empty(),
            (Some(_), true) => state.request == request,
            (Some(_), false) => state.incoming.front().is_some_and(|next| next.id() == request),
        };
        if is_asked {
            state.judge.note(Outcome::Interrupted, reason);
            state.stop_reason.get_or_insert_with(|| reason.to_owned());
            self.0.stop.store(true, Ordering::Release);
            self.0.changed.notify_all();
        }
        is_asked
    }

    /// The runner is gone. A plug-in that it cannot stop any more ends here.
    pub(crate) fn close(&self) {
        let mut state = self.state();
        if state.engaged {
            unix::end_now();
        }
        state.closed = true;
        self.0.changed.notify_all();
    }

    /// A request that was read on the main thread is about to be carried out.
    pub(crate) fn begin(&self, incoming: &Incoming) {
        let mut state = self.state();
        (state.busy, state.request) = (true, incoming.id());
    }

    /// The next request, `None` at the end of the channel.
    pub(crate) fn next(&self) -> Option<Incoming> {
        let mut state = self.state();
        loop {
            if let Some(incoming) = state.incoming.pop_front() {
                (state.busy, state.request) = (true, incoming.id());
                return Some(incoming);
            }
            if state.closed {
                return None;
            }
            state = self.0.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// A plug-in is about to be loaded, or has been forgotten.
    pub(crate) fn engage(&self, engaged: bool) {
        self.state().engaged = engaged;
    }

    /// A test enters a phase, or begins.
    pub(crate) fn phase(&self, phase: Phase) {
        self.notify(&Notification::Phase { phase });
        if phase == Phase::Setup {
            self.sampling().begin();
        }
    }

    /// Looks at, or changes, what is known about the present request.
    pub(crate) fn judge<T>(&self, look: impl FnOnce(&mut Judge) -> T) -> T {
        look(&mut self.state().judge)
    }

    /// Lets something count for the present request, if there is one: a fixture's
    /// threads report also between requests.
    fn note(&self, note: impl FnOnce(&mut Judge)) {
        let mut state = self.state();
        if state.busy {
            note(&mut state.judge);
        }
    }

    /// Takes the request to stop as heard: what follows (a tear-down that parks
    /// the robot) may sleep and wait again, until the runner asks once more.
    pub(crate) fn clear_stop(&self) {
        let mut state = self.state();
        state.stop_reason = None;
        self.0.stop.store(false, Ordering::Release);
    }

    /// Ends the present request: what was found out about it.
    pub(crate) fn conclude(&self) -> Answer {
        let mut state = self.state();
        state.busy = false;
        state.stop_reason = None;
        self.0.stop.store(false, Ordering::Release);
        state.judge.answer()
    }

    /// Ends a request that was not about a plug-in; a request to stop that is
    /// meant for the next one stays.
    pub(crate) fn pass(&self) {
        self.state().busy = false;
    }

    /// Answers a request. A notification that should have been a request is
    /// carried out all the same, but nobody waits for an answer.
    pub(crate) fn answer<T: Serialize>(&self, id: Option<u64>, result: T) -> bool {
        self.sampling().send(&self.0.writer);
        id.is_none() || self.0.writer.send(id, &Reply::Result(result))
    }

    /// Refuses a request.
    pub(crate) fn refuse(&self, id: Option<u64>, error: RpcError) {
        self.0.writer.send(id, &Reply::<()>::Error(error));
    }

    /// What was sampled before comes before.
    fn notify(&self, notification: &Notification) {
        self.sampling().send(&self.0.writer);
        self.0.writer.notify(notification);
    }

    fn sampling(&self) -> MutexGuard<'_, Sampling> {
        self.0.sampling.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
