//! Waiting until a suite has all the locks that it requires.

use std::path::PathBuf;
use std::time::Duration;

use rtf_model::EventKind;
use tokio::sync::watch;
use tokio::time::Instant;

use super::{Held, Lock, Locks, Owner, orphans};
use crate::run::{Control, Controls, Events, Stop};
use rtf_plan::plan::{RequiredResource, SuitePlan};

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
/// names, so that no two wait for each other. A request to stop, or to skip the
/// suite, ends the wait: then nothing is begun, and nothing is locked.
///
/// # Errors
/// A sentence: what is held by whom when the limit is reached, or what the
/// system refused.
pub async fn wait(
    suite: &SuitePlan,
    options: &LockOptions,
    events: &Events,
    (stops, controls): (&mut watch::Receiver<Option<Stop>>, &mut Controls),
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
            if stops.borrow().is_some() || is_skipped(suite, controls) {
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
                Ok(()) = controls.changed() => {}
            }
        }
    }
    for owner in taken.iter().filter_map(|lock: &Lock| lock.abandoned.as_ref()) {
        orphans::stop(owner, events).await;
    }
    Ok(taken)
}

fn is_skipped(suite: &SuitePlan, controls: &Controls) -> bool {
    let skips = |control: &Control| matches!(control, Control::SkipSuite { suite: of, .. } if *of == suite.id);
    controls.borrow().iter().any(skips)
}

fn given_up(resource: &RequiredResource, held: &[Held], waited: Duration) -> String {
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
        scope: format!("{run}.{}.", suite.id),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use rtf_model::Event;

    use super::*;
    use crate::run::Sink;
    use crate::run::machine::tests::world::suite;

    #[derive(Debug)]
    struct Nothing;

    impl Sink for Nothing {
        fn emit(&self, _: Event) {}
    }

    /// Whoever waits for a robot for hours does not want to stop the whole run.
    #[tokio::test]
    async fn a_suite_that_is_skipped_waits_no_longer() {
        let temp = tempfile::tempdir().unwrap();
        let folder = temp.path().join("locks");
        let arm = RequiredResource { name: "arm".to_owned(), slots: 1 };
        let taken = Locks::open(&folder).unwrap().take(&arm, &Owner::default()).unwrap().unwrap();
        let plan = SuitePlan { requires: vec![arm], ..suite(0, 1) };
        let options = LockOptions { folder, limit: None };
        let events = Events::new("r".to_owned(), Arc::new(Nothing));
        let (_stop, mut stops) = watch::channel(None);
        let (control, mut controls) = watch::channel(Vec::new());
        let waiting = wait(&plan, &options, &events, (&mut stops, &mut controls));
        let skip = Control::SkipSuite { suite: plan.id, by: "a person".to_owned() };
        let (locks, ()) = tokio::join!(waiting, async {
            control.send_replace(vec![skip]);
        });
        assert!(locks.unwrap().is_empty());
        taken.release();
    }
}
