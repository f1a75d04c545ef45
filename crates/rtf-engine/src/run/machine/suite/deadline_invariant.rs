//! Asserts that in every state a deadline is pending, so that a suite ends even if no
//! process does anything any more.

use std::collections::BTreeSet;

use rtf_model::TestId;

use crate::run::machine::io::{Deadline, Effect, FixtureTimer, Input, TestTimer};

#[derive(Debug, Default)]
pub(super) struct DeadlineInvariant {
    pending: BTreeSet<Deadline>,
    /// Tests whose limits are paused.
    asking: BTreeSet<TestId>,
}

impl DeadlineInvariant {
    /// The index of the first effect of this input.
    pub fn begin(&mut self, input: &Input, effects: &[Effect]) -> usize {
        if let Input::Deadline(deadline) = input {
            self.pending.remove(deadline);
        }
        effects.len()
    }

    /// Panics if a suite that continues has no pending deadline.
    pub fn check(&mut self, effects: &[Effect], continues: bool) {
        for effect in effects {
            match effect {
                Effect::SetDeadline(deadline, _) => drop(self.pending.insert(*deadline)),
                Effect::ClearDeadline(deadline) => drop(self.pending.remove(deadline)),
                Effect::PauseLimits(test) => drop(self.asking.insert(*test)),
                Effect::ResumeLimits(test) => drop(self.asking.remove(test)),
                _ => {}
            }
        }
        let is_ok = !continues || self.pending.iter().any(|deadline| self.makes_progress(deadline));
        assert!(is_ok, "no deadline is pending that makes progress: {:?}", self.pending);
    }

    /// The limits of the whole do not count: each step needs its own limit.
    fn makes_progress(&self, deadline: &Deadline) -> bool {
        match deadline {
            Deadline::Test(test, TestTimer::Limit) => !self.asking.contains(test),
            Deadline::Suite
            | Deadline::Shutdown
            | Deadline::Test(_, TestTimer::Slow)
            | Deadline::Fixture(_, FixtureTimer::CheckDue | FixtureTimer::UnfinishedLine) => false,
            _ => true,
        }
    }
}
