//! Ends a suite or one of its tests early: at the suite's limit, on a stop request, or by
//! a user; kills it when that takes too long.

use rtf_model::{Diagnostic, EventKind, StopCause, TestId, Trigger};

use super::SuiteMachine;
use crate::run::machine::context::Context;
use crate::run::machine::io::{Deadline, Stop, StopLevel};

impl SuiteMachine<'_> {
    pub(super) fn on_suite_timeout(&mut self, cx: &mut Context<'_>) {
        let limit = self.plan.settings.timeout.unwrap_or_default();
        let reason = format!("the suite did not end within {limit:?}");
        self.hooks.trigger(Trigger::Timeout, &reason, self.scheduler.only_running_test());
        // A tear-down that takes too long is visible in no test.
        self.fixtures.record_late_stop(&reason, self.scheduler.all_exited());
        self.stop_and_end(StopCause::Timeout, reason, cx);
    }

    pub(super) fn on_stop_request(&mut self, stop: Stop, cx: &mut Context<'_>) {
        let reason = format!("stopped by {}", stop.reason);
        // The first request may have been superseded by one of a higher level.
        if !std::mem::replace(&mut self.is_interrupted, true) && self.is_started {
            self.hooks.trigger(Trigger::Interrupt, &reason, self.scheduler.only_running_test());
        }
        self.scheduler.stop_all(StopCause::Interrupt, &reason, cx);
        self.episodes.abandon();
        match stop.level {
            StopLevel::TearDown if self.is_started && self.shutdown.is_none() => {
                cx.set(Deadline::Shutdown, stop.limit);
                self.shutdown = Some((stop.limit, stop.reason));
            }
            StopLevel::TearDown => {}
            StopLevel::Kill => self.kill_all(None, cx),
            StopLevel::KillHooks => {
                self.kill_all(None, cx);
                self.hooks.kill_all(cx);
            }
        }
        self.end_early(reason);
    }

    /// Stops a test, if it runs. The suite continues with the others.
    pub(super) fn stop_test(&mut self, test: TestId, by: &str, cx: &mut Context<'_>) {
        let Some(active) = self.scheduler.get(test) else { return };
        let Some(run) = &mut active.run else { return };
        let reason = format!("stopped by {by}");
        run.stop(StopCause::Interrupt, reason.clone(), cx);
        let about = (active.plan.id, active.plan.name.clone());
        active.stop_reason.get_or_insert_with(|| reason.clone());
        self.hooks.trigger(Trigger::Interrupt, &reason, Some(about));
    }

    /// Stops the running tests, and skips the rest of the suite.
    pub(super) fn skip_rest(&mut self, by: &str, cx: &mut Context<'_>) {
        let reason = format!("skipped by {by}");
        self.episodes.abandon();
        if self.is_started {
            self.hooks.trigger(Trigger::Interrupt, &reason, self.scheduler.only_running_test());
        }
        self.stop_and_end(StopCause::Interrupt, reason, cx);
    }

    /// Continues as after a second stop request.
    pub(super) fn on_shutdown_timeout(&mut self, cx: &mut Context<'_>) {
        let Some((limit, by)) = &self.shutdown else { return };
        let reason = format!("the run did not end within {limit:?} of {by}");
        let message = format!("{reason}: the remaining processes were killed");
        let diagnostic = Diagnostic::warning("shutdown-timeout", message)
            .hint("`--shutdown-timeout` sets how long tear-downs and hooks may take");
        cx.emit(EventKind::Warning { diagnostic });
        self.kill_all(Some(&reason), cx);
    }

    /// Kills the running tests and all fixtures, without tear-down.
    fn kill_all(&mut self, reason: Option<&str>, cx: &mut Context<'_>) {
        self.scheduler.runs_mut().for_each(|run| run.kill(cx));
        cx.clear(Deadline::Shutdown);
        self.fixtures.kill_all(reason, cx);
    }

    /// A process was killed and does not end. It may still use the robot: nothing else is
    /// started.
    pub(super) fn end_if_abandoned(&mut self, cx: &mut Context<'_>) {
        let Some(process) = cx.take_abandoned() else { return };
        let reason = format!("{process} was killed and did not end");
        let diagnostic = Diagnostic::warning("process-not-ended", reason.clone())
            .note("the rest of the suite is skipped, since the process may still use the robot")
            .hint("it waits in the kernel: `ps -eo pid,stat,wchan:32,args` shows where");
        cx.emit(EventKind::Warning { diagnostic });
        self.episodes.abandon();
        self.stop_and_end(StopCause::Interrupt, reason, cx);
    }

    fn stop_and_end(&mut self, cause: StopCause, reason: String, cx: &mut Context<'_>) {
        self.scheduler.stop_all(cause, &reason, cx);
        self.end_early(reason);
    }

    pub(super) fn end_early(&mut self, reason: String) {
        self.end_reason.get_or_insert(reason);
    }
}
