//! A test that fails is tried again, if its suite says so.

use std::time::Duration;

use rtf_model::{TestId, Verdict};

use super::{Context, Cursor, SuiteMachine};
use crate::run::machine::io::Deadline;
use crate::run::machine::test::Ended;
use rtf_plan::plan::TestPlan;

/// Whether an attempt that has ended so is tried again. A collapse has a rule of
/// its own, and after a critical assertion nothing follows.
pub(super) fn is_retried(plan: &TestPlan, cursor: Cursor, ended: &Ended) -> bool {
    use Verdict::{Crashed, Error, Failed, TimedOut};
    matches!(ended.verdict, Failed | Error | Crashed | TimedOut)
        && cursor.retries < plan.retries.count
        && ended.critical.is_none()
}

impl SuiteMachine<'_> {
    /// A test goes on with a further attempt; if it is a retry, after a time.
    pub(super) fn goes_on(
        &mut self,
        test: TestId,
        next: Cursor,
        retry: Option<Duration>,
        cx: &mut Context<'_>,
    ) {
        let Some(turn) = self.turns.of_test(test) else { return };
        turn.cursor = next;
        if let Some(delay) = retry {
            turn.cursor.retries += 1;
            turn.waits = delay > Duration::ZERO;
            if turn.waits {
                cx.set(Deadline::Retry(test), delay);
            }
        }
    }

    /// A retry has waited long enough.
    pub(super) fn retry_is_due(&mut self, test: TestId) {
        if let Some(turn) = self.turns.of_test(test) {
            turn.waits = false;
            self.checked = false;
        }
    }
}
