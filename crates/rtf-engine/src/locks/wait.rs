//! Waits for all locks that a suite requires.

use std::path::PathBuf;
use std::time::Duration;

use rtf_model::EventKind;
use tokio::sync::watch;
use tokio::time::Instant;

use super::{HeldLock, Lock, LockOwner, Locks, abandoned_run};
use crate::control::{Control, Controls, Stop};
use crate::events::Events;
use rtf_plan::plan::{RequiredResource, SuitePlan};

const POLL_INTERVAL: Duration = Duration::from_millis(20);
/// A shorter wait is not reported.
const REPORT_AFTER: Duration = Duration::from_millis(200);

#[derive(Clone, Debug)]
pub struct LockOptions {
    pub dir: PathBuf,
    /// How long one suite waits for all its locks; `None` for no limit.
    pub limit: Option<Duration>,
}

/// Waits for the locks of a suite. All runs acquire them in the order of their names, which
/// prevents deadlocks. A request to stop, or to skip the suite, ends the wait without locks.
///
/// # Errors
/// A message for users: the owner of a lock when the limit is reached, or an error of the
/// system.
pub async fn wait(
    suite: &SuitePlan,
    options: &LockOptions,
    events: &Events,
    (stops, controls): (&mut watch::Receiver<Option<Stop>>, &mut Controls),
) -> Result<Vec<Lock>, String> {
    if suite.settings.requires.is_empty() {
        return Ok(Vec::new());
    }
    let shown = options.dir.display();
    let cannot = |error| format!("the locks in `{shown}` cannot be used: {error}");
    let locks = Locks::open(&options.dir).map_err(cannot)?;
    let started = Instant::now();
    let mut acquired = Vec::new();
    for resource in &suite.settings.requires {
        let mut reported = Vec::new();
        loop {
            if stops.borrow().is_some() || is_skipped(suite, controls) {
                acquired.into_iter().for_each(Lock::release);
                return Ok(Vec::new());
            }
            let owner = owner(suite, events.run_token());
            let held = match locks.try_acquire(resource, &owner).map_err(cannot)? {
                Ok(lock) => break acquired.push(lock),
                Err(held) => held,
            };
            let waited = started.elapsed();
            if options.limit.is_some_and(|limit| waited >= limit) {
                acquired.into_iter().for_each(Lock::release);
                return Err(limit_reached(resource, &held, waited));
            }
            if waited >= REPORT_AFTER && reported != held {
                let (suite, lock, held_by) = (suite.id, resource.name.clone(), owners(&held));
                events.emit(EventKind::SuiteWaiting { suite, lock, held_by });
                reported = held;
            }
            tokio::select! {
                () = tokio::time::sleep(POLL_INTERVAL) => {}
                Ok(()) = stops.changed() => {}
                Ok(()) = controls.changed() => {}
            }
        }
    }
    for owner in acquired.iter().filter_map(|lock: &Lock| lock.abandoned.as_ref()) {
        abandoned_run::stop_processes(owner, events).await;
    }
    Ok(acquired)
}

fn is_skipped(suite: &SuitePlan, controls: &Controls) -> bool {
    let skips = |control: &Control| matches!(control, Control::SkipSuite { suite: id, .. } if *id == suite.id);
    controls.borrow().iter().any(skips)
}

fn limit_reached(resource: &RequiredResource, held: &[HeldLock], waited: Duration) -> String {
    let secs = waited.as_secs_f64();
    format!("`{}` is held by {}; given up after {secs:.1} s", resource.name, owners(held))
}

fn owners(held: &[HeldLock]) -> String {
    held.iter().map(|held| held.owner.to_string()).collect::<Vec<_>>().join(" and ")
}

fn owner(suite: &SuitePlan, run: &str) -> LockOwner {
    let uid = || rustix::process::getuid().as_raw().to_string();
    let uname = rustix::system::uname();
    LockOwner {
        user: std::env::var("USER").ok().filter(|user| !user.is_empty()).unwrap_or_else(uid),
        host: uname.nodename().to_string_lossy().into_owned(),
        pid: std::process::id(),
        since: jiff::Zoned::now().strftime("%Y-%m-%dT%H:%M:%S%:z").to_string(),
        run: run.to_owned(),
        suite: suite.name.clone(),
        scope: format!("{run}.{}.", suite.id),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use rtf_model::Event;

    use super::*;
    use crate::events::EventSink;
    use crate::run::machine::tests::world::suite;

    #[derive(Debug)]
    struct NullSink;

    impl EventSink for NullSink {
        fn emit(&self, _: Event) {}
    }

    #[tokio::test]
    async fn a_skipped_suite_stops_waiting() {
        let temp = tempfile::tempdir().unwrap();
        let dir = temp.path().join("locks");
        let arm = RequiredResource { name: "arm".to_owned(), slots: 1 };
        let lock =
            Locks::open(&dir).unwrap().try_acquire(&arm, &LockOwner::default()).unwrap().unwrap();
        let mut plan = suite(0, 1);
        plan.settings.requires = vec![arm];
        let options = LockOptions { dir, limit: None };
        let events = Events::new("r".to_owned(), Arc::new(NullSink));
        let (_stop, mut stops) = watch::channel(None);
        let (control, mut controls) = watch::channel(Vec::new());
        let waiting = wait(&plan, &options, &events, (&mut stops, &mut controls));
        let skip = Control::SkipSuite { suite: plan.id, by: "a person".to_owned() };
        let (locks, ()) = tokio::join!(waiting, async {
            control.send_replace(vec![skip]);
        });
        assert!(locks.unwrap().is_empty());
        lock.release();
    }
}
