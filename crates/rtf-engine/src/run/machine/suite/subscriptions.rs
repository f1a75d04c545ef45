//! Notifies subscribed fixtures that an attempt is about to start, that its process has ended,
//! and of its verdict. The verdict waits for the reply to the second one, unless the runner
//! stopped the test. The next attempt waits for all replies; hooks do not, so that a recorder
//! never delays parking the robot.

use rtf_model::protocol::{
    Notification, Request, Subscription, TestEndedParams, TestFinishedParams, TestReport,
    TestReportedParams, TestStartedParams,
};
use rtf_model::{EventKind, Phase};

use super::SuiteMachine;
use crate::run::machine::context::Context;
use crate::run::machine::io::HostId;

/// Why a monitor of a test is not evaluated.
const NO_SIGNALS: &str = "there are no signals: declare one with `<signal>` in the suite";

impl SuiteMachine<'_> {
    /// Passes a report of a running test to the fixtures that subscribe to reports.
    pub(super) fn forward_report(
        &mut self,
        host: HostId,
        notification: &Notification,
        cx: &mut Context<'_>,
    ) {
        let Some(run) = self.scheduler.run_of_host(host) else { return };
        let is_subscribed = self.fixtures.any_subscribes_to(Subscription::TestReported);
        let report = match (notification, is_subscribed) {
            (Notification::Phase { phase: Phase::Setup }, true) => TestReport::SetupStarted {},
            (Notification::Sampled(samples), true) => TestReport::Sampled(samples.clone()),
            (Notification::Measured(measured), true) => TestReport::Measured(measured.clone()),
            (Notification::Monitor(monitor), true) => TestReport::Monitor(monitor.clone()),
            (Notification::Monitor(monitor), false) => {
                let text = format!("the monitor `{}` is not evaluated: {NO_SIGNALS}", monitor.name);
                return run.report_error(text, cx);
            }
            _ => return,
        };
        self.fixtures.forward(&TestReportedParams { test: run.id(), report }, cx);
    }

    /// Notifies of the next tests, each once, and starts those of which no reply is
    /// pending; false if none was started.
    pub(super) fn notify_then_start(&mut self, cx: &mut Context<'_>) -> bool {
        while self.scheduler.begin_next() {}
        while let Some(test) = self.scheduler.next_to_notify(cx.now()) {
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
