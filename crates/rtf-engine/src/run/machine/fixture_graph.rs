//! All fixtures of a suite: which may be set up or torn down now.
//!
//! A fixture is set up when all its dependencies are ready, and torn down when all that
//! depend on it have stopped. Independent fixtures start and stop in parallel.

use rtf_model::TestId;
use rtf_model::protocol::{Request, Subscription, TestReportedParams};

use super::context::Context;
use super::fixture::{FixturePhase, FixtureRun};
use super::io::{HostId, ProbeSelection};
use rtf_plan::plan::SuitePlan;

/// The fixtures of a suite, in the order of its plan.
#[derive(Debug)]
pub struct FixtureGraph<'p> {
    runs: Vec<FixtureRun<'p>>,
    restarts: Vec<u32>,
}

impl<'p> FixtureGraph<'p> {
    pub fn new(plan: &'p SuitePlan) -> Self {
        let count = plan.fixtures.len();
        let runs = (0..count).map(|index| FixtureRun::new(plan, index)).collect();
        Self { runs, restarts: vec![0; count] }
    }

    pub fn get(&mut self, index: usize) -> &mut FixtureRun<'p> {
        &mut self.runs[index]
    }

    pub fn index_of(&self, host: HostId) -> Option<usize> {
        self.runs.iter().position(|fixture| fixture.host() == Some(host))
    }

    /// The fixture whose `<reset>` command is this process.
    pub fn that_resets(&mut self, host: HostId) -> Option<&mut FixtureRun<'p>> {
        self.runs.iter_mut().find(|fixture| fixture.reset_host() == Some(host))
    }

    fn any(&self, stages: &[FixturePhase]) -> bool {
        self.runs.iter().any(|fixture| stages.contains(&fixture.stage()))
    }

    fn all(&self, stage: FixturePhase) -> bool {
        self.runs.iter().all(|fixture| fixture.stage() == stage)
    }

    pub fn all_ready(&self) -> bool {
        self.runs.iter().all(FixtureRun::is_ready)
    }

    pub fn all_stopped(&self) -> bool {
        self.all(FixturePhase::Stopped)
    }

    pub fn any_started(&self) -> bool {
        self.runs.iter().any(|fixture| fixture.starts() > 0)
    }

    /// Starts every stopped fixture whose dependencies are ready, and resets those that an
    /// episode has used; false if there is none.
    pub fn start_next(&mut self, cx: &mut Context<'_>) -> bool {
        let ready: Vec<bool> = self.runs.iter().map(FixtureRun::is_ready).collect();
        let mut started = false;
        for fixture in &mut self.runs {
            let is_stopped = fixture.stage() == FixturePhase::Stopped;
            if !is_stopped && !fixture.is_used() {
                continue;
            }
            if fixture.plan().depends.iter().all(|needed| ready[*needed]) {
                if is_stopped {
                    fixture.start(cx)
                } else {
                    fixture.reset(cx)
                }
                started = true;
            }
        }
        started
    }

    /// An episode has ended: each ready fixture has to be reset or restarted before the next one,
    /// which may restart it as often as the first one.
    pub fn end_episode(&mut self) {
        self.runs.iter_mut().for_each(FixtureRun::end_episode);
        self.restarts.fill(0);
    }

    /// Tears down fixtures that failed or are not reset for the next episode, and their
    /// dependents, as far as they may stop now. Whether none is left.
    pub fn stop_due(&mut self, cx: &mut Context<'_>) -> bool {
        let is_due = |run: &FixtureRun<'_>| run.stage() == FixturePhase::Failed || run.is_spent();
        if self.runs.iter().any(is_due) {
            self.stop_with_dependents(is_due, cx);
        }
        let is_left = self.any(&[FixturePhase::Stopping, FixturePhase::Exiting]);
        !is_left && !self.runs.iter().any(is_due)
    }

    fn stop_with_dependents(
        &mut self,
        is_due: impl Fn(&FixtureRun<'_>) -> bool,
        cx: &mut Context<'_>,
    ) {
        let mut affected: Vec<bool> = self.runs.iter().map(is_due).collect();
        // A chain of dependencies is no longer than the list.
        for _ in 0..self.runs.len() {
            for index in 0..self.runs.len() {
                let depends = &self.runs[index].plan().depends;
                affected[index] |= depends.iter().any(|needed| affected[*needed]);
            }
        }
        self.stop(&affected, cx);
    }

    /// Tears down all fixtures, as far as they may stop now.
    pub fn stop_all(&mut self, cx: &mut Context<'_>) {
        self.stop(&vec![true; self.runs.len()], cx);
    }

    fn stop(&mut self, affected: &[bool], cx: &mut Context<'_>) {
        // One that stops at once may unblock the next one.
        loop {
            let may_stop = |index: &usize| affected[*index] && self.may_stop(*index);
            let due: Vec<usize> = (0..self.runs.len()).rev().filter(may_stop).collect();
            if due.is_empty() {
                return;
            }
            for index in due {
                self.runs[index].stop(cx);
            }
        }
    }

    fn may_stop(&self, index: usize) -> bool {
        use FixturePhase::{Delayed, Failed, Ready, Starting, Stopped};
        let has_stopped = |fixture: &FixtureRun<'_>| fixture.stage() == Stopped;
        let mut others = self.runs.iter();
        matches!(self.runs[index].stage(), Delayed | Starting | Ready | Failed)
            && others.all(|other| !other.plan().depends.contains(&index) || has_stopped(other))
    }

    /// Kills all fixtures, the last one first.
    pub fn kill_all(&mut self, reason: Option<&str>, cx: &mut Context<'_>) {
        self.runs.iter_mut().rev().for_each(|fixture| fixture.kill(reason, cx));
    }

    /// The suite's limit has passed: records it for fixtures whose tear-down has started,
    /// or for `all` that still have to be torn down.
    pub fn record_late_stop(&mut self, reason: &str, all: bool) {
        use FixturePhase::{Exiting, Failed, Ready, Stopping};
        for fixture in &mut self.runs {
            match fixture.stage() {
                Stopping | Exiting => fixture.record_late_stop(reason),
                Ready | Failed if all => fixture.record_late_stop(reason),
                _ => {}
            }
        }
    }

    /// Uses one of a fixture's restarts; false if none is left.
    pub fn use_restart(&mut self, index: usize) -> bool {
        if self.restarts[index] >= self.runs[index].plan().restarts {
            return false;
        }
        self.restarts[index] += 1;
        self.runs[index].delay_restart();
        true
    }

    /// Examines all ready fixtures; returns their indices and the examinations' numbers.
    pub fn examine_all(
        &mut self,
        probes: ProbeSelection,
        cx: &mut Context<'_>,
    ) -> Vec<(usize, u64)> {
        let all = self.runs.iter_mut().enumerate();
        let ready = all.filter(|(_, fixture)| fixture.stage() == FixturePhase::Ready);
        ready.map(|(index, fixture)| (index, fixture.examine(probes, cx))).collect()
    }

    pub fn have_passed(&self, examinations: &[(usize, u64)]) -> bool {
        examinations.iter().all(|(index, number)| self.runs[*index].has_passed_examination(*number))
    }

    pub fn request_checks(&mut self, cx: &mut Context<'_>) {
        self.runs.iter_mut().for_each(|fixture| fixture.request_check(cx));
    }

    pub fn any_subscribes_to(&self, topic: Subscription) -> bool {
        self.runs.iter().any(|fixture| fixture.subscribes_to(topic))
    }

    /// Notifies each subscriber.
    pub fn notify(
        &mut self,
        topic: (Subscription, TestId),
        notification: &Request,
        cx: &mut Context<'_>,
    ) {
        self.runs.iter_mut().for_each(|fixture| fixture.notify(topic, notification.clone(), cx));
    }

    /// Passes a report of a running test to each subscriber.
    pub fn forward(&self, report: &TestReportedParams, cx: &mut Context<'_>) {
        self.runs.iter().for_each(|fixture| fixture.forward(report, cx));
    }

    /// Whether any fixture has not replied to a notification of this test.
    pub fn any_notified_of(&self, test: TestId) -> bool {
        self.runs.iter().any(|fixture| fixture.is_notified_of(test))
    }

    pub fn any_check_pending(&self) -> bool {
        self.runs.iter().any(FixtureRun::is_check_pending)
    }
}
