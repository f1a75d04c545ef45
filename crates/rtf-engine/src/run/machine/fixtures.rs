//! All fixtures of a suite: which may be set up or torn down now.
//!
//! A fixture is set up when all that it depends on are ready, and torn down
//! when all that depend on it are gone. Those that do not depend on each other
//! go at the same time.

use rtf_model::TestId;
use rtf_model::protocol::{Request, Subscription};

use super::fixture::{FixtureRun, State};
use super::io::{HostId, Probes};
use super::suite::Context;
use rtf_plan::plan::SuitePlan;

/// The fixtures of a suite, in the order of its plan.
#[derive(Debug)]
pub struct Fixtures<'p> {
    runs: Vec<FixtureRun<'p>>,
    restarts: Vec<u32>,
}

impl<'p> Fixtures<'p> {
    pub fn new(plan: &'p SuitePlan) -> Self {
        let count = plan.fixtures.len();
        let runs = (0..count).map(|place| FixtureRun::new(plan, place)).collect();
        Self { runs, restarts: vec![0; count] }
    }

    pub fn get(&mut self, place: usize) -> &mut FixtureRun<'p> {
        &mut self.runs[place]
    }

    /// The place of the fixture that this process belongs to.
    pub fn place_of(&self, host: HostId) -> Option<usize> {
        self.runs.iter().position(|fixture| fixture.host() == Some(host))
    }

    fn any(&self, states: &[State]) -> bool {
        self.runs.iter().any(|fixture| states.contains(&fixture.state()))
    }

    pub fn any_unwell(&self) -> bool {
        self.any(&[State::Unwell])
    }

    pub fn any_stopping(&self) -> bool {
        self.any(&[State::Stopping, State::Ending])
    }

    pub fn all_ready(&self) -> bool {
        self.runs.iter().all(|fixture| fixture.state() == State::Ready)
    }

    pub fn all_stopped(&self) -> bool {
        self.runs.iter().all(|fixture| fixture.state() == State::Stopped)
    }

    pub fn any_started(&self) -> bool {
        self.runs.iter().any(|fixture| fixture.starts() > 0)
    }

    /// Sets up every fixture whose turn it is; false when there is none.
    pub fn start_next(&mut self, cx: &mut Context<'_>) -> bool {
        let ready: Vec<bool> = self.runs.iter().map(|f| f.state() == State::Ready).collect();
        let mut started = false;
        for fixture in self.runs.iter_mut().filter(|f| f.state() == State::Stopped) {
            if fixture.plan().depends.iter().all(|place| ready[*place]) {
                fixture.start(cx);
                started = true;
            }
        }
        started
    }

    /// Tears down what is unwell and all that depends on it, as far as it is
    /// its turn.
    pub fn stop_unwell(&mut self, cx: &mut Context<'_>) {
        let unwell = |fixture: &FixtureRun<'_>| fixture.state() == State::Unwell;
        let mut doomed: Vec<bool> = self.runs.iter().map(unwell).collect();
        // A chain of dependencies is no longer than the list.
        for _ in 0..self.runs.len() {
            for place in 0..self.runs.len() {
                let depends = &self.runs[place].plan().depends;
                doomed[place] |= depends.iter().any(|needed| doomed[*needed]);
            }
        }
        self.stop(&doomed, cx);
    }

    /// Tears down everything, as far as it is its turn.
    pub fn stop_all(&mut self, cx: &mut Context<'_>) {
        self.stop(&vec![true; self.runs.len()], cx);
    }

    fn stop(&mut self, doomed: &[bool], cx: &mut Context<'_>) {
        // One that is gone at once may let the next one go: look again.
        loop {
            let due = |place: &usize| doomed[*place] && self.may_stop(*place);
            let due: Vec<usize> = (0..self.runs.len()).rev().filter(due).collect();
            if due.is_empty() {
                return;
            }
            for place in due {
                self.runs[place].stop(cx);
            }
        }
    }

    fn may_stop(&self, place: usize) -> bool {
        let there = [State::Waiting, State::Starting, State::Ready, State::Unwell];
        let gone = |fixture: &FixtureRun<'_>| fixture.state() == State::Stopped;
        there.contains(&self.runs[place].state())
            && self.runs.iter().all(|other| !other.plan().depends.contains(&place) || gone(other))
    }

    /// Kills everything, the last fixture first.
    pub fn kill_all(&mut self, why: Option<&str>, cx: &mut Context<'_>) {
        self.runs.iter_mut().rev().for_each(|fixture| fixture.kill(why, cx));
    }

    /// The suite's limit has passed: a problem of those that are being torn down, or of
    /// all that are there.
    pub fn note_late(&mut self, reason: &str, all: bool) {
        for fixture in &mut self.runs {
            match fixture.state() {
                State::Stopping | State::Ending => fixture.note_late(reason),
                State::Ready | State::Unwell if all => fixture.note_late(reason),
                _ => {}
            }
        }
    }

    /// Takes one of a fixture's restarts; false when they are used up.
    pub fn take_restart(&mut self, place: usize) -> bool {
        if self.restarts[place] >= self.runs[place].plan().restarts {
            return false;
        }
        self.restarts[place] += 1;
        self.runs[place].delay_restart();
        true
    }

    /// Has all that are ready examined: their places, and the numbers of the
    /// examinations.
    pub fn examine_all(&mut self, probes: Probes, cx: &mut Context<'_>) -> Vec<(usize, u64)> {
        let all = self.runs.iter_mut().enumerate();
        let ready = all.filter(|(_, fixture)| fixture.state() == State::Ready);
        ready.map(|(place, fixture)| (place, fixture.examine(probes, cx))).collect()
    }

    /// Whether these examinations were passed.
    pub fn have_passed(&self, needs: &[(usize, u64)]) -> bool {
        needs.iter().all(|(place, number)| self.runs[*place].has_passed(*number))
    }

    /// Asks each plug-in whether it is well.
    pub fn ask_checks(&mut self, cx: &mut Context<'_>) {
        self.runs.iter_mut().for_each(|fixture| fixture.ask_check(cx));
    }

    /// Whether any of them asked for it.
    pub fn any_hears(&self, notice: Subscription) -> bool {
        self.runs.iter().any(|fixture| fixture.hears(notice))
    }

    /// Tells each that asked for it of a test.
    pub fn tell(&mut self, about: (Subscription, TestId), told: &Request, cx: &mut Context<'_>) {
        self.runs.iter_mut().for_each(|fixture| fixture.tell(about, told.clone(), cx));
    }

    /// Whether any of them has not answered what it was told of a test.
    pub fn any_told_of(&self, test: TestId) -> bool {
        self.runs.iter().any(|fixture| fixture.is_told_of(test))
    }

    pub fn any_checking(&self) -> bool {
        self.runs.iter().any(FixtureRun::is_checking)
    }
}
