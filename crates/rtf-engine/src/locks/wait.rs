//! Waiting until a suite has all the locks that it requires.

use std::path::PathBuf;
use std::time::Duration;

use rtf_model::EventKind;
use tokio::sync::watch;
use tokio::time::Instant;

use super::{Held, Lock, Locks, Owner};
use crate::plan::{Resource, SuitePlan};
use crate::run::{Events, Stop};

/// How often a lock that somebody has is tried.
const EVERY: Duration = Duration::from_millis(20);
/// Who waits for less is not told of.
const PATIENCE: Duration = Duration::from_millis(200);

/// How locks are waited for.
#[derive(Clone, Debug)]
pub struct LockOptions {
    /// The folder of locks.
    pub folder: PathBuf,
    /// How long one suite waits for all of its locks; `None`: for ever.
    pub limit: Option<Duration>,
}

/// Waits for the locks of a suite. Everybody takes them in the order of their
/// names, so that no two wait for each other. A request to stop ends the wait:
/// then nothing is begun, and nothing is locked.
///
/// # Errors
/// A sentence: what is held by whom when the limit is reached, or what the
/// system refused.
pub async fn wait(
    suite: &SuitePlan,
    options: &LockOptions,
    events: &Events,
    stops: &mut watch::Receiver<Option<Stop>>,
) -> Result<Vec<Lock>, String> {
    if suite.requires.is_empty() {
        return Ok(Vec::new());
    }
    let shown = options.folder.display();
    let cannot = |error| format!("the locks in `{shown}` cannot be used: {error}");
    let locks = Locks::open(&options.folder).map_err(cannot)?;
    let begun = Instant::now();
    let mut taken = Vec::new();
    for resource in &suite.requires {
        let mut told = Vec::new();
        loop {
            if stops.borrow().is_some() {
                taken.into_iter().for_each(Lock::release);
                return Ok(Vec::new());
            }
            let owner = owner(suite, events.run_token());
            let held = match locks.take(resource, &owner).map_err(cannot)? {
                Ok(lock) => break taken.push(lock),
                Err(held) => held,
            };
            let waited = begun.elapsed();
            if options.limit.is_some_and(|limit| waited >= limit) {
                taken.into_iter().for_each(Lock::release);
                return Err(given_up(resource, &held, waited));
            }
            if waited >= PATIENCE && told != held {
                let (suite, lock, held_by) = (suite.id, resource.name.clone(), shown_all(&held));
                events.emit(EventKind::SuiteWaiting { suite, lock, held_by });
                told = held;
            }
            tokio::select! {
                () = tokio::time::sleep(EVERY) => {}
                Ok(()) = stops.changed() => {}
            }
        }
    }
    Ok(taken)
}

fn given_up(resource: &Resource, held: &[Held], waited: Duration) -> String {
    let secs = waited.as_secs_f64();
    format!("`{}` is held by {}; given up after {secs:.1} s", resource.name, shown_all(held))
}

fn shown_all(held: &[Held]) -> String {
    held.iter().map(|held| held.owner.to_string()).collect::<Vec<_>>().join(" and ")
}

fn owner(suite: &SuitePlan, run: &str) -> Owner {
    let uid = || rustix::process::getuid().as_raw().to_string();
    let uname = rustix::system::uname();
    Owner {
        user: std::env::var("USER").ok().filter(|user| !user.is_empty()).unwrap_or_else(uid),
        host: uname.nodename().to_string_lossy().into_owned(),
        pid: std::process::id(),
        since: jiff::Zoned::now().strftime("%Y-%m-%dT%H:%M:%S%:z").to_string(),
        run: run.to_owned(),
        suite: suite.name.clone(),
    }
}
