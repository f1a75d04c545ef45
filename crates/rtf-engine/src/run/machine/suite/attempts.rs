//! Finishes an attempt of a test and schedules the next one: a retry, a rerun after a
//! collapse, or a repetition.

use std::time::Duration;

use rtf_model::{EventKind, StopCause, TestId, Verdict};

use super::SuiteMachine;
use super::active_test::AttemptNumber;
use crate::run::machine::context::Context;
use crate::run::machine::io::Deadline;
use crate::run::machine::test::{FinishedAttempt, TestRun};
use rtf_plan::plan::{AfterCollapse, TestPlan};

fn is_known_failure(plan: &TestPlan, verdict: Verdict) -> bool {
    plan.expected.as_ref().is_some_and(|expected| expected.covers(verdict))
}

/// A collapse is not retried, since it has a separate rule; nothing follows a failed
/// critical assertion. A known failure needs no second attempt.
fn is_retried(plan: &TestPlan, number: AttemptNumber, finished: &FinishedAttempt) -> bool {
    use Verdict::{Crashed, Error, Failed, TimedOut};
    matches!(finished.judgement.verdict, Failed | Error | Crashed | TimedOut)
        && number.retries < plan.settings.retries.count
        && finished.critical.is_none()
        && !is_known_failure(plan, finished.judgement.verdict)
}

impl<'p> SuiteMachine<'p> {
    pub(super) fn on_attempt_finished(
        &mut self,
        test: TestId,
        run: &TestRun<'p>,
        mut finished: FinishedAttempt,
        cx: &mut Context<'_>,
    ) {
        let Some(active) = self.scheduler.get(test) else { return };
        let (plan, number, stopped) = (active.plan, active.number, active.stop_reason.take());
        let continues = self.end_reason.is_none() && stopped.is_none();
        let has_collapsed = finished.judgement.verdict == Verdict::Collapsed;
        let retry = continues && is_retried(plan, number, &finished);
        let after = plan.settings.after_collapse;
        active.carried = finished.carried.take().filter(|_| continues);
        let rerun = retry || (continues && has_collapsed && after == AfterCollapse::Rerun);
        let mut event = run.finished_event(&finished, rerun);
        if has_collapsed && after == AfterCollapse::Skip {
            event.verdict = Verdict::Skipped;
        }
        if !is_known_failure(plan, event.verdict) {
            self.fails.count(&event);
        }
        cx.emit(EventKind::TestFinished(event));
        self.faults.clear(test);
        self.is_checked = self.close_examination(test);
        self.end_if_critical(plan, &finished, rerun);
        let soak = &mut self.scheduler.soak;
        let next = number.next(rerun, soak.last_repetition(plan));
        match (next, stopped) {
            (next, Some(reason)) if next.is_some() || soak.is_timed() => {
                cx.emit(EventKind::TestSkipped { test, reason });
                soak.exclude(test);
                self.scheduler.remove(test);
            }
            (Some(next), _) => {
                self.set_next(test, next, retry.then_some(plan.settings.retries.delay), cx)
            }
            (None, _) => self.scheduler.remove(test),
        }
        if self.scheduler.hand_over_host(plan, run, cx) {
            self.hooks.on_test_start();
            if let Some(reason) = &self.end_reason {
                self.scheduler.stop_all(StopCause::Interrupt, reason, cx);
            }
        }
    }

    fn end_if_critical(&mut self, plan: &TestPlan, finished: &FinishedAttempt, rerun: bool) {
        let (name, verdict) = (&plan.name, finished.judgement.verdict);
        let reason = match &finished.critical {
            Some(text) => format!("a critical assertion of `{name}` did not hold: {text}"),
            None if plan.settings.critical
                && !verdict.is_green()
                && !is_known_failure(plan, verdict)
                && !rerun =>
            {
                format!("the critical test `{name}` did not pass: it is {verdict}")
            }
            None => return,
        };
        if self.episodes.is_running() {
            return self.scheduler.end_round();
        }
        if self.plan.settings.critical_stops_run {
            self.fails.stop(format!("suite `{}` ends the run: {reason}", self.plan.name));
        }
        self.end_early(reason);
    }

    fn set_next(
        &mut self,
        test: TestId,
        next: AttemptNumber,
        retry_delay: Option<Duration>,
        cx: &mut Context<'_>,
    ) {
        let Some(active) = self.scheduler.get(test) else { return };
        active.number = next;
        if let Some(delay) = retry_delay {
            active.number.retries += 1;
            active.is_delayed = delay > Duration::ZERO;
            if active.is_delayed {
                cx.set(Deadline::Retry(test), delay);
            }
        }
    }

    pub(super) fn on_retry_due(&mut self, test: TestId) {
        if let Some(active) = self.scheduler.get(test) {
            active.is_delayed = false;
            self.is_checked = false;
        }
    }
}
