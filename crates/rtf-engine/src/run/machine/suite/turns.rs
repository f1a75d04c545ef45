//! Whose turn it is: the tests that have begun and are not over, and which of
//! them, or of those that have not begun, may start now.
//!
//! A test has one of the suite's `parallel` places from its first attempt to its
//! last, also while its retry waits. So its repetitions never overlap, and tests
//! begin in the order in which they are written.

use std::time::Duration;

use rtf_model::protocol::TestAttempt;
use rtf_model::{StopCause, TestId, Verdict};

use super::Context;
use super::cursor::Cursor;
use super::rounds::Rounds;
use super::sharing::Sharing;
use crate::run::machine::io::{HostId, Start};
use crate::run::machine::test::{Ended, TestRun};
use rtf_plan::plan::{SuitePlan, TestPlan};

/// How many hosts are started ahead of their need. Starting one takes longer than
/// a short test; two keep a second core busy.
const HOSTS_AHEAD: usize = 2;

/// A test that has begun and is not over.
#[derive(Debug)]
pub(super) struct Turn<'p> {
    pub plan: &'p TestPlan,
    /// Which attempt runs, or is next.
    pub cursor: Cursor,
    /// The attempt that runs; none between two of them.
    pub run: Option<TestRun<'p>>,
    /// Whether its next attempt is not due yet.
    pub waits: bool,
    /// Whether the fixtures were told that its next attempt is about to begin.
    pub told: bool,
    /// Why no more of its repetitions follow.
    pub given_up: Option<String>,
}

impl Turn<'_> {
    fn is_due(&self) -> bool {
        self.run.is_none() && !self.waits
    }

    /// The attempt that runs, or is next, as fixtures are told.
    fn told_test(&self) -> TestAttempt {
        let Cursor { repetition, attempt, .. } = self.cursor;
        TestAttempt { id: self.plan.id, name: self.plan.name.clone(), repetition, attempt }
    }
}

/// The tests of a suite, by how far they are.
#[derive(Debug)]
pub(super) struct Turns<'p> {
    pub(super) suite: &'p SuitePlan,
    /// Those that have begun and are not over, as they are written.
    open: Vec<Turn<'p>>,
    /// The place of the first test that has not begun in this round.
    next: usize,
    pub rounds: Rounds,
    pub(super) sharing: Sharing<'p>,
}

impl<'p> Turns<'p> {
    pub fn new(suite: &'p SuitePlan) -> Self {
        let (rounds, sharing) = (Rounds::new(), Sharing::new(suite));
        Self { suite, open: Vec::new(), next: 0, rounds, sharing }
    }

    /// Whether any test has begun.
    pub fn any_begun(&self) -> bool {
        self.next > 0
    }

    pub fn any_running(&self) -> bool {
        self.open.iter().any(|turn| turn.run.is_some())
    }

    /// Whether a test runs on which no verdict was spoken yet.
    pub fn any_unjudged(&self) -> bool {
        self.open.iter().any(|turn| turn.run.as_ref().is_some_and(|run| !run.is_judged()))
    }

    /// Begins another round when this one is over, if there is time for one.
    pub fn begin_round(&mut self, now: Duration) {
        let any_left = self.suite.tests.iter().any(|plan| self.rounds.have(plan.id));
        if self.all_over() && any_left && self.rounds.begin(now) {
            self.next = 0;
            self.pass_over();
        }
    }

    /// The next test is one that is in this round.
    fn pass_over(&mut self) {
        let rest = self.suite.tests.iter().skip(self.next);
        self.next += rest.take_while(|plan| !self.rounds.have(plan.id)).count();
    }

    /// Whether a test that ended is to be run again.
    pub fn is_rerun(&self, test: TestId) -> bool {
        self.open.iter().any(|turn| turn.plan.id == test && turn.cursor.attempt > 1)
    }

    /// Whether no test is left.
    pub fn all_over(&self) -> bool {
        self.open.is_empty() && self.next >= self.suite.tests.len()
    }

