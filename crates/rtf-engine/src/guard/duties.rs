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
    /// Whether a host was asked to run the plug-in.
    pub asked: bool,
}

impl Duties {
    /// Takes in what the runner told. `received` are descriptors that came and
    /// were not announced yet.
    pub fn take(&mut self, note: Note, received: &mut VecDeque<OwnedFd>, now: Instant) {
        match note {
            Note::RunBegins { journal, started } => self.run = Some((journal, started)),
            Note::RunEnds => self.over = true,
            Note::SuiteBegins { hooks, .. } => {
                self.hooks.extend(hooks.into_iter().map(|hook| Duty { hook, state: State::Due }));
            }
            Note::SuiteEnds { suite } => self.hooks.retain(|duty| duty.hook.suite != suite),
            Note::TestBegins { test, name } => {
                self.test = Some((test, name));
                for duty in &mut self.hooks {
                    duty.state = State::Due;
                }
            }
            Note::TestEnds => self.test = None,
            Note::HookBegins(begins) => {
                let hook = begins.hook;
                let (pid, streams, asked) = (None, Vec::new(), false);
                let begun = Begun { begins, at: now, pid, streams, asked };
                self.set(hook, State::Begun(begun));
            }
            Note::HookStarted { hook, pid, streams } => {
                let streams = announced(streams, received);
                if let Some(begun) = self.begun(hook) {
                    begun.pid = Some(pid);
                    begun.streams = streams;
                }
            }
            Note::HookAsked { hook } => {
                if let Some(begun) = self.begun(hook) {
                    begun.asked = true;
                }
            }
            Note::HookEnds { hook } => self.set(hook, State::Done),
            Note::FixtureStarted { pid, streams } => {
                self.fixtures.insert(pid, announced(streams, received));
            }
            Note::FixtureEnds { pid } => drop(self.fixtures.remove(&pid)),
        }
    }

    fn set(&mut self, hook: HookId, state: State) {
        if let Some(duty) = self.hooks.iter_mut().find(|duty| duty.hook.id == hook) {
            duty.state = state;
        }
    }

    fn begun(&mut self, hook: HookId) -> Option<&mut Begun> {
        let duty = self.hooks.iter_mut().find(|duty| duty.hook.id == hook)?;
        match &mut duty.state {
            State::Begun(begun) => Some(begun),
            State::Due | State::Done => None,
        }
    }
}

fn announced(names: Vec<Kept>, received: &mut VecDeque<OwnedFd>) -> Streams {
    names.into_iter().map_while(|name| Some((name, received.pop_front()?))).collect()
}
