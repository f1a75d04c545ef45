//! A suite that is repeated until a time is over (`--for`): round by round, on
//! the same fixtures. A round that began comes to its end, so that all tests
//! are repeated equally often, and there is always one.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use rtf_model::{EventKind, TestId};

use super::{Context, Cursor, SuiteMachine};
use crate::run::machine::io::Deadline;
use rtf_plan::plan::TestPlan;

/// How far the rounds are. A suite that is not repeated has one.
#[derive(Debug)]
pub(super) struct Rounds {
    /// When no other round begins.
    until: Option<Duration>,
    /// From 1.
    round: u32,
    /// The repetition of each test that began last.
    begun: BTreeMap<TestId, u32>,
    /// The tests whose last word is spoken: they are in no further round.
    given_up: BTreeSet<TestId>,
}

impl Rounds {
    pub fn new() -> Self {
        Self { until: None, round: 1, begun: BTreeMap::new(), given_up: BTreeSet::new() }
    }

    pub fn are_timed(&self) -> bool {
        self.until.is_some()
    }

    /// Whether a test is in this round.
    pub fn have(&self, test: TestId) -> bool {
        !self.given_up.contains(&test)
    }

    /// The first attempt of a test in this round.
    pub fn first_of(&self, plan: &TestPlan) -> Cursor {
        let before = plan.repetitions.saturating_mul(self.round - 1);
        Cursor { repetition: before.saturating_add(1), ..Cursor::FIRST }
    }

    /// The last repetition of a test in this round.
    pub fn last_of(&self, plan: &TestPlan) -> u32 {
        plan.repetitions.saturating_mul(self.round)
    }

    /// A repetition begins.
    pub fn begins(&mut self, test: TestId, cursor: Cursor) {
        self.begun.insert(test, cursor.repetition);
    }

    pub fn give_up(&mut self, test: TestId) {
        self.given_up.insert(test);
    }

    /// Begins another round, if there is time for one.
    pub fn begin(&mut self, now: Duration) -> bool {
        let begins = self.until.is_some_and(|until| now < until);
        self.round = self.round.saturating_add(begins.into());
        begins
    }
}

impl SuiteMachine<'_> {
    /// Repeats the suite until this time of the run.
    #[must_use]
    pub fn until(mut self, until: Option<Duration>) -> Self {
        self.turns.rounds.until = until;
        self
    }

    /// What a suite that is over says of tests that nobody has spoken the last
    /// word on. Of those that are repeated, only the ones that never ran, or
    /// were to run again, are skipped.
    pub(super) fn last_words(&self, cx: &mut Context<'_>) {
        let reason = self.ending.clone().unwrap_or_default();
        let rounds = &self.turns.rounds;
        let mut rest: Vec<TestId> = self.turns.rest().collect();
        if rounds.are_timed() {
            rest = self.plan.tests.iter().map(|plan| plan.id).collect();
        }
        for test in rest.into_iter().filter(|test| rounds.have(*test)) {
            cx.clear(Deadline::Retry(test));
            match rounds.begun.get(&test) {
                Some(&repetitions) if rounds.are_timed() && !self.turns.is_rerun(test) => {
                    cx.emit(EventKind::TestRepeated { test, repetitions });
                }
                _ => cx.emit(EventKind::TestSkipped { test, reason: reason.clone() }),
            }
        }
    }
}
