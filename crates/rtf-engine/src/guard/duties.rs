//! What the guard would have to do if the runner died now.

use std::collections::{HashMap, VecDeque};
use std::os::fd::OwnedFd;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use rtf_model::{HookId, SuiteId, TestId};

use crate::locks;
use rtf_process::namespaces::Namespaces;
use rtf_process::task::ProcessStream;

use super::note::{Hook, HookBegins, Note};

/// Ends of a process's streams.
pub type Streams = Vec<(ProcessStream, OwnedFd)>;

/// All that the runner has told and not taken back.
#[derive(Debug, Default)]
pub struct Duties {
    /// The run, once it has begun.
    pub run: Option<RunFiles>,
    /// Whether the run is over.
    pub over: bool,
    /// The hooks of the suites that run.
    pub hooks: Vec<Duty>,
    /// The tests that run.
    pub tests: Tests,
    /// The streams of the fixtures' processes.
    pub fixtures: HashMap<i32, Streams>,
    /// What the suites that run have for themselves.
    pub held: HashMap<SuiteId, Held>,
}

/// The files of a run.
#[derive(Debug)]
pub struct RunFiles {
    /// Its journal.
    pub journal: PathBuf,
    /// Its folder for files that are gone when it is over.
    pub scratch: PathBuf,
    /// When its clock started, since the fork.
    pub started: Duration,
}

/// The tests of each suite that run: their ids and names.
pub type Tests = HashMap<SuiteId, Vec<(TestId, String)>>;

/// The test that a suite's hooks are about: the one that runs, if it is only one.
#[must_use]
pub fn only_test(tests: &Tests, suite: SuiteId) -> Option<&(TestId, String)> {
    match tests.get(&suite)?.as_slice() {
        [one] => Some(one),
        _ => None,
    }
}

/// What a suite has for itself.
#[derive(Debug, Default)]
pub struct Held {
    /// Its namespaces, and the process that holds them.
    pub network: Option<(Arc<Namespaces>, i32)>,
    /// What keeps its numbers from other runs.
    leases: Vec<OwnedFd>,
}

impl Held {
    /// Says in its locks that they are given back in order.
    pub fn clear_locks(&self) {
        for lease in &self.leases {
            // Numbers are no locks, and refuse it.
            let _ = locks::clear(lease);
        }
    }

    fn add(&mut self, descriptors: Vec<OwnedFd>, holder: Option<i32>) {
        match holder {
            Some(holder) => {
                let namespaces = Namespaces::new(descriptors);
                self.network = namespaces.map(|namespaces| (Arc::new(namespaces), holder));
            }
            None => self.leases.extend(descriptors),
        }
    }
}

/// A hook, and what became of it.
#[derive(Debug)]
pub struct Duty {
    /// The hook.
    pub hook: Hook,
    /// What became of it.
    pub state: State,
    /// How often it was begun.
    pub runs: u64,
    /// Its last run that came to an end.
    pub last: Option<Run>,
}

/// A run of a hook that came to its end.
#[derive(Clone, Debug)]
pub struct Run {
    /// What the runner told before it.
    pub begins: HookBegins,
    /// When it began and ended.
    pub times: [Instant; 2],
    /// Why the robot may not be in a safe state.
    pub problem: Option<String>,
}

/// What became of a hook since the last test of its suite began.
#[derive(Debug)]
pub enum State {
    /// It did not run.
    Due,
    /// It runs.
    Begun(Begun),
    /// It ran.
    Done,
    /// Its suite is over.
    Over,
}

/// A hook that was begun by the runner.
#[derive(Debug)]
pub struct Begun {
    /// What the runner told before it started it.
    pub begins: HookBegins,
    /// When that was.
    pub at: Instant,
    /// Its process, once the runner had told.
    pub pid: Option<i32>,
    /// Its streams.
    pub streams: Streams,
}

impl Duties {
    /// Takes in what the runner told. `received` are descriptors that came and
    /// were not announced yet.
    pub fn take(&mut self, note: Note, received: &mut VecDeque<OwnedFd>, now: Instant) {
        match note {
            Note::RunBegins { journal, scratch, started } => {
                self.run = Some(RunFiles { journal, scratch, started });
            }
            Note::RunEnds => self.over = true,
            Note::Missed => self.miss(),
            Note::SuiteHolds { suite, descriptors, holder } => {
                let came = descriptors.min(received.len());
                let came = received.drain(..came).collect();
                self.held.entry(suite).or_default().add(came, holder);
            }
            Note::SuiteBegins { hooks, .. } => {
                let due = |hook| Duty { hook, state: State::Due, runs: 0, last: None };
                self.hooks.extend(hooks.into_iter().map(due));
            }
            // The journal may not know yet how they ended.
            Note::SuiteEnds { suite } => {
                self.held.remove(&suite);
                self.tests.remove(&suite);
                for duty in self.hooks.iter_mut().filter(|duty| duty.hook.suite == suite) {
                    duty.state = State::Over;
                }
                // Without hooks, the runner does not tell of fixtures that end.
                if self.hooks.iter().all(|duty| matches!(duty.state, State::Over)) {
                    self.fixtures.clear();
                }
            }
            Note::TestBegins { suite, test, name } => {
                self.tests.entry(suite).or_default().push((test, name));
                for duty in self.hooks.iter_mut().filter(|duty| duty.hook.suite == suite) {
                    duty.state = State::Due;
                }
            }
            Note::TestEnds { suite, test } => {
                self.tests.entry(suite).or_default().retain(|(running, _)| *running != test);
            }
            Note::HookBegins(begins) => {
                if let Some(duty) = self.duty(begins.hook) {
                    duty.runs += 1;
                    let (pid, streams) = (None, Vec::new());
                    duty.state = State::Begun(Begun { begins, at: now, pid, streams });
                }
            }
            Note::HookStarted { hook, pid, streams } => {
                let streams = announced(streams, received);
                if let Some(begun) = self.begun(hook) {
                    begun.pid = Some(pid);
                    begun.streams = streams;
                }
            }
            Note::HookEnds { hook, problem } => self.end(hook, problem, now),
            Note::FixtureStarted { pid, streams } => {
                self.fixtures.insert(pid, announced(streams, received));
            }
            Note::FixtureEnds { pid } => drop(self.fixtures.remove(&pid)),
        }
    }

