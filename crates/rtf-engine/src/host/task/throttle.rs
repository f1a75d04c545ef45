//! A process that tells more than can be reported is read more slowly: what waits for a
//! disk that is too slow must not fill the memory. What it prints is always read, since
//! only so much of it is kept.
//!
//! Only the process that floods is throttled, and its deadlines are paused meanwhile.

use std::time::Duration;

use rtf_model::Source;

use super::Task;
use crate::run::machine::HostInput;

/// A test is not read while so many bytes of it wait to be reported.
const TEST_LIMIT: usize = 1024 * 1024;
/// The same for a fixture, whose collapse must not wait behind what it tells, and for a
/// test that is being stopped, whose deadlines go on.
const URGENT_LIMIT: usize = 16 * 1024 * 1024;
/// How often a throttled process's backlog is looked at.
pub(super) const POLL: Duration = Duration::from_millis(2);

/// Whether a process is read.
#[derive(Debug, Default)]
pub(super) struct Throttle {
    pub(super) is_throttled: bool,
    pub(super) is_stopping: bool,
}

impl Task {
    /// Begins or ends to throttle the process, by what waits of it now.
    pub(super) async fn throttle(&mut self) {
        let source = self.job.source;
        let limit = match source {
            // Hooks park the robot: they never wait.
            Source::Hook(_) => return,
            Source::Test(_) if !self.throttle.is_stopping => TEST_LIMIT,
            Source::Test(_) | Source::Fixture(_) => URGENT_LIMIT,
        };
        let backlog = self.shared.sink.backlog(source);
        if self.throttle.is_throttled && backlog <= limit / 2 {
            self.throttle.is_throttled = false;
            self.tell(HostInput::Resumed).await;
        } else if !self.throttle.is_throttled && backlog > limit {
            self.throttle.is_throttled = true;
            self.tell(HostInput::Throttled(source)).await;
        }
    }
}
