//! A test that fails is tried again, if its suite says so.

use std::time::Duration;

use rtf_model::Verdict;

use super::{Context, SuiteMachine};
use crate::run::machine::io::Deadline;
use crate::run::machine::test::Ended;

impl SuiteMachine<'_> {
    /// Whether the running test, which has ended so, is tried again. A collapse
    /// has a rule of its own, and after a critical assertion nothing follows.
    pub(super) fn is_retried(&self, ended: &Ended) -> bool {
        use Verdict::{Crashed, Error, Failed, TimedOut};
        let plan = &self.plan.tests[self.cursor.test];
        matches!(ended.verdict, Failed | Error | Crashed | TimedOut)
            && self.cursor.retries < plan.retries.count
            && ended.critical.is_none()
            && self.ending.is_none()
            && self.given_up.is_none()
    }

    /// The next attempt is a retry, after this time.
    pub(super) fn retry(&mut self, delay: Duration, cx: &mut Context<'_>) {
        self.cursor.retries += 1;
        if delay > Duration::ZERO {
            self.waiting = true;
            cx.set(Deadline::Retry, delay);
        }
    }
}
