//! What the guard would have to do if the runner died now.

use std::collections::{HashMap, VecDeque};
use std::os::fd::OwnedFd;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use rtf_model::{HookId, TestId};

use super::note::{Hook, HookBegins, Kept, Note};

/// Ends of a process's streams.
pub type Streams = Vec<(Kept, OwnedFd)>;

/// All that the runner has told and not taken back.
#[derive(Debug, Default)]
pub struct Duties {
    /// The run's journal, and when its clock started, since the fork.
    pub run: Option<(PathBuf, Duration)>,
    /// Whether the run is over.
    pub over: bool,
    /// The hooks of the suites that run.
    pub hooks: Vec<Duty>,
    /// The test that runs.
    pub test: Option<(TestId, String)>,
    /// The streams of the fixtures' processes.
    pub fixtures: HashMap<i32, Streams>,
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

/// What became of a hook since the last test began.
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
            Note::RunBegins { journal, started } => self.run = Some((journal, started)),
            Note::RunEnds => self.over = true,
            Note::SuiteBegins { hooks, .. } => {
                let due = |hook| Duty { hook, state: State::Due, runs: 0, last: None };
                self.hooks.extend(hooks.into_iter().map(due));
            }
            // The journal may not know yet how they ended.
            Note::SuiteEnds { suite } => {
                for duty in self.hooks.iter_mut().filter(|duty| duty.hook.suite == suite) {
                    duty.state = State::Over;
                }
            }
            Note::TestBegins { test, name } => {
                self.test = Some((test, name));
                let of_suite = |duty: &&mut Duty| !matches!(duty.state, State::Over);
                for duty in self.hooks.iter_mut().filter(of_suite) {
                    duty.state = State::Due;
                }
            }
            Note::TestEnds => self.test = None,
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

fn announced(names: Vec<Kept>, received: &mut VecDeque<OwnedFd>) -> Streams {
    names.into_iter().map_while(|name| Some((name, received.pop_front()?))).collect()
}
