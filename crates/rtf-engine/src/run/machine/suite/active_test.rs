//! A test that has begun and has attempts left.

use std::time::Duration;

use rtf_model::protocol::TestAttempt;

use crate::run::machine::test::{CarriedCases, TestRun};
use rtf_plan::plan::TestPlan;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct AttemptNumber {
    /// From 1.
    pub repetition: u32,
    /// Within this repetition, from 1.
    pub attempt: u32,
    /// How many attempts of this repetition followed a failure.
    pub retries: u32,
}

impl AttemptNumber {
    pub const FIRST: Self = Self { repetition: 1, attempt: 1, retries: 0 };

    /// `None` if this was the last attempt.
    pub fn next(self, rerun: bool, repetitions: u32) -> Option<Self> {
        let Self { repetition, attempt, .. } = self;
        if rerun {
            Some(Self { attempt: attempt + 1, ..self })
        } else if repetition < repetitions {
            Some(Self { repetition: repetition + 1, ..Self::FIRST })
        } else {
            None
        }
    }
}

#[derive(Debug)]
pub(super) struct ActiveTest<'p> {
    pub plan: &'p TestPlan,
    /// The running attempt, or the next one.
    pub number: AttemptNumber,
    pub run: Option<TestRun<'p>>,
    /// Whether a retry waits for its delay.
    pub is_delayed: bool,
    /// Whether fixtures were notified of the next attempt.
    pub is_notified: bool,
    /// When that was, since the run started.
    pub announced: Duration,
    /// The cases that the next attempt does not run again.
    pub carried: Option<Box<CarriedCases>>,
    /// Why a user stopped it: no repetition follows.
    pub stop_reason: Option<String>,
}

impl ActiveTest<'_> {
    pub fn is_due(&self) -> bool {
        self.run.is_none() && !self.is_delayed
    }

    pub fn attempt(&self) -> TestAttempt {
        let AttemptNumber { repetition, attempt, .. } = self.number;
        TestAttempt { id: self.plan.id, name: self.plan.name.clone(), repetition, attempt }
    }
}
