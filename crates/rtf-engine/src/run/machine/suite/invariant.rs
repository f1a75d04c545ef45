//! In every state something is waited for that is sure to come: a deadline. What a
//! process does may never come.
#![cfg(debug_assertions)]

use std::collections::BTreeSet;

use crate::run::machine::io::{Deadline, Effect, FixtureTimer, Input, TestTimer};

/// The deadlines that are set.
#[derive(Debug, Default)]
pub(super) struct Waits {
    set: BTreeSet<Deadline>,
}

impl Waits {
    /// An input comes; the effects that it leads to begin at this place.
    pub fn begin(&mut self, input: &Input, out: &[Effect]) -> usize {
        if let Input::Deadline(deadline) = input {
            self.set.remove(deadline);
        }
        out.len()
    }

    /// Panics if a suite that goes on waits for nothing that is sure to come.
    pub fn check(&mut self, effects: &[Effect], goes_on: bool) {
        for effect in effects {
            match effect {
                Effect::SetDeadline(deadline, _) => drop(self.set.insert(*deadline)),
                Effect::ClearDeadline(deadline) => drop(self.set.remove(deadline)),
                _ => {}
            }
        }
        assert!(!goes_on || self.set.iter().any(leads_on), "nothing is waited for: {:?}", self.set);
    }
}

/// Whether the suite gets nearer to its end by a deadline. The limits of the whole do
/// not count: each step has one of its own.
fn leads_on(deadline: &Deadline) -> bool {
    !matches!(
        deadline,
        Deadline::Suite
            | Deadline::Shutdown
            | Deadline::Test(_, TestTimer::Slow)
            | Deadline::Fixture(_, FixtureTimer::CheckDue)
    )
}
