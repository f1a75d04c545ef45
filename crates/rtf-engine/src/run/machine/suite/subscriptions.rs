//! Notifies subscribed fixtures that an attempt is about to start, that its process has ended,
//! and of its verdict. The verdict waits for the reply to the second one, unless the runner
//! stopped the test. The next attempt waits for all replies; hooks do not, so that a recorder
//! never delays parking the robot.

use rtf_model::protocol::{
    Request, Subscription, TestEndedParams, TestFinishedParams, TestStartedParams,
};
use rtf_model::{EventKind, Phase};

use super::SuiteMachine;
use crate::run::machine::context::Context;

impl SuiteMachine<'_> {
    /// Notifies of the next tests, each once, and starts those of which no reply is
    /// pending; false if none was started.
    pub(super) fn notify_then_start(&mut self, cx: &mut Context<'_>) -> bool {
        while self.scheduler.begin_next() {}
        while let Some(test) = self.scheduler.next_to_notify() {
            let topic = (Subscription::TestStarted, test.id);
            if self.fixtures.any_subscribes_to(topic.0) {
                let notification = Request::TestStarted(TestStartedParams { test });
                self.fixtures.notify(topic, &notification, cx);
            }
        }
        let mut any = false;
        while self.scheduler.start_next(|test| !self.fixtures.any_notified_of(test), cx) {
            any = true;
        }
        any
    }

    /// Judges ended tests, which may trigger hooks, and finishes those whose verdict all
    /// subscribers have received.
    pub(super) fn judge_tests(&mut self, cx: &mut Context<'_>) {
        while let Some((test, stopped)) = self.scheduler.take_end() {
            let topic = (Subscription::TestEnded, test.id);
            if self.fixtures.any_subscribes_to(topic.0) {
                let ended = Request::TestEnded(TestEndedParams { test, stopped });
                self.fixtures.notify(topic, &ended, cx);
            }
        }
        while let Some((test, verdict, reason)) =
            self.scheduler.judge_next(|test| !self.fixtures.any_notified_of(test), cx)
        {
            self.hooks.trigger_by_verdict(&test, verdict, reason.as_deref());
            let topic = (Subscription::TestFinished, test.id);
            let is_notified = self.fixtures.any_subscribes_to(topic.0);
            if is_notified || self.fixtures.any_notified_of(test.id) {
                cx.emit(EventKind::TestPhase { test: test.id, phase: Phase::Notify });
            }
            if is_notified {
                let ends = TestFinishedParams { test, verdict, reason, attachments_dir: None };
                self.fixtures.notify(topic, &Request::TestFinished(ends), cx);
            }
        }
        while let Some((test, run, finished)) =
            self.scheduler.take_finished(|test| !self.fixtures.any_notified_of(test))
        {
            self.on_attempt_finished(test, &run, finished, cx);
        }
    }
}
