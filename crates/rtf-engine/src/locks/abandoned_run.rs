//! Stops the processes of a run whose runner and guard were killed.
//!
//! Its drivers still run, and its hooks did not. The kernel has released its lock, but the
//! lock's file names the owner. The next run with the lock stops the processes of the owner's
//! scope. A live run is never affected, because it would hold the lock.
//!
//! All users may write the file, so the scope is that of this user's own record. If there is none,
//! the owner was another user, whose processes cannot be stopped, or the file lies.

use std::time::Duration;

use rtf_model::{Diagnostic, EventKind};
use tokio::time::Instant;

use super::LockOwner;
use crate::events::Events;
use rtf_process::tree;

/// The time between SIGTERM and the kill.
const TERM_GRACE: Duration = Duration::from_secs(5);
/// How long killed processes may take to end.
const KILL_LIMIT: Duration = Duration::from_secs(5);
const POLL_INTERVAL: Duration = Duration::from_millis(20);
const SIGTERM: i32 = 15;
const SIGKILL: i32 = 9;
/// The signals, and how long each of them may take.
const STEPS: [(i32, Duration); 2] = [(SIGTERM, TERM_GRACE), (SIGKILL, KILL_LIMIT)];

/// Stops the processes of an owner that was killed with its guard, and emits a warning.
pub async fn stop_processes(owner: &LockOwner, events: &Events) {
    let mut diagnostic = Diagnostic::warning(
        "run-abandoned",
        format!("the runner and the guard of {owner} were killed: its hooks did not run"),
    );
    let mut known = Vec::new();
    // An empty scope would be that of all runs.
    let has_record = !owner.scope.is_empty();
    for (signal, limit) in has_record.then_some(STEPS).into_iter().flatten() {
        let end = Instant::now() + limit;
        let mut signalled = Vec::new();
        loop {
            let alive = tree::find_by_scope(&owner.scope);
            let new: Vec<_> = alive.iter().filter(|left| !signalled.contains(&left.pid)).collect();
            new.iter().for_each(|left| rtf_process::signal_process(left.pid, signal));
            signalled.extend(new.into_iter().map(|left| left.pid));
            let is_finished = alive.is_empty() || Instant::now() >= end;
            tree::add_new(&mut known, alive);
            if is_finished {
                break;
            }
            tokio::time::sleep(POLL_INTERVAL).await;
        }
    }
    for left in known {
        diagnostic = diagnostic.note(format!("stopped: {} {}", left.pid, left.command));
    }
    let diagnostic = diagnostic.hint("look at the robot: it may not be in a safe state".to_owned());
    events.emit(EventKind::Warning { diagnostic });
}
