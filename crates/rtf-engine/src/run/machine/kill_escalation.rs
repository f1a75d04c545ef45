//! How a process that does not end is stopped: SIGTERM, SIGKILL, and giving up.

use std::time::Duration;

pub const SIGTERM: i32 = 15;

/// From SIGTERM to SIGKILL.
pub const TERM_GRACE: Duration = Duration::from_secs(1);

/// How often a process is killed before the runner gives it up: it may wait in the
/// kernel without limit.
pub const MAX_KILLS: u32 = 2;

/// From SIGKILL to the next step.
pub const KILL_WAIT: Duration = Duration::from_secs(5);
