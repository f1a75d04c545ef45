//! The deadlines of a suite. Those of a throttled process are paused: a slow disk must not fail
//! a test. The limits of a test that waits for an operator are paused, too.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::time::Duration;

use rtf_model::{Source, TestId};

use super::machine::{Deadline, HostId, TestTimer};
use rtf_plan::plan::SuitePlan;

/// The pending deadlines, as times of the run.
#[derive(Debug, Default)]
pub(super) struct Deadlines {
    at: BTreeMap<Deadline, Duration>,
    /// The hosts whose deadlines are paused, and since when.
    paused: HashMap<HostId, (Source, Duration)>,
    /// Hosts that are being stopped: their deadlines are not paused.
    stopping: HashSet<HostId>,
    /// The tests that wait for an answer of an operator, and since when: their limits are paused.
    asking: BTreeMap<TestId, Duration>,
}

impl Deadlines {
    pub(super) fn set(&mut self, deadline: Deadline, at: Duration) {
        self.at.insert(deadline, at);
    }

    pub(super) fn clear(&mut self, deadline: Deadline) {
        self.at.remove(&deadline);
    }

    pub(super) fn next(&self, plan: &SuitePlan) -> Option<Duration> {
        let due = self.at.iter().filter(|(deadline, _)| !self.is_paused(**deadline, plan));
        due.map(|(_, at)| *at).min()
    }

    pub(super) fn passed(&self, now: Duration, plan: &SuitePlan) -> Vec<Deadline> {
        let passed = self.at.iter().filter(|(_, at)| **at <= now).map(|(deadline, _)| *deadline);
        passed.filter(|deadline| !self.is_paused(*deadline, plan)).collect()
    }

    /// Removes one if it has passed.
    pub(super) fn take(&mut self, deadline: Deadline, now: Duration, plan: &SuitePlan) -> bool {
        let has_passed = self.at.get(&deadline).is_some_and(|at| *at <= now);
        let is_due = has_passed && !self.is_paused(deadline, plan);
        if is_due {
            self.at.remove(&deadline);
        }
        is_due
    }

    pub(super) fn pause(&mut self, host: HostId, source: Source, now: Duration) {
        if !self.stopping.contains(&host) {
            self.paused.entry(host).or_insert((source, now));
        }
    }

    pub(super) fn resume(&mut self, host: HostId, now: Duration, plan: &SuitePlan) {
        let Some((source, since)) = self.paused.remove(&host) else { return };
        let late = now.saturating_sub(since);
        let ours = self.at.iter_mut().filter(|(deadline, _)| is_of(**deadline, source, plan));
        ours.for_each(|(_, at)| *at += late);
    }

    /// A host is being stopped: its deadlines are no longer paused.
    pub(super) fn stop(&mut self, host: HostId, now: Duration, plan: &SuitePlan) {
        self.resume(host, now, plan);
        self.stopping.insert(host);
    }

    /// A host has ended.
    pub(super) fn forget(&mut self, host: HostId, now: Duration, plan: &SuitePlan) {
        self.resume(host, now, plan);
        self.stopping.remove(&host);
    }

    /// Pauses the limits of a test, which asks an operator a question.
    pub(super) fn pause_limits(&mut self, test: TestId, now: Duration) {
        self.asking.entry(test).or_insert(now);
    }

    pub(super) fn resume_limits(&mut self, test: TestId, now: Duration) {
        let Some(since) = self.asking.remove(&test) else { return };
        let late = now.saturating_sub(since);
        for timer in [TestTimer::Limit, TestTimer::Slow] {
            self.at.get_mut(&Deadline::Test(test, timer)).into_iter().for_each(|at| *at += late);
        }
    }

    fn is_paused(&self, deadline: Deadline, plan: &SuitePlan) -> bool {
        let is_asking = match deadline {
            Deadline::Test(test, TestTimer::Limit | TestTimer::Slow) => {
                self.asking.contains_key(&test)
            }
            _ => false,
        };
        is_asking || self.paused.values().any(|(source, _)| is_of(deadline, *source, plan))
    }
}

fn is_of(deadline: Deadline, source: Source, plan: &SuitePlan) -> bool {
    match (deadline, source) {
        (Deadline::Test(test, _), Source::Test(of)) => test == of,
        (Deadline::Fixture(index, _), Source::Fixture(of)) => {
            plan.fixtures.get(index).is_some_and(|fixture| fixture.id == of)
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::machine::tests::world::suite;

    const SECOND: Duration = Duration::from_secs(1);
    const HOST: HostId = HostId(7);

    fn limit(test: u32) -> Deadline {
        Deadline::Test(TestId(test), TestTimer::Limit)
    }

    fn two() -> Deadlines {
        let mut deadlines = Deadlines::default();
        deadlines.set(limit(1), 5 * SECOND);
        deadlines.set(limit(2), 6 * SECOND);
        deadlines
    }

    #[test]
    fn the_deadline_of_a_throttled_test_moves_by_the_pause() {
        let (mut deadlines, plan) = (two(), suite(0, 3));
        deadlines.pause(HOST, Source::Test(TestId(1)), 4 * SECOND);
        assert_eq!(deadlines.next(&plan), Some(6 * SECOND), "the other deadline is not paused");
        assert_eq!(deadlines.passed(10 * SECOND, &plan), [limit(2)]);
        assert!(!deadlines.take(limit(1), 10 * SECOND, &plan));
        deadlines.resume(HOST, 10 * SECOND, &plan);
        assert!(deadlines.passed(11 * SECOND - SECOND / 2, &plan).len() == 1);
        assert!(deadlines.take(limit(1), 11 * SECOND, &plan));
    }

    #[test]
    fn the_deadlines_of_a_stop_are_not_paused() {
        let (mut deadlines, plan) = (two(), suite(0, 3));
        deadlines.pause(HOST, Source::Test(TestId(1)), 4 * SECOND);
        deadlines.stop(HOST, 5 * SECOND, &plan);
        deadlines.set(limit(1), 7 * SECOND);
        deadlines.pause(HOST, Source::Test(TestId(1)), 6 * SECOND);
        assert!(deadlines.take(limit(1), 7 * SECOND, &plan));
    }

    #[test]
    fn the_time_of_a_person_does_not_count() {
        let (mut deadlines, plan) = (two(), suite(0, 3));
        let answer = Deadline::Test(TestId(1), TestTimer::Question(1));
        deadlines.set(answer, 9 * SECOND);
        deadlines.pause_limits(TestId(1), 2 * SECOND);
        assert_eq!(deadlines.passed(9 * SECOND, &plan), [answer, limit(2)]);
        deadlines.resume_limits(TestId(1), 8 * SECOND);
        deadlines.clear(answer);
        assert_eq!(deadlines.passed(11 * SECOND - SECOND / 2, &plan), [limit(2)]);
        assert!(deadlines.take(limit(1), 11 * SECOND, &plan));
    }
}
