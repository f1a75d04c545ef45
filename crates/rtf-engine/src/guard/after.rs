//! What is done when the runner has died: stop its test, park the robot, stop
//! everything, close the journal.

use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rtf_model::{EventKind, LeakedProcess};
use rustix::event::{PollFd, PollFlags, poll};

use super::closing::{self, Ended, Happened, Told};
use super::duties::{Duties, Duty, Held, RunFiles, State, only_test};
use super::hook::{self, Why};
use super::unix::Signals;
use rtf_process::{prepare_process, tree};

/// Processes that were killed are waited for this long. One that hangs in the
/// kernel (a device that does not answer) is named, and left.
pub(super) const SWEEP_LIMIT: Duration = Duration::from_secs(5);

/// What came of a run whose runner died.
#[derive(Debug)]
pub struct Died {
    /// How the runner ended.
    pub reason: String,
    /// The hooks that were run, or were let come to their end.
    pub hooks: Vec<Parked>,
    /// What the runner had started, was still alive, and was killed.
    pub left: Vec<LeakedProcess>,
    /// The journal, when the run had begun.
    pub journal: Option<PathBuf>,
    /// Why the journal could not be closed.
    pub problem: Option<std::io::Error>,
}

/// A hook that was run, or let come to its end.
#[derive(Debug)]
pub struct Parked {
    /// Its name.
    pub name: String,
    /// Why the robot may not be in a safe state.
    pub problem: Option<String>,
}

/// Does it.
pub fn finish(duties: Duties, reason: String, mut signals: Signals, forked: Instant) -> Died {
    // What the guard inherited is not for hooks; it starts processes only now.
    let _ = prepare_process();
    // No hook runs beside a test.
    let mut left = tree::kill_owned("test ");
    keep_reading(duties.fixtures.into_values().flatten().map(|(_, end)| end).collect());
    let folder = duties.run.as_ref().and_then(|run| run.journal.parent());
    let words = format!("the runner died: {reason}");
    let (mut parked, mut happened) = (Vec::new(), Vec::new());
    let ended = ended(&duties.hooks);
    for duty in &duties.hooks {
        if let (State::Done | State::Over, Some(run)) = (&duty.state, &duty.last)
            && run.problem.is_some()
        {
            let name = duty.hook.name.clone();
            parked.push(Parked { name, problem: run.problem.clone() });
        }
    }
    for duty in in_order(duties.hooks) {
        let hook = with_folder(duty.hook, folder);
        let network = duties.held.get(&hook.suite).and_then(|held| held.network.as_ref());
        let network = network.map(|(namespaces, _)| namespaces);
        let test = only_test(&duties.tests, hook.suite);
        let why = Why { reason: &words, test, network };
        let ran = hook::run(&hook, duty.state, &why, &mut signals);
        parked.push(Parked { name: hook.name, problem: ran.problem });
        happened.extend(ran.happened);
    }
    // The namespaces' holders are not what a suite left: they are rtf's own.
    for (_, holder) in duties.held.values().filter_map(|held| held.network.as_ref()) {
        tree::kill_child(*holder);
    }
    tree::add_new(&mut left, tree::kill_until_none_is_left(SWEEP_LIMIT));
    duties.held.values().for_each(Held::clear_locks);
    let end = EventKind::RunnerDied { reason: reason.clone(), leaked: left.clone() };
    happened.push(Happened { at: Instant::now(), kind: end });
    let (journal, problem) = match duties.run {
        Some(RunFiles { journal, scratch, started }) => {
            let told = Told { ended, happened };
            let problem = closing::close(&journal, forked + started, told).err();
            let _ = std::fs::remove_dir_all(scratch);
            (Some(journal), problem)
        }
        None => (None, None),
    };
    Died { reason, hooks: parked, left, journal, problem }
}

/// What the runner told of hooks that came to their end.
fn ended(hooks: &[Duty]) -> Vec<Ended> {
    let over = hooks.iter().filter_map(|duty| Some((duty, duty.last.clone()?)));
    over.map(|(duty, run)| {
        let [began, ended] = run.times;
        let begun = matches!(duty.state, State::Begun(_));
        Ended {
            hook: duty.hook.id,
            number: duty.runs - u64::from(begun),
            started: Happened { at: began, kind: run.begins.event() },
            finished: Happened {
                at: ended,
                kind: EventKind::HookFinished { hook: duty.hook.id, problem: run.problem },
            },
        }
    })
    .collect()
}

/// The hooks that have begun, then the abort hooks that did not run since the
/// last test of their suite began.
fn in_order(mut hooks: Vec<Duty>) -> Vec<Duty> {
    hooks.retain(|duty| match duty.state {
        State::Begun(_) => true,
        State::Due => duty.hook.aborts,
        State::Done | State::Over => false,
    });
    hooks.sort_by_key(|duty| matches!(duty.state, State::Due));
    hooks
}

fn with_folder(mut hook: super::note::Hook, run: Option<&Path>) -> super::note::Hook {
    if let (Some(plugin), Some(run)) = (&mut hook.plugin, run) {
        let folder = run.join(format!("attachments/hook-{}/guard", hook.id));
        plugin.attachments_dir = Some(folder.to_string_lossy().into_owned());
    }
    hook
}

/// Reads and drops what fixtures print and say while hooks run: a driver whose
/// log nobody reads would be stopped by its next line.
fn keep_reading(mut ends: Vec<OwnedFd>) {
    let read = move || {
        let mut bytes = vec![0; 64 * 1024];
        while !ends.is_empty() {
            let mut fds: Vec<_> = ends.iter().map(|end| PollFd::new(end, PollFlags::IN)).collect();
            if poll(&mut fds, None).is_err() {
                continue;
            }
            let ready: Vec<bool> = fds.iter().map(|fd| !fd.revents().is_empty()).collect();
            let mut ready = ready.into_iter();
            ends.retain(|end| {
                !ready.next().unwrap_or(false)
                    || rustix::io::read(end, &mut bytes[..]).is_ok_and(|read| read > 0)
            });
        }
    };
    // Without the thread the ends stay open no longer; the hooks run nevertheless.
    let _ = std::thread::Builder::new().name("rtf-outputs".to_owned()).spawn(read);
}
