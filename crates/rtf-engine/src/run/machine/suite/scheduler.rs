//! Schedules the tests of a suite: which are active, and which may start now.
//!
//! A test occupies one of the suite's `parallel` slots from its first to its last attempt,
//! also while a retry is delayed. So its repetitions never overlap, and tests begin in the
//! order of the suite file.

use std::time::Duration;

use rtf_model::protocol::TestAttempt;
use rtf_model::{StopCause, TestId, Verdict};

use super::active_test::{ActiveTest, AttemptNumber};
use super::shared_host::SharedHost;
use super::soak::Soak;
use crate::fixture_values::FixtureValues;
use crate::run::machine::context::Context;
use crate::run::machine::io::{HostId, StartRequest};
use crate::run::machine::test::host::{TestRequest, host_start};
use crate::run::machine::test::{FinishedAttempt, TestRun};
use rtf_plan::plan::SuitePlan;

/// How many hosts are started ahead. Starting one takes longer than a short test; two
/// keep a second core busy.
const HOSTS_AHEAD: usize = 2;

#[derive(Debug)]
pub(super) struct Scheduler<'p> {
    pub(super) suite: &'p SuitePlan,
    /// In the order of the suite file.
    active: Vec<ActiveTest<'p>>,
    /// The index of the first test that has not begun in this round.
    next: usize,
    pub soak: Soak,
    pub(super) shared_host: SharedHost<'p>,
}

impl<'p> Scheduler<'p> {
    pub fn new(suite: &'p SuitePlan) -> Self {
        let (soak, shared_host) = (Soak::new(suite), SharedHost::new(suite));
        Self { suite, active: Vec::new(), next: 0, soak, shared_host }
    }

    pub fn any_begun(&self) -> bool {
        self.next > 0
    }

    pub fn any_running(&self) -> bool {
        self.active.iter().any(|active| active.run.is_some())
    }

    /// Whether a running test has no verdict yet.
    pub fn any_without_verdict(&self) -> bool {
        self.runs().any(|run| !run.is_judged())
    }

    /// Begins another round if this one is complete and the time has not passed.
    pub fn begin_round(&mut self, now: Duration) {
        let any_left = self.suite.tests.iter().any(|plan| self.soak.includes(plan.id));
        if self.is_done() && any_left && self.soak.begin_round(now) {
            self.restart();
        }
    }

    /// Begins with the first test again.
    pub fn restart(&mut self) {
        self.next = 0;
        self.skip_excluded();
    }

    /// Lets no further test begin in this round.
    pub fn end_round(&mut self) {
        self.next = self.suite.tests.len();
    }

    fn skip_excluded(&mut self) {
        let rest = self.suite.tests.iter().skip(self.next);
        self.next += rest.take_while(|plan| !self.soak.includes(plan.id)).count();
    }

    /// Whether a finished attempt of the test is to be rerun.
    pub fn is_rerun(&self, test: TestId) -> bool {
        self.active.iter().any(|active| active.plan.id == test && active.number.attempt > 1)
    }

    /// Whether no test is left in this round.
    pub fn is_done(&self) -> bool {
        self.active.is_empty() && self.next >= self.suite.tests.len()
    }

