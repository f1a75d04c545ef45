//! A process on another machine.

use super::Task;
use crate::host::remote;

impl Task {
    /// Whether it runs on another machine.
    pub(super) fn is_remote(&self) -> bool {
        self.job.process.as_ref().is_some_and(|process| process.remote.is_some())
    }

    /// Sends a signal there.
    pub(super) fn signal_remote(&mut self, signal: i32) {
        // A connection that is stuck is noticed by its limit.
        self.outgoing.push(&remote::signal_line(signal));
    }
}
