//! How a process that does not end is stopped: SIGTERM, SIGKILL, and giving up.

use std::time::Duration;

use rtf_model::LeakedProcess;

pub const SIGTERM: i32 = 15;

/// From SIGTERM to SIGKILL. Also how long the processes of a plug-in fixture may take to end by
/// themselves after their host.
pub const TERM_GRACE: Duration = Duration::from_secs(1);

/// How often a process is killed before the runner gives it up: it may wait in the
/// kernel without limit.
pub const MAX_KILLS: u32 = 2;

/// From SIGKILL to the next step.
pub const KILL_WAIT: Duration = Duration::from_secs(5);

/// What had to be killed after the end of a process that was asked to stop.
pub fn killed_text(left: &[LeakedProcess]) -> Option<String> {
    match left {
        [] => None,
        [one] => Some(format!("`{}` still ran and was killed", one.command)),
        [first, more @ ..] => {
            let (count, noun) = (more.len(), if more.len() == 1 { "process" } else { "processes" });
            let command = &first.command;
            Some(format!("`{command}` and {count} more {noun} still ran and were killed"))
        }
    }
}
