//! The events that a process's task reports.

use rtf_model::protocol::{Notification, Reply};
use rtf_model::{Attachment, ExitStatus, LeakedProcess, Stream, Usage};
use tokio::sync::mpsc;

/// The id of a process, and of each assignment of a shared host. Never used twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct HostId(pub u64);

/// The queue of events of all processes of one owner.
pub type EventSender = mpsc::Sender<(HostId, ProcessEvent)>;

#[derive(Debug)]
pub enum ProcessEvent {
    SpawnFailed(String),
    Notified(Notification),
    /// It attached a file; the result of copying it into the run's directory.
    Attached(Result<Attachment, String>),
    Replied(u64, Reply<serde_json::Value>),
    ProtocolViolated(String),
    /// Its channel is not read for a while, because too much of its output waits to be
    /// reported: its deadlines are paused.
    Throttled,
    /// Its channel is read again.
    Resumed,
    /// It printed to an output.
    Printed(Stream, Vec<u8>),
    /// A value of a process was read.
    ValueRead {
        name: String,
        value: String,
    },
    /// All `ready` probes have passed.
    ProbesPassed,
    /// A `ready` probe does not pass yet; sent once for each reason.
    ProbePending(String),
    /// An `alive` probe failed.
    ProbeFailed(String),
    /// The resources that it and everything below it use.
    ResourcesMeasured {
        usage: Usage,
        /// The number of tests served, for a shared host.
        tests_served: Option<u32>,
    },
    /// It is alive, its probes pass, and all its earlier messages were delivered.
    Alive,
    /// It is dying; its end follows.
    Dying,
    /// The stacks of its threads, or why there are none.
    StackDumped(String),
    /// Its assignment has finished, and all its output was delivered. The host continues
    /// with the next one. The last event of this id.
    Released,
    /// Its host served earlier assignments and ended before this one began. The last event
    /// of this id.
    NotStarted(ExitStatus),
    /// It ended, and processes that it started are alive: its tree is being stopped, or it is a
    /// fixture that ended by itself. [`ProcessEvent::Exited`] follows when the last of them has
    /// ended, or was killed.
    LeaderEnded(ExitStatus, Vec<LeakedProcess>),
    /// It ended, all its output was delivered, and its leftover processes were killed. The
    /// last event of this id.
    Exited(ExitStatus, Vec<LeakedProcess>),
}