    /// What happened meanwhile is not known: parking once more is the safe side.
    fn miss(&mut self) {
        for duty in self.hooks.iter_mut().filter(|duty| matches!(duty.state, State::Done)) {
            duty.state = State::Due;
        }
    }

    fn duty(&mut self, hook: HookId) -> Option<&mut Duty> {
        self.hooks.iter_mut().find(|duty| duty.hook.id == hook)
    }

    fn end(&mut self, hook: HookId, problem: Option<String>, now: Instant) {
        let Some(duty) = self.duty(hook) else { return };
        if let State::Begun(begun) = std::mem::replace(&mut duty.state, State::Done) {
            duty.last = Some(Run { begins: begun.begins, times: [begun.at, now], problem });
        }
    }

    fn begun(&mut self, hook: HookId) -> Option<&mut Begun> {
        match &mut self.duty(hook)?.state {
            State::Begun(begun) => Some(begun),
            State::Due | State::Done | State::Over => None,
        }
    }
}

fn announced(names: Vec<ProcessStream>, received: &mut VecDeque<OwnedFd>) -> Streams {
    names.into_iter().map_while(|name| Some((name, received.pop_front()?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hook(id: u32, suite: u32) -> Hook {
        Hook {
            id: HookId(id),
            suite: SuiteId(suite),
            name: "park".to_owned(),
            aborts: true,
            command: vec!["true".to_owned()],
            env: Vec::new(),
            folder: PathBuf::new(),
            limit: Duration::from_secs(1),
            plugin: None,
        }
    }

    fn begins(hook: u32) -> Note {
        Note::HookBegins(HookBegins {
            hook: HookId(hook),
            scope: String::new(),
            trigger: rtf_model::Trigger::Failure,
            reason: String::new(),
            test: None,
        })
    }

    /// Which hooks are due, and the names of the tests that run.
    fn told(notes: impl IntoIterator<Item = Note>) -> (Vec<u32>, Vec<String>) {
        let mut duties = Duties::default();
        for note in notes {
            duties.take(note, &mut VecDeque::new(), Instant::now());
        }
        let due = duties.hooks.iter().filter(|duty| matches!(duty.state, State::Due));
        let due = due.map(|duty| duty.hook.id.0).collect();
        let mut tests: Vec<_> =
            duties.tests.into_values().flatten().map(|(_, name)| name).collect();
        tests.sort();
        (due, tests)
    }

    #[test]
    fn each_suite_has_its_own_test_and_its_own_hooks() {
        let [one, two] = [0, 1].map(SuiteId);
        let suite =
            |suite: SuiteId| Note::SuiteBegins { suite, hooks: vec![hook(suite.0, suite.0)] };
        let test = |suite: SuiteId, name: &str| {
            let (test, name) = (TestId(suite.0), name.to_owned());
            Note::TestBegins { suite, test, name }
        };
        let parked =
            |hook: u32| [begins(hook), Note::HookEnds { hook: HookId(hook), problem: None }];
        let both = || vec![suite(one), suite(two), test(one, "arm"), test(two, "hand")];
        assert_eq!(told(both()), (vec![0, 1], vec!["arm".to_owned(), "hand".to_owned()]));
        // A test makes its own suite's hooks due again, and no others.
        let mut notes = both();
        notes.extend(parked(0).into_iter().chain(parked(1)));
        notes.extend([Note::TestEnds { suite: two, test: TestId(1) }, test(two, "grip")]);
        assert_eq!(told(notes), (vec![1], vec!["arm".to_owned(), "grip".to_owned()]));
        let mut notes = both();
        notes.push(Note::SuiteEnds { suite: one });
        assert_eq!(told(notes), (vec![1], vec!["hand".to_owned()]));
    }

    #[test]
    fn fixtures_of_a_suite_without_hooks_are_kept_as_long_as_there_are_hooks() {
        let mut duties = Duties::default();
        let mut take = |note| {
            duties.take(note, &mut VecDeque::new(), Instant::now());
            duties.fixtures.len()
        };
        for suite in [0, 1] {
            take(Note::SuiteBegins { suite: SuiteId(suite), hooks: vec![hook(suite, suite)] });
        }
        take(Note::FixtureStarted { pid: 1, streams: Vec::new() });
        assert_eq!(take(Note::SuiteEnds { suite: SuiteId(0) }), 1);
        assert_eq!(take(Note::SuiteEnds { suite: SuiteId(1) }), 0);
    }
}
