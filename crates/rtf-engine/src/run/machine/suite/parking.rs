//! Which hooks the suite calls for, and that they wait for no recorder.

use rtf_model::protocol::TestAttempt;
use rtf_model::{Trigger, Verdict};

use super::{Context, SuiteMachine};

impl SuiteMachine<'_> {
    /// Calls for the hooks after an attempt.
    pub(super) fn call_hooks(
        &mut self,
        test: &TestAttempt,
        verdict: Verdict,
        reason: Option<&str>,
    ) {
        let trigger = match verdict {
            Verdict::Failed | Verdict::Error | Verdict::Crashed => Trigger::Failure,
            Verdict::TimedOut => Trigger::Timeout,
            _ => return,
        };
        let reason = format!("`{}` is {verdict}: {}", test.name, reason.unwrap_or_default());
        self.hooks.call(trigger, &reason, Some((test.id, test.name.clone())));
    }

    /// Fixtures are being told of tests that are judged. Hooks need not wait for that.
    pub(super) fn park_or_begin_beside(&mut self, cx: &mut Context<'_>) {
        let parks = self.hooks.run_next(cx) || (self.ending.is_some() && self.run_end_hooks(cx));
        if parks {
            self.checked = false;
        } else {
            self.begin_beside(cx);
        }
    }

    /// Calls for the `end` hooks, once; whether one of them runs now.
    pub(super) fn run_end_hooks(&mut self, cx: &mut Context<'_>) -> bool {
        if std::mem::replace(&mut self.end_called, true) {
            return false;
        }
        if self.fixtures.any_started() || self.turns.any_begun() {
            self.hooks.call(Trigger::End, "the suite ends", None);
        }
        self.hooks.run_next(cx)
    }
}
