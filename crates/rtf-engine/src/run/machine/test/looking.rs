//! A test that has ended, and waits for what is seen of the fixtures.

use super::{Process, TestRun};
use crate::run::machine::io::{Deadline, TestTimer};
use crate::run::machine::suite::Context;

impl TestRun<'_> {
    /// Whether its process has ended.
    pub fn has_ended(&self) -> bool {
        self.process != Process::Alive
    }

    /// Whether its verdict depends on whether fixtures live.
    pub fn is_looking(&self) -> bool {
        matches!(self.process, Process::Looking | Process::Settling)
    }

    /// All fixtures have passed: so has the test. One that did not pass waits a moment
    /// longer, since what broke its connection may be a part of a fixture that is about
    /// to die.
    pub fn seen_alive(&mut self) {
        if self.process == Process::Looking {
            self.process = Process::Over;
        }
    }

    /// A fixture is dying: its end, or its limit, makes this one collapsed.
    pub fn seen_dying(&mut self, cx: &mut Context<'_>) {
        if self.is_looking() {
            cx.clear(Deadline::Test(self.plan.id, TestTimer::Limit));
        }
    }
}
