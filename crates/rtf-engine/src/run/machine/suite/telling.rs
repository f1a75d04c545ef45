//! Fixtures that asked for it are told that an attempt of a test is about to begin,
//! and how it was judged. The next attempt waits until they have heard it; hooks do
//! not: a robot is not parked later because something is being recorded.

use rtf_model::protocol::{Request, Subscription, TestFinishedParams, TestStartedParams};
use rtf_model::{EventKind, Phase};

use super::{Context, SuiteMachine};

impl SuiteMachine<'_> {
    /// Tells of the tests that are next, each once, and starts those of which all have
    /// heard; whether any was started.
    pub(super) fn tell_then_start(&mut self, cx: &mut Context<'_>) -> bool {
        while self.turns.open_next() {}
        while let Some(test) = self.turns.tell_next() {
            let about = (Subscription::TestStarted, test.id);
            if self.fixtures.any_hears(about.0) {
                let told = Request::TestStarted(TestStartedParams { test });
                self.fixtures.tell(about, &told, cx);
            }
        }
        let mut any = false;
        while self.turns.start_next(|test| !self.fixtures.any_told_of(test), cx) {
            any = true;
        }
        any
    }

    /// Looks which running tests are judged, which calls for hooks, and which of
    /// them are over: all fixtures have heard how.
    pub(super) fn look_over(&mut self, cx: &mut Context<'_>) {
        while let Some((test, verdict, reason)) = self.turns.judge_next(cx) {
            self.call_hooks(&test, verdict, reason.as_deref());
            let about = (Subscription::TestFinished, test.id);
            if self.fixtures.any_hears(about.0) {
                cx.emit(EventKind::TestPhase { test: test.id, phase: Phase::Notify });
                let ends = TestFinishedParams { test, verdict, reason, attachments_dir: None };
                self.fixtures.tell(about, &Request::TestFinished(ends), cx);
            }
        }
        while let Some((test, run, ended)) =
            self.turns.take_end(|test| !self.fixtures.any_told_of(test))
        {
            self.test_ended(test, &run, &ended, cx);
        }
    }
}
