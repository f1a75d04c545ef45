//! The commands that a process's task accepts.

use std::sync::Arc;
use std::time::Duration;

use rtf_model::protocol::{Plugin, Request, StackSupport};

use super::event::HostId;
use super::job::ProcessOwner;
use crate::probe::ProbeSelection;
use crate::tree::SignalReach;

/// A command to a process's task.
#[derive(Debug)]
pub enum ProcessCommand {
    /// Assign a further request to a shared host.
    Assign(Assignment),
    Send(Option<u64>, Request),
    /// Send nothing more.
    CloseChannel,
    /// Dump the stacks of its threads; with a debugger if a host that sends them itself has
    /// not done so in this time.
    DumpStack(StackSupport, Duration),
    /// Send a signal to its process group, or to more of its tree.
    Signal(i32, SignalReach),
    /// Kill it and everything below it.
    KillTree,
    /// Poll the `alive` probes from now on.
    WatchAlive,
    /// Check once that it is alive and that these probes pass.
    CheckAlive(ProbeSelection),
}

impl ProcessCommand {
    /// Whether it is a step of a stop, whose deadlines are not paused.
    pub fn stops(&self) -> bool {
        matches!(
            self,
            Self::Send(_, Request::Interrupt { .. })
                | Self::DumpStack(..)
                | Self::Signal(..)
                | Self::KillTree
        )
    }
}

/// A further request for a shared host.
#[derive(Debug)]
pub struct Assignment {
    /// The host's id from the start of this assignment on.
    pub host: HostId,
    /// The host's owner from then on.
    pub owner: Arc<dyn ProcessOwner>,
    /// The directory for attachments, relative to the run's.
    pub attachments_dir: String,
    /// The owner named in reports of leaked processes: `test arm/EncoderTest`.
    pub leak_owner: String,
    /// The id of the request.
    pub request: u64,
    /// The parameters of the request.
    pub plugin: Plugin,
}
