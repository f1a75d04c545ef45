//! Repeats a suite until a time has passed (`--for`), in rounds on the same fixtures. A
//! round that has started is completed, so that all tests are repeated equally often. The rounds
//! of a campaign are its [`episodes`](super::episodes).

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use rtf_model::{EventKind, TestId};

use super::SuiteMachine;
use super::active_test::AttemptNumber;
use crate::run::machine::context::Context;
use crate::run::machine::io::Deadline;
use rtf_plan::plan::{SuitePlan, TestPlan};

/// A suite that is not repeated has one round.
#[derive(Debug, Default)]
pub(super) struct Soak {
    /// No round starts after this time of the run.
    until: Option<Duration>,
    /// Whether each round is an episode of a campaign.
    has_episodes: bool,
    /// The repetition of each test that started last.
    last_started: BTreeMap<TestId, u32>,
    /// The last repetition of each test in this round, if it has begun.
    last_of_round: BTreeMap<TestId, u32>,
    /// Tests that are in no further round.
    excluded: BTreeSet<TestId>,
}

impl Soak {
    /// Whether the number of rounds is not known before they end.
    pub fn is_timed(&self) -> bool {
        self.until.is_some() || self.has_episodes
    }

    /// Whether a test is in this round.
    pub fn includes(&self, test: TestId) -> bool {
        !self.excluded.contains(&test)
    }

    /// Begins a test in this round, and returns its first attempt.
    pub fn begin(&mut self, plan: &TestPlan) -> AttemptNumber {
        let previous = self.last_started.get(&plan.id).copied().unwrap_or_default();
        self.last_of_round.insert(plan.id, previous.saturating_add(plan.settings.repetitions));
        AttemptNumber { repetition: previous.saturating_add(1), ..AttemptNumber::FIRST }
    }

    /// The last repetition in this round of a test that has begun.
    pub fn last_repetition(&self, plan: &TestPlan) -> u32 {
        self.last_of_round.get(&plan.id).copied().unwrap_or(plan.settings.repetitions)
    }

    pub fn record_start(&mut self, test: TestId, number: AttemptNumber) {
        self.last_started.insert(test, number.repetition);
    }

    pub fn exclude(&mut self, test: TestId) {
        self.excluded.insert(test);
    }

    /// Starts another round; false if the time has passed.
    pub fn begin_round(&mut self, now: Duration) -> bool {
        self.until.is_some_and(|until| now < until)
    }
}

impl Soak {
    /// The rounds of a suite: episodes, if it has any.
    pub fn new(suite: &SuitePlan) -> Self {
        Self { has_episodes: !suite.episodes.is_empty(), ..Self::default() }
    }
}

impl SuiteMachine<'_> {
    /// Repeats the suite until this time of the run.
    #[must_use]
    pub fn until(mut self, until: Option<Duration>) -> Self {
        self.scheduler.soak.until = until;
        self
    }

    /// Reports tests without a final result. In a timed run, only those are skipped that
    /// never ran, or were to be rerun.
    pub(super) fn report_unfinished_tests(&self, cx: &mut Context<'_>) {
        let reason = self.end_reason.clone().unwrap_or_default();
        let soak = &self.scheduler.soak;
        let mut tests: Vec<TestId> = self.scheduler.unfinished().collect();
        if soak.is_timed() {
            tests = self.plan.tests.iter().map(|plan| plan.id).collect();
        }
        for test in tests.into_iter().filter(|test| soak.includes(*test)) {
            cx.clear(Deadline::Retry(test));
            match soak.last_started.get(&test) {
                Some(&repetitions) if soak.is_timed() && !self.scheduler.is_rerun(test) => {
                    cx.emit(EventKind::TestRepeated { test, repetitions });
                }
                _ => cx.emit(EventKind::TestSkipped { test, reason: reason.clone() }),
            }
        }
    }
}
