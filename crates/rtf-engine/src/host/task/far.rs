//! A process on another machine.

use tokio::io::AsyncWriteExt;

use super::{DRAIN_LIMIT, Task};
use crate::host::remote;

impl Task {
    /// Whether it runs on another machine.
    pub(super) fn is_remote(&self) -> bool {
        self.job.process.as_ref().is_some_and(|process| process.remote.is_some())
    }

    /// Sends a signal there.
    pub(super) async fn signal_remote(&mut self, signal: i32) {
        if let Some(channel) = &mut self.process.channel {
            let line = remote::signal_line(signal);
            // A connection that is stuck is noticed by its limit.
            let _ = tokio::time::timeout(DRAIN_LIMIT, channel.write_all(&line)).await;
        }
    }
}
