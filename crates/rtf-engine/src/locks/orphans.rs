//! What a run left whose runner and guard were killed together.
//!
//! Nobody stops its drivers then, and nobody parks the robot. Its lock is free,
//! since the kernel takes it from the dead. Whoever gets the lock next finds in its
//! file who did not give it back, and stops what that one left, which is known by
//! its scope. So no process of a living run is touched: it would have the lock.

use std::time::Duration;

use rtf_model::{Diagnostic, EventKind};
use tokio::time::Instant;

use super::Owner;
use crate::run::Events;
use rtf_process::tree;

/// How long they may take to end when they are asked to.
const GRACE: Duration = Duration::from_secs(5);
/// How long they may take when they are killed.
const KILL_LIMIT: Duration = Duration::from_secs(5);
/// How often is looked whether they have ended.
const EVERY: Duration = Duration::from_millis(20);
const SIGTERM: i32 = 15;
const SIGKILL: i32 = 9;

/// Stops what an owner left that was killed with its guard, and says so.
pub async fn stop(owner: &Owner, events: &Events) {
    let mut diagnostic = Diagnostic::warning(
        "run-abandoned",
        format!("the runner and the guard of {owner} were killed: its hooks did not run"),
    );
    let mut known = Vec::new();
    for (signal, limit) in [(SIGTERM, GRACE), (SIGKILL, KILL_LIMIT)] {
        let end = Instant::now() + limit;
        let mut signalled = Vec::new();
        loop {
            let alive = tree::find_by_scope(&owner.scope);
            let new: Vec<_> = alive.iter().filter(|left| !signalled.contains(&left.pid)).collect();
            new.iter().for_each(|left| rtf_process::signal_process(left.pid, signal));
            signalled.extend(new.into_iter().map(|left| left.pid));
            let over = alive.is_empty() || Instant::now() >= end;
            tree::add_new(&mut known, alive);
            if over {
                break;
            }
            tokio::time::sleep(EVERY).await;
        }
    }
    for left in known {
        diagnostic = diagnostic.note(format!("stopped: {} {}", left.pid, left.command));
    }
    let diagnostic = diagnostic.hint("look at the robot: it may not be in a safe state".to_owned());
    events.emit(EventKind::Warning { diagnostic });
}