    /// Whether nothing follows a test in this round, if it passes.
    pub fn is_last(&self, test: TestId) -> bool {
        let ends =
            |turn: &Turn<'_>| turn.cursor.next(false, self.rounds.last_of(turn.plan)).is_none();
        self.next >= self.suite.tests.len()
            && self.open.iter().all(|turn| turn.plan.id == test && ends(turn))
    }

    /// Whether the processes of all tests have ended, and no other follows.
    pub fn all_ended(&self) -> bool {
        let mut open = self.open.iter();
        let ended = |turn: &Turn<'_>| turn.run.as_ref().is_some_and(TestRun::has_ended);
        self.all_over() || open.all(|turn| ended(turn) && self.is_last(turn.plan.id))
    }

    /// No test will begin any more.
    pub fn close(&mut self) {
        self.suite.tests.iter().for_each(|plan| self.rounds.give_up(plan.id));
        self.next = self.suite.tests.len();
    }

    /// The attempts that run.
    pub fn running(&mut self) -> impl Iterator<Item = &mut TestRun<'p>> {
        self.open.iter_mut().filter_map(|turn| turn.run.as_mut())
    }

    /// Whether a test waits for the clock that the suite follows.
    pub fn follow_clock(&self) -> bool {
        self.open.iter().filter_map(|turn| turn.run.as_ref()).any(TestRun::follows_clock)
    }

    /// The clock that the suite follows shows a time.
    pub fn clock_shows(&mut self, time: Duration, cx: &mut Context<'_>) {
        self.running().for_each(|run| run.clock_shows(time, cx));
    }

    /// Asks all tests that run to stop.
    pub fn stop_all(&mut self, cause: StopCause, reason: &str, cx: &mut Context<'_>) {
        self.running().for_each(|run| run.stop(cause, reason.to_owned(), cx));
    }

    /// The test that runs, when it is only one: what happens to the suite then is about it.
    pub fn only_one(&self) -> Option<(TestId, String)> {
        let mut running = self.open.iter().filter(|turn| turn.run.is_some());
        match (running.next(), running.next()) {
            (Some(turn), None) => Some((turn.plan.id, turn.plan.name.clone())),
            _ => None,
        }
    }

    pub fn of_host(&mut self, host: HostId) -> Option<&mut TestRun<'p>> {
        self.running().find(|run| run.host() == host)
    }

    pub fn of_test(&mut self, test: TestId) -> Option<&mut Turn<'p>> {
        self.open.iter_mut().find(|turn| turn.plan.id == test)
    }

    /// Judges an attempt that is to be judged now: its verdict and the reason.
    pub fn judge_next(
        &mut self,
        cx: &mut Context<'_>,
    ) -> Option<(TestAttempt, Verdict, Option<String>)> {
        self.open.iter_mut().find_map(|turn| {
            let (verdict, reason) = turn.run.as_mut()?.judge_once(cx)?;
            Some((turn.told_test(), verdict, reason))
        })
    }

    /// An attempt that is judged, and of which all have `heard`; its test is still open.
    pub fn take_end(
        &mut self,
        heard: impl Fn(TestId) -> bool,
    ) -> Option<(TestId, TestRun<'p>, Ended)> {
        let mut heard_of = self.open.iter_mut().filter(|turn| heard(turn.plan.id));
        heard_of.find_map(|turn| {
            let ended = turn.run.as_mut()?.take_end()?;
            turn.told = false;
            Some((turn.plan.id, turn.run.take()?, ended))
        })
    }

    /// The next of the attempts that are due of which fixtures have to be told.
    pub fn tell_next(&mut self) -> Option<TestAttempt> {
        let turn = self.open.iter_mut().find(|turn| turn.is_due() && !turn.told)?;
        turn.told = true;
        Some(turn.told_test())
    }

    /// Whether an attempt that is due waits until all have heard of it.
    pub fn any_told(&self) -> bool {
        self.open.iter().any(|turn| turn.is_due() && turn.told)
    }

    /// Fixtures were set up anew: they know of no attempt that has not begun.
    pub fn untell(&mut self) {
        self.open.iter_mut().filter(|turn| turn.run.is_none()).for_each(|turn| turn.told = false);
    }

    /// A test is over.
    pub fn remove(&mut self, test: TestId) {
        self.open.retain(|turn| turn.plan.id != test);
    }

    /// Whether a test may start now, as far as the others are concerned.
    pub fn any_due(&self) -> bool {
        self.open.iter().any(Turn::is_due) || self.has_room()
    }

    /// Whether the next test may begin beside those that are open.
    fn has_room(&self) -> bool {
        let alone = |plan: &TestPlan| plan.exclusive;
        // What is written after a critical test makes no sense without it.
        let bars = |turn: &Turn<'_>| turn.plan.critical || alone(turn.plan);
        let Some(plan) = self.suite.tests.get(self.next) else { return false };
        self.open.len() < self.suite.parallel as usize
            && !self.open.iter().any(bars)
            && (!alone(plan) || self.open.is_empty())
    }

    /// Opens the next test, if it may begin beside those that are open.
    pub fn open_next(&mut self) -> bool {
        let room = self.has_room();
        if room {
            let plan = &self.suite.tests[self.next];
            let (cursor, run) = (self.rounds.first_of(plan), None);
            let (waits, told, given_up) = (false, false, None);
            self.open.push(Turn { plan, cursor, run, waits, told, given_up });
            self.next += 1;
            self.pass_over();
        }
        room
    }

    /// Starts the next attempt that may start and of which all fixtures have `heard`;
    /// false when there is none.
    pub fn start_next(&mut self, heard: impl Fn(TestId) -> bool, cx: &mut Context<'_>) -> bool {
        let may = |turn: &Turn<'_>| turn.is_due() && turn.told && heard(turn.plan.id);
        let Some(at) = self.open.iter().position(may) else { return false };
        let (plan, cursor) = (self.open[at].plan, self.open[at].cursor);
        self.rounds.begins(plan.id, cursor);
        let place = self.place(plan, cx);
        let last = self.follower(plan, cursor).is_none();
        let number = (cursor.repetition, cursor.attempt);
        self.open[at].run = Some(TestRun::start(self.suite, plan, number, (place, last), cx));
        true
    }

    /// The attempt that may start next, and whose test it is.
    pub(super) fn due(&self) -> Option<(TestId, Cursor)> {
        let turn = self.open.iter().find(|turn| turn.is_due());
        let begun = turn.map(|turn| (turn.plan.id, turn.cursor));
        let next = || self.suite.tests.get(self.next).map(|plan| (plan.id, Cursor::FIRST));
        begun.or_else(|| self.has_room().then(next)?)
    }

    /// How the hosts of the next attempts are started: further repetitions, then
    /// tests that have not begun.
    pub fn hosts_ahead(&self) -> Vec<Start> {
        if self.open.iter().any(|turn| self.follower(turn.plan, turn.cursor).is_some()) {
            // The next test needs none.
            return Vec::new();
        }
        let rounds = &self.rounds;
        let left = |turn: &Turn<'p>| rounds.last_of(turn.plan) - turn.cursor.repetition;
        let begun = self.open.iter().map(|turn| (turn.plan, left(turn)));
        // After the last one, the first may follow.
        let again = if rounds.are_timed() { &*self.suite.tests } else { &[] };
        let others = self.suite.tests[self.next..].iter().chain(again);
        let others = others.filter(|plan| rounds.have(plan.id));
        let all = begun.chain(others.map(|plan| (plan, plan.repetitions)));
        let next = all
            .flat_map(|(plan, times)| std::iter::repeat_n(plan, HOSTS_AHEAD.min(times as usize)));
        next.take(HOSTS_AHEAD).map(|plan| TestRun::host_start(self.suite, plan)).collect()
    }

    /// The tests of which something is left.
    pub fn rest(&self) -> impl Iterator<Item = TestId> {
        let others = self.suite.tests[self.next..].iter().map(|plan| plan.id);
        self.open.iter().map(|turn| turn.plan.id).chain(others)
    }
}
