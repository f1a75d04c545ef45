//! The state that the guard needs if the runner dies, built from the runner's messages.

use std::collections::{HashMap, VecDeque};
use std::os::fd::OwnedFd;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use rtf_model::{HookId, SuiteId, TestId};
use rtf_process::namespaces::Namespaces;
use rtf_process::task::ProcessStream;

use super::fixture_stop::GuardedFixture;
use super::hook_process::StreamEnds;
use super::message::{GuardMessage, HookSpec, HookStart};
use crate::fixture_values::FixtureValues;
use crate::locks;

/// The state of the run, as far as recovery needs it.
#[derive(Debug, Default)]
pub struct RecoveryState {
    /// The run, once it has started.
    pub run: Option<RunFiles>,
    pub is_finished: bool,
    pub hooks: Vec<GuardedHook>,
    pub tests: RunningTests,
    /// The fixtures' processes.
    pub fixtures: HashMap<i32, GuardedFixture>,
    pub values: HashMap<SuiteId, FixtureValues>,
    pub resources: HashMap<SuiteId, SuiteResources>,
}

#[derive(Debug)]
pub struct RunFiles {
    pub journal: PathBuf,
    pub scratch_dir: PathBuf,
    /// The start of its clock, as the time since the fork.
    pub started: Duration,
}

/// The ids and names of the running tests of each suite.
pub type RunningTests = HashMap<SuiteId, Vec<(TestId, String)>>;

/// Returns the running test of a suite, if there is exactly one.
pub fn only_test(tests: &RunningTests, suite: SuiteId) -> Option<&(TestId, String)> {
    match tests.get(&suite)?.as_slice() {
        [one] => Some(one),
        _ => None,
    }
}

/// The exclusive resources of a suite.
#[derive(Debug, Default)]
pub struct SuiteResources {
    /// Its namespaces, and the process that holds them.
    pub network: Option<(Arc<Namespaces>, i32)>,
    /// Its locks and its leases of ports and ids.
    locks: Vec<OwnedFd>,
}

impl SuiteResources {
    /// Marks its locks as released in order.
    pub fn clear_locks(&self) {
        for lock in &self.locks {
            // Fails for a lease, which is a socket.
            let _ = locks::clear(lock);
        }
    }

    fn add(&mut self, descriptors: Vec<OwnedFd>, holder: Option<i32>) {
        match holder {
            Some(holder) => {
                let namespaces = Namespaces::new(descriptors);
                self.network = namespaces.map(|namespaces| (Arc::new(namespaces), holder));
            }
            None => self.locks.extend(descriptors),
        }
    }
}

#[derive(Debug)]
pub struct GuardedHook {
    pub spec: HookSpec,
    pub status: HookStatus,
    /// How often it was started.
    pub runs: u64,
    pub last_run: Option<FinishedHookRun>,
}

/// A complete run of a hook under the runner.
#[derive(Clone, Debug)]
pub struct FinishedHookRun {
    pub start: HookStart,
    pub started_at: Instant,
    pub finished_at: Instant,
    /// Why the robot may not be in a safe state.
    pub problem: Option<String>,
}

/// The status of a hook since the last test of its suite started.
#[derive(Debug)]
pub enum HookStatus {
    /// It did not run.
    Due,
    Running(RunningHook),
    Done,
    SuiteFinished,
}

/// A hook that the runner has started.
#[derive(Debug)]
pub struct RunningHook {
    pub start: HookStart,
    /// The time of its start.
    pub at: Instant,
    /// Its process, once the runner has reported it.
    pub pid: Option<i32>,
    pub streams: StreamEnds,
}

impl RecoveryState {
    /// Applies a message. `received` holds the descriptors that were received and not
    /// announced yet.
    pub fn apply(&mut self, message: GuardMessage, received: &mut VecDeque<OwnedFd>, now: Instant) {
        use GuardMessage as M;
        match message {
            M::RunStarted { journal, scratch_dir, started } => {
                self.run = Some(RunFiles { journal, scratch_dir, started });
            }
            M::RunFinished => self.is_finished = true,
            M::MessagesLost => self.mark_all_due(),
            M::SuiteResources { suite, descriptors, holder } => {
                let count = descriptors.min(received.len());
                let descriptors = received.drain(..count).collect();
                self.resources.entry(suite).or_default().add(descriptors, holder);
            }
            M::SuiteStarted { hooks, .. } => {
                let due =
                    |spec| GuardedHook { spec, status: HookStatus::Due, runs: 0, last_run: None };
                self.hooks.extend(hooks.into_iter().map(due));
            }
            M::FixtureValues { suite, values } => drop(self.values.insert(suite, values)),
            M::SuiteFinished { suite } => self.finish_suite(suite),
            M::TestStarted { suite, test, name } => {
                self.tests.entry(suite).or_default().push((test, name));
                self.hooks_of(suite).for_each(|hook| hook.status = HookStatus::Due);
            }
            M::TestFinished { suite, test } => {
                self.tests.entry(suite).or_default().retain(|(running, _)| *running != test);
            }
            M::HookStarting(start) => {
                if let Some(hook) = self.hook(start.hook) {
                    hook.runs += 1;
                    let (pid, streams) = (None, Vec::new());
                    hook.status = HookStatus::Running(RunningHook { start, at: now, pid, streams });
                }
            }
            M::HookStarted { hook, pid, streams } => {
                let streams = announced(streams, received);
                if let Some(HookStatus::Running(running)) =
                    self.hook(hook).map(|hook| &mut hook.status)
                {
                    (running.pid, running.streams) = (Some(pid), streams);
                }
            }
            M::HookFinished { hook, problem } => self.finish_hook(hook, problem, now),
            M::FixtureStarted { pid, streams, stop } => {
                let streams = announced(streams, received);
                self.fixtures.insert(pid, GuardedFixture { streams, stop });
            }
            M::FixtureEnded { pid } => drop(self.fixtures.remove(&pid)),
        }
    }

