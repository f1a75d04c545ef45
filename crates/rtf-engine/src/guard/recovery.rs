//! The guard's work after the death of the runner: ends its tests, runs the abort hooks, stops
//! the fixtures, kills everything that is left, and closes the journal.

use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rtf_model::{EventKind, LeakedProcess};
use rtf_process::{prepare_process, tree};
use rustix::event::{PollFd, PollFlags, poll};

use crate::fixture_values::FixtureValues;

use super::fixture_stop::{GuardedFixture, is_kill_requested, stop_fixtures};
use super::hook_run::{self, HookContext};
use super::journal_close::{self, FinishedHook, MissingEvents, TimedEvent};
use super::message::HookSpec;
use super::recovery_state::{
    GuardedHook, HookStatus, RecoveryState, RunFiles, SuiteResources, only_test,
};
use super::unix::GuardSignals;

/// The limit for the end of killed processes. One that hangs in the kernel, for example in
/// a driver, is reported and left.
pub(super) const SWEEP_LIMIT: Duration = Duration::from_secs(5);

/// How long tests may take to end after SIGTERM. Hooks wait for it.
const TERM_GRACE: Duration = Duration::from_secs(1);

/// The host that stops processes of fixtures, as `/proc/PID/comm` shows it.
const FAULTS_PROGRAM: &str = "rtf-host-faults";

/// The result of a run whose runner died.
#[derive(Debug)]
pub struct Recovery {
    /// How the runner ended.
    pub reason: String,
    pub hooks: Vec<RecoveredHook>,
    /// The runner's processes that were still alive, and were killed.
    pub left: Vec<LeakedProcess>,
    /// The journal, if the run had started.
    pub journal: Option<PathBuf>,
    /// Why the journal could not be closed.
    pub problem: Option<std::io::Error>,
}

#[derive(Debug)]
pub struct RecoveredHook {
    pub name: String,
    /// Why the robot may not be in a safe state.
    pub problem: Option<String>,
}

/// Recovers from the death of the runner.
pub fn recover(
    state: RecoveryState,
    reason: String,
    mut signals: GuardSignals,
    forked: Instant,
) -> Recovery {
    // The guard starts processes only now: its descriptors must not leak into hooks.
    let _ = prepare_process();
    // No hook runs in parallel with a test, or with an injected fault.
    if !is_kill_requested(&mut signals) {
        tree::terminate_owned("test ", TERM_GRACE);
    }
    let mut left = tree::kill_owned("test ");
    if tree::kill_program(FAULTS_PROGRAM) {
        tree::continue_all();
    }
    let mut fixtures = state.fixtures;
    drain_streams(fixtures.values_mut().flat_map(GuardedFixture::take_streams).collect());
    let run_dir = state.run.as_ref().and_then(|run| run.journal.parent());
    let hook_reason = format!("the runner died: {reason}");
    let finished_hooks = finished_hooks(&state.hooks);
    let mut hooks: Vec<_> = state.hooks.iter().filter_map(failed_under_runner).collect();
    let (mut events, no_values) = (Vec::new(), FixtureValues::default());
    for hook in hooks_to_run(state.hooks) {
        let mut spec = with_attachments_dir(hook.spec, run_dir);
        let values = state.values.get(&spec.suite).unwrap_or(&no_values);
        let resolved = spec.resolve(values);
        let network = state.resources.get(&spec.suite).and_then(|held| held.network.as_ref());
        let network = network.map(|(namespaces, _)| namespaces);
        let test = only_test(&state.tests, spec.suite);
        let context = HookContext { reason: &hook_reason, test, network, resolved };
        let (problem, more) = hook_run::run(&spec, hook.status, &context, &mut signals);
        let problem = problem.map(|problem| values.mask_text(problem));
        hooks.push(RecoveredHook { name: spec.name, problem });
        let masked = |event: TimedEvent| TimedEvent { kind: values.mask(event.kind), ..event };
        events.extend(more.into_iter().map(masked));
    }
    stop_fixtures(fixtures, &mut signals);
    // The holders of namespaces belong to rtf: they are not reported.
    for (_, holder) in state.resources.values().filter_map(|held| held.network.as_ref()) {
        tree::kill_child(*holder);
    }
    tree::add_new(&mut left, tree::kill_until_none_is_left(SWEEP_LIMIT));
    state.resources.values().for_each(SuiteResources::clear_locks);
    let died = EventKind::RunnerDied { reason: reason.clone(), leaked: left.clone() };
    events.push(TimedEvent { at: Instant::now(), kind: died });
    let (journal, problem) = match state.run {
        Some(RunFiles { journal, scratch_dir, started }) => {
            let missing = MissingEvents { finished_hooks, events };
            let problem = journal_close::close(&journal, forked + started, missing).err();
            let _ = std::fs::remove_dir_all(scratch_dir);
            (Some(journal), problem)
        }
        None => (None, None),
    };
    Recovery { reason, hooks, left, journal, problem }
}

/// Returns a hook that failed before the runner died.
fn failed_under_runner(hook: &GuardedHook) -> Option<RecoveredHook> {
    match (&hook.status, &hook.last_run) {
        (HookStatus::Done | HookStatus::SuiteFinished, Some(run)) if run.problem.is_some() => {
            Some(RecoveredHook { name: hook.spec.name.clone(), problem: run.problem.clone() })
        }
        _ => None,
    }
}

/// Returns the last complete run of each hook under the runner.
fn finished_hooks(hooks: &[GuardedHook]) -> Vec<FinishedHook> {
    let finished = hooks.iter().filter_map(|hook| Some((hook, hook.last_run.clone()?)));
    finished
        .map(|(hook, run)| {
            let is_running = matches!(hook.status, HookStatus::Running(_));
            let problem = run.problem;
            FinishedHook {
                hook: hook.spec.id,
                number: hook.runs - u64::from(is_running),
                started: TimedEvent { at: run.started_at, kind: run.start.event() },
                finished: TimedEvent {
                    at: run.finished_at,
                    kind: EventKind::HookFinished { hook: hook.spec.id, problem },
                },
            }
        })
        .collect()
}

/// Returns the running hooks, then the abort hooks that did not run since the last test of
/// their suite started.
fn hooks_to_run(mut hooks: Vec<GuardedHook>) -> Vec<GuardedHook> {
    hooks.retain(|hook| match hook.status {
        HookStatus::Running(_) => true,
        HookStatus::Due => hook.spec.is_abort_hook,
        HookStatus::Done | HookStatus::SuiteFinished => false,
    });
    hooks.sort_by_key(|hook| matches!(hook.status, HookStatus::Due));
    hooks
}

fn with_attachments_dir(mut hook: HookSpec, run_dir: Option<&Path>) -> HookSpec {
    if let (Some(plugin), Some(run_dir)) = (&mut hook.plugin, run_dir) {
        let dir = run_dir.join(format!("attachments/hook-{}/guard", hook.id));
        plugin.attachments_dir = Some(dir.to_string_lossy().into_owned());
    }
    hook
}

/// Reads and discards the output of fixtures while hooks run: otherwise a driver blocks
/// when its log fills the pipe.
fn drain_streams(mut ends: Vec<OwnedFd>) {
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
    // If the thread cannot be started, the streams are closed, and the hooks run.
    let _ = std::thread::Builder::new().name("rtf-outputs".to_owned()).spawn(read);
}
