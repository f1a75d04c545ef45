//! How a suite, or one of its tests, is ended early: by the suite's own limit, by a
//! stop request, by a person, and by force when that takes too long.

use rtf_model::{Diagnostic, EventKind, StopCause, TestId, Trigger};

use super::{Context, SuiteMachine};
use crate::run::machine::io::{Deadline, Stop, StopLevel};

impl SuiteMachine<'_> {
    /// Whether it waits for what the suite's clock shows.
    #[must_use]
    pub fn follows_clock(&self) -> bool {
        self.turns.follow_clock()
    }

    pub(super) fn limit_reached(&mut self, cx: &mut Context<'_>) {
        let limit = self.plan.timeout.unwrap_or_default();
        let reason = format!("the suite did not end within {limit:?}");
        self.hooks.call(Trigger::Timeout, &reason, self.turns.only_one());
        // No test shows it when the tear-down takes too long.
        self.fixtures.note_late(&reason, self.turns.all_ended());
        self.turns.stop_all(StopCause::Timeout, &reason, cx);
        self.end_early(reason);
    }

    pub(super) fn stop(&mut self, stop: Stop, cx: &mut Context<'_>) {
        let reason = format!("stopped by {}", stop.reason);
        // Of requests that come at once only the last may arrive, whatever its level.
        if !std::mem::replace(&mut self.interrupted, true) && self.started {
            self.hooks.call(Trigger::Interrupt, &reason, self.turns.only_one());
        }
        self.turns.stop_all(StopCause::Interrupt, &reason, cx);
        match stop.level {
            StopLevel::TearDown if self.started && self.shutdown.is_none() => {
                cx.set(Deadline::Shutdown, stop.limit);
                self.shutdown = Some((stop.limit, stop.reason));
            }
            StopLevel::TearDown => {}
            StopLevel::Kill => self.kill(None, cx),
            StopLevel::KillHooks => {
                self.kill(None, cx);
                self.hooks.kill_all(cx);
            }
        }
        self.end_early(reason);
    }

    /// Stops a test, if it runs. The suite goes on with the others.
    pub(super) fn stop_test(&mut self, test: TestId, by: &str, cx: &mut Context<'_>) {
        let Some(turn) = self.turns.of_test(test) else { return };
        let Some(run) = &mut turn.run else { return };
        let reason = format!("stopped by {by}");
        run.stop(StopCause::Interrupt, reason.clone(), cx);
        let about = (turn.plan.id, turn.plan.name.clone());
        turn.given_up.get_or_insert_with(|| reason.clone());
        self.hooks.call(Trigger::Interrupt, &reason, Some(about));
    }

    /// Stops the running tests, and skips the rest of the suite.
    pub(super) fn skip(&mut self, by: &str, cx: &mut Context<'_>) {
        let reason = format!("skipped by {by}");
        if self.started {
            self.hooks.call(Trigger::Interrupt, &reason, self.turns.only_one());
        }
        self.turns.stop_all(StopCause::Interrupt, &reason, cx);
        self.end_early(reason);
    }

    /// From now on it goes on as after a second stop request.
    pub(super) fn shutdown_took_too_long(&mut self, cx: &mut Context<'_>) {
        let Some((limit, by)) = &self.shutdown else { return };
        let reason = format!("the run did not end within {limit:?} of {by}");
        let message = format!("{reason}: what was left was killed");
        let diagnostic = Diagnostic::warning("shutdown-timeout", message)
            .hint("`--shutdown-timeout` says how long tear-downs and hooks may take");
        cx.emit(EventKind::Warning { diagnostic });
        self.kill(Some(&reason), cx);
    }

    /// Kills the running tests and all fixtures, without tear-down.
    fn kill(&mut self, why: Option<&str>, cx: &mut Context<'_>) {
        self.turns.running().for_each(|run| run.kill(cx));
        cx.clear(Deadline::Shutdown);
        self.fixtures.kill_all(why, cx);
    }

    /// A process was killed and does not end. It may have the robot: nothing else is
    /// started beside it.
    pub(super) fn end_if_abandoned(&mut self, cx: &mut Context<'_>) {
        let Some(whose) = cx.abandoned.take() else { return };
        let reason = format!("{whose} was killed and did not end");
        let diagnostic = Diagnostic::warning("process-not-ended", reason.clone())
            .note("the rest of the suite is skipped, since the process may still use the robot")
            .hint("it waits in the kernel: `ps -eo pid,stat,wchan:32,args` shows for what");
        cx.emit(EventKind::Warning { diagnostic });
        self.turns.stop_all(StopCause::Interrupt, &reason, cx);
        self.end_early(reason);
    }

    pub(super) fn end_early(&mut self, reason: String) {
        self.ending.get_or_insert(reason);
    }

    /// A critical test or assertion failed: the suite ends, and perhaps the run.
    pub(super) fn end_critically(&mut self, reason: String) {
        if self.plan.critical_stops_run {
            self.fails.stop(format!("suite `{}` ends the run: {reason}", self.plan.name));
        }
        self.end_early(reason);
    }
}