    /// Messages were lost: running a hook once too often is safe.
    fn mark_all_due(&mut self) {
        for hook in self.hooks.iter_mut().filter(|hook| matches!(hook.status, HookStatus::Done)) {
            hook.status = HookStatus::Due;
        }
    }

    /// Keeps the suite's hooks, because the journal may lack their last runs.
    fn finish_suite(&mut self, suite: SuiteId) {
        self.resources.remove(&suite);
        self.tests.remove(&suite);
        self.hooks_of(suite).for_each(|hook| hook.status = HookStatus::SuiteFinished);
    }

    fn hooks_of(&mut self, suite: SuiteId) -> impl Iterator<Item = &mut GuardedHook> {
        self.hooks.iter_mut().filter(move |hook| hook.spec.suite == suite)
    }

    fn hook(&mut self, hook: HookId) -> Option<&mut GuardedHook> {
        self.hooks.iter_mut().find(|known| known.spec.id == hook)
    }

    fn finish_hook(&mut self, hook: HookId, problem: Option<String>, now: Instant) {
        let Some(hook) = self.hook(hook) else { return };
        if let HookStatus::Running(running) = std::mem::replace(&mut hook.status, HookStatus::Done)
        {
            hook.last_run = Some(FinishedHookRun {
                start: running.start,
                started_at: running.at,
                finished_at: now,
                problem,
            });
        }
    }
}

fn announced(streams: Vec<ProcessStream>, received: &mut VecDeque<OwnedFd>) -> StreamEnds {
    streams.into_iter().map_while(|stream| Some((stream, received.pop_front()?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hook(id: u32, suite: u32) -> HookSpec {
        HookSpec {
            id: HookId(id),
            suite: SuiteId(suite),
            name: "park".to_owned(),
            is_abort_hook: true,
            command: vec!["true".to_owned()],
            env: Vec::new(),
            working_dir: PathBuf::new(),
            limit: Duration::from_secs(1),
            plugin: None,
        }
    }

    fn hook_starting(hook: u32) -> GuardMessage {
        GuardMessage::HookStarting(HookStart {
            hook: HookId(hook),
            scope: String::new(),
            trigger: rtf_model::Trigger::Failure,
            reason: String::new(),
            test: None,
        })
    }

    /// Returns the hooks that are due, and the names of the running tests.
    fn after(messages: impl IntoIterator<Item = GuardMessage>) -> (Vec<u32>, Vec<String>) {
        let mut state = RecoveryState::default();
        for message in messages {
            state.apply(message, &mut VecDeque::new(), Instant::now());
        }
        let due = state.hooks.iter().filter(|hook| matches!(hook.status, HookStatus::Due));
        let due = due.map(|hook| hook.spec.id.0).collect();
        let mut tests: Vec<_> = state.tests.into_values().flatten().map(|(_, name)| name).collect();
        tests.sort();
        (due, tests)
    }

    #[test]
    fn suites_have_separate_tests_and_hooks() {
        let [one, two] = [0, 1].map(SuiteId);
        let suite = |suite: SuiteId| GuardMessage::SuiteStarted {
            suite,
            hooks: vec![hook(suite.0, suite.0)],
        };
        let test = |suite: SuiteId, name: &str| {
            let (test, name) = (TestId(suite.0), name.to_owned());
            GuardMessage::TestStarted { suite, test, name }
        };
        let parked = |hook: u32| {
            [hook_starting(hook), GuardMessage::HookFinished { hook: HookId(hook), problem: None }]
        };
        let both = || vec![suite(one), suite(two), test(one, "arm"), test(two, "hand")];
        assert_eq!(after(both()), (vec![0, 1], vec!["arm".to_owned(), "hand".to_owned()]));
        // A test makes the hooks of its suite due, and no others.
        let mut messages = both();
        messages.extend(parked(0).into_iter().chain(parked(1)));
        messages.extend([
            GuardMessage::TestFinished { suite: two, test: TestId(1) },
            test(two, "grip"),
        ]);
        assert_eq!(after(messages), (vec![1], vec!["arm".to_owned(), "grip".to_owned()]));
        let mut messages = both();
        messages.push(GuardMessage::SuiteFinished { suite: one });
        assert_eq!(after(messages), (vec![1], vec!["hand".to_owned()]));
    }
}