    /// Whether nothing follows a test in this round, if it passes.
    pub fn is_last(&self, test: TestId) -> bool {
        let is_last_attempt = |active: &ActiveTest<'_>| {
            active.number.next(false, self.soak.last_repetition(active.plan)).is_none()
        };
        self.next >= self.suite.tests.len()
            && self.active.iter().all(|active| active.plan.id == test && is_last_attempt(active))
    }

    /// Whether all tests' processes have ended, and no other test follows.
    pub fn all_exited(&self) -> bool {
        let has_exited =
            |active: &ActiveTest<'_>| active.run.as_ref().is_some_and(TestRun::has_exited);
        let mut all = self.active.iter();
        self.is_done() || all.all(|active| has_exited(active) && self.is_last(active.plan.id))
    }

    /// Lets no test begin any more.
    pub fn close(&mut self) {
        self.suite.tests.iter().for_each(|plan| self.soak.exclude(plan.id));
        self.next = self.suite.tests.len();
    }

    fn runs(&self) -> impl Iterator<Item = &TestRun<'p>> {
        self.active.iter().filter_map(|active| active.run.as_ref())
    }

    pub fn runs_mut(&mut self) -> impl Iterator<Item = &mut TestRun<'p>> {
        self.active.iter_mut().filter_map(|active| active.run.as_mut())
    }

    /// Whether a running test waits for episodes that have not arrived.
    #[cfg(debug_assertions)]
    pub fn awaits_episodes(&self) -> bool {
        self.runs().any(TestRun::awaits_episodes)
    }

    /// Whether a running test needs readings of the simulated clock.
    pub fn follows_clock(&self) -> bool {
        self.runs().any(TestRun::follows_clock)
    }

    pub fn on_clock(&mut self, time: Duration, cx: &mut Context<'_>) {
        self.runs_mut().for_each(|run| run.on_clock(time, cx));
    }

    /// Asks all running tests to stop.
    pub fn stop_all(&mut self, cause: StopCause, reason: &str, cx: &mut Context<'_>) {
        self.runs_mut().for_each(|run| run.stop(cause, reason.to_owned(), cx));
    }

    /// The only running test: an event of the suite then belongs to it.
    pub fn only_running_test(&self) -> Option<(TestId, String)> {
        let mut running = self.active.iter().filter(|active| active.run.is_some());
        match (running.next(), running.next()) {
            (Some(active), None) => Some((active.plan.id, active.plan.name.clone())),
            _ => None,
        }
    }

    pub fn run_of_host(&mut self, host: HostId) -> Option<&mut TestRun<'p>> {
        self.runs_mut().find(|run| run.host() == host)
    }

    pub fn run_of(&mut self, test: TestId) -> Option<&mut TestRun<'p>> {
        self.runs_mut().find(|run| run.id() == test)
    }

    pub fn get(&mut self, test: TestId) -> Option<&mut ActiveTest<'p>> {
        self.active.iter_mut().find(|active| active.plan.id == test)
    }

    /// The next attempt whose process has ended, and whether it was stopped; each once.
    pub fn take_end(&mut self) -> Option<(TestAttempt, bool)> {
        self.active.iter_mut().find_map(|active| {
            let run = active.run.as_mut()?;
            let was_stopped = run.was_stopped();
            run.take_end().then(|| (active.attempt(), was_stopped))
        })
    }

    /// Judges the next ended attempt about which no fixture is still asked. The verdict of one
    /// that was stopped waits for no fixture.
    pub fn judge_next(
        &mut self,
        delivered: impl Fn(TestId) -> bool,
        cx: &mut Context<'_>,
    ) -> Option<(TestAttempt, Verdict, Option<String>)> {
        self.active.iter_mut().find_map(|active| {
            let run = active.run.as_mut()?;
            if !run.was_stopped() && !delivered(active.plan.id) {
                return None;
            }
            let (verdict, reason) = run.judge(cx)?;
            Some((active.attempt(), verdict, reason))
        })
    }

    /// The next attempt that is judged and whose verdict was `delivered` to all
    /// subscribers. The test stays active.
    pub fn take_finished(
        &mut self,
        delivered: impl Fn(TestId) -> bool,
    ) -> Option<(TestId, TestRun<'p>, FinishedAttempt)> {
        let mut all = self.active.iter_mut().filter(|active| delivered(active.plan.id));
        all.find_map(|active| {
            let finished = active.run.as_mut()?.take_finished()?;
            active.is_notified = false;
            Some((active.plan.id, active.run.take()?, finished))
        })
    }

    /// The next due attempt of which fixtures have to be notified.
    pub fn next_to_notify(&mut self, now: Duration) -> Option<TestAttempt> {
        let mut all = self.active.iter_mut();
        let active = all.find(|active| active.is_due() && !active.is_notified)?;
        active.is_notified = true;
        active.announced = now;
        Some(active.attempt())
    }

    /// Whether a due attempt waits until all subscribers have replied.
    pub fn any_awaiting_notification(&self) -> bool {
        self.active.iter().any(|active| active.is_due() && active.is_notified)
    }

    /// Fixtures restarted: they were notified of no attempt that has not started.
    pub fn forget_notifications(&mut self) {
        let waiting = self.active.iter_mut().filter(|active| active.run.is_none());
        waiting.for_each(|active| active.is_notified = false);
    }

    pub fn remove(&mut self, test: TestId) {
        self.active.retain(|active| active.plan.id != test);
    }

    /// Whether an attempt may start now, as far as other tests are concerned.
    pub fn any_due(&self) -> bool {
        self.active.iter().any(ActiveTest::is_due) || self.has_free_slot()
    }

    /// Whether the next test may begin in addition to the active ones.
    fn has_free_slot(&self) -> bool {
        // Tests after a critical one depend on it.
        let blocks = |active: &ActiveTest<'_>| {
            active.plan.settings.critical || active.plan.settings.exclusive
        };
        let Some(plan) = self.suite.tests.get(self.next) else { return false };
        self.active.len() < self.suite.settings.parallel as usize
            && !self.active.iter().any(blocks)
            && (!plan.settings.exclusive || self.active.is_empty())
    }

    /// Makes the next test active; false if there is no free slot.
    pub fn begin_next(&mut self) -> bool {
        let is_free = self.has_free_slot();
        if is_free {
            let plan = &self.suite.tests[self.next];
            self.active.push(ActiveTest {
                plan,
                number: self.soak.begin(plan),
                run: None,
                is_delayed: false,
                is_notified: false,
                announced: Duration::ZERO,
                carried: None,
                stop_reason: None,
            });
            self.next += 1;
            self.skip_excluded();
        }
        is_free
    }

    /// Starts the next due attempt if its notification was `delivered` to all subscribers;
    /// false if there is none.
    pub fn start_next(&mut self, delivered: impl Fn(TestId) -> bool, cx: &mut Context<'_>) -> bool {
        let is_notified = |active: &ActiveTest<'_>| active.is_due() && active.is_notified;
        let next = self.active.iter().position(is_notified);
        // A fixture may reply to notifications in another order. Tests keep theirs.
        let Some(index) = next.filter(|index| delivered(self.active[*index].plan.id)) else {
            return false;
        };
        let (plan, number) = (self.active[index].plan, self.active[index].number);
        self.soak.record_start(plan.id, number);
        let carried = self.active[index].carried.take();
        let request = TestRequest { carried: carried.as_deref(), ..self.request(plan, number) };
        let host = (self.choose_host(plan, cx), request);
        let mut run = TestRun::start(self.suite, plan, number.attempt, host, cx);
        if let Some(carried) = carried {
            run.carry(*carried, cx);
        }
        self.active[index].run = Some(run);
        true
    }

    /// The attempt that may start next.
    pub(super) fn next_due(&self) -> Option<(TestId, AttemptNumber)> {
        let active = self.active.iter().find(|active| active.is_due());
        let begun = active.map(|active| (active.plan.id, active.number));
        let next = || self.suite.tests.get(self.next).map(|plan| (plan.id, AttemptNumber::FIRST));
        begun.or_else(|| self.has_free_slot().then(next)?)
    }

    /// The hosts of the next attempts: further repetitions, then tests that have not begun.
    pub fn hosts_ahead(&self, values: &FixtureValues) -> Vec<StartRequest> {
        if self.active.iter().any(|active| self.successor(active.plan, active.number).is_some()) {
            // The next test uses the shared host.
            return Vec::new();
        }
        let soak = &self.soak;
        let left =
            |active: &ActiveTest<'p>| soak.last_repetition(active.plan) - active.number.repetition;
        let begun = self.active.iter().map(|active| (active.plan, left(active)));
        // In a soak, the first test may follow the last one. Another episode has other values.
        let is_soak = soak.is_timed() && self.suite.episodes.is_empty();
        let next_round = if is_soak { &*self.suite.tests } else { &[] };
        let others = self.suite.tests[self.next..].iter().chain(next_round);
        let others = others.filter(|plan| soak.includes(plan.id));
        let all = begun.chain(others.map(|plan| (plan, plan.settings.repetitions)));
        // Its domain may be in use until its test starts.
        let all = all.filter(|(plan, _)| !plan.settings.own_domain);
        let next = all
            .flat_map(|(plan, times)| std::iter::repeat_n(plan, HOSTS_AHEAD.min(times as usize)));
        next.take(HOSTS_AHEAD).map(|plan| host_start(self.suite, plan, values)).collect()
    }

    /// Tests that have not begun, or have attempts left.
    pub fn unfinished(&self) -> impl Iterator<Item = TestId> {
        let others = self.suite.tests[self.next..].iter().map(|plan| plan.id);
        self.active.iter().map(|active| active.plan.id).chain(others)
    }
}
