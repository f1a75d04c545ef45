//! Back-pressure: reads a process more slowly while too much of its messages waits to be
//! reported, so that a slow disk does not fill the memory.
//!
//! Only the process that floods is throttled, and its deadlines are paused. Its outputs
//! are always read, because only a limited part of them is kept.

use std::time::Duration;

use super::{ProcessEvent, ProcessTask};
use crate::spawn_request::ProcessRole;

/// The backlog above which a test is not read, in bytes.
const TEST_LIMIT: usize = 1024 * 1024;
/// The same for a fixture, whose collapse must not wait behind its other messages, and for
/// a test that is being stopped, whose deadlines are not paused.
const URGENT_LIMIT: usize = 16 * 1024 * 1024;
/// The interval between polls of a throttled process's backlog.
pub(super) const POLL_INTERVAL: Duration = Duration::from_millis(2);

/// Whether a process is throttled.
#[derive(Debug, Default)]
pub(super) struct Throttle {
    pub(super) is_throttled: bool,
    pub(super) is_stopping: bool,
}

impl ProcessTask {
    /// Starts or ends throttling, depending on the backlog.
    pub(super) async fn update_throttle(&mut self) {
        let limit = match self.role() {
            // Hooks park the robot: they must not wait.
            Some(ProcessRole::Hook) | None => return,
            Some(ProcessRole::Test) if !self.throttle.is_stopping => TEST_LIMIT,
            Some(ProcessRole::Test | ProcessRole::Fixture) => URGENT_LIMIT,
        };
        let backlog = self.job.owner.backlog();
        if self.throttle.is_throttled && backlog <= limit / 2 {
            self.throttle.is_throttled = false;
            self.report(ProcessEvent::Resumed).await;
        } else if !self.throttle.is_throttled && backlog > limit {
            self.throttle.is_throttled = true;
            self.report(ProcessEvent::Throttled).await;
        }
    }
}
