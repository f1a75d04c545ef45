//! From the end of a test's process to its verdict, which depends on the fixtures: a test
//! during which a fixture collapsed is collapsed.

use std::time::Duration;

use rtf_model::{
    CaseId, EventKind, ExitStatus, Finding, LeakedProcess, Message, MessageKind, StopCause,
    TestFinished, Verdict,
};

use super::questions::ENDED;
use super::{CarriedCases, TestRun};
use crate::run::machine::context::{Context, error_message};
use crate::run::machine::io::TestTimer;
use crate::run::machine::judge::{Judgement, describe_leak, judge, leak_problem};
use crate::run::machine::kill_escalation::killed_text;

/// How long a test that did not pass waits for a fixture's collapse: a connection breaks
/// before the kernel reports the death at its other end. A test that would pass waits for
/// the examination of all fixtures instead. Both wait for the end of a dying fixture.
pub(super) const COLLAPSE_WAIT: Duration = Duration::from_millis(200);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AttemptState {
    /// Its process is alive or is being started.
    Running,
    /// Its process has ended; it passes if all fixtures pass their examination.
    AwaitsExamination,
    /// Its process has ended; it did not pass, but a collapse may be the cause.
    AwaitsCollapse,
    /// It waits for nothing more.
    Ended,
    /// Its verdict is final.
    Judged,
}

#[derive(Debug)]
pub struct FinishedAttempt {
    pub judgement: Judgement,
    pub exit: Option<ExitStatus>,
    /// The critical assertion that failed.
    pub critical: Option<String>,
    /// After a collapse: the cases that a rerun does not run again.
    pub carried: Option<Box<CarriedCases>>,
}

impl TestRun<'_> {
    pub(super) fn on_exit(
        &mut self,
        exit: Option<ExitStatus>,
        leaked: Vec<LeakedProcess>,
        cx: &mut Context<'_>,
    ) {
        self.close_questions(ENDED, cx);
        self.stopwatch = None;
        self.clear(TestTimer::Slow, cx);
        self.output.finish(cx);
        self.record_left(leaked, cx);
        (self.evidence.exit, self.evidence.released) = (exit, self.is_released);
        let verdict = judge(&self.evidence, self.phase).verdict;
        let may_have_collapsed = self.has_fixtures && self.evidence.stopped.is_none();
        self.state = match (may_have_collapsed, !verdict.is_problem()) {
            (false, _) => AttemptState::Ended,
            (true, true) => AttemptState::AwaitsExamination,
            (true, false) => AttemptState::AwaitsCollapse,
        };
        match self.state {
            AttemptState::AwaitsCollapse => self.set_limit(COLLAPSE_WAIT, cx),
            _ => self.clear(TestTimer::Limit, cx),
        }
    }

    /// Records the processes that were left and killed: at the end of a stop, or as leaked.
    fn record_left(&mut self, left: Vec<LeakedProcess>, cx: &mut Context<'_>) {
        match &mut self.evidence.stopped {
            Some((_, reason, _)) if self.kills > 0 => {
                killed_text(&left).into_iter().for_each(|text| *reason += &format!("; {text}"));
            }
            _ => {
                self.left.extend_from_slice(&left);
                cx.report_leaked(self.source(), left);
            }
        }
    }

    /// The host killed processes that a program left behind. This is a problem of the case only if the
    /// program ran no other one.
    pub(super) fn on_processes_left(
        &mut self,
        case: Option<CaseId>,
        processes: Vec<LeakedProcess>,
        cx: &mut Context<'_>,
    ) {
        let policy = self.plan.settings.leaks;
        let case = self.cases.open(case);
        match case.and_then(|case| self.cases.get_mut(case)) {
            Some(open) => open.record_leak(leak_problem(policy, &processes)),
            None => self.left.extend_from_slice(&processes),
        }
        if let (Some(_), Some(text)) = (case, describe_leak(&processes)) {
            let message = Message { case, kind: MessageKind::Report, ..error_message(text) };
            cx.emit(EventKind::Message { source: self.source(), message, test: None });
        }
        cx.report_leaked(self.source(), processes);
    }

    /// A fixture found a problem, before the verdict.
    pub fn on_finding(&mut self, finding: Finding, cx: &mut Context<'_>) {
        let message = finding.message();
        if message.critical {
            self.critical.get_or_insert_with(|| finding.text.clone());
        }
        cx.emit(EventKind::Message { source: self.source(), message, test: None });
        self.evidence.record_finding(&finding, self.phase);
        if finding.severity.ends_test() {
            self.stop(StopCause::Finding, finding.text, cx);
        }
    }

    /// Whether fixtures have to be notified of the end of its process; true once.
    pub fn take_end(&mut self) -> bool {
        self.has_exited() && !std::mem::replace(&mut self.is_end_notified, true)
    }

    /// Whether it was asked to stop, which decides its verdict.
    pub fn was_stopped(&self) -> bool {
        self.evidence.stopped.is_some()
    }

    pub fn has_exited(&self) -> bool {
        self.state != AttemptState::Running
    }

    /// Whether its verdict still depends on the fixtures.
    pub fn awaits_fixtures(&self) -> bool {
        matches!(self.state, AttemptState::AwaitsExamination | AttemptState::AwaitsCollapse)
    }

    /// All fixtures have passed the examination.
    pub fn on_fixtures_alive(&mut self) {
        if self.state == AttemptState::AwaitsExamination {
            self.state = AttemptState::Ended;
        }
    }

    /// Waits for the end of the dying fixture or its limit; both are a collapse.
    pub fn on_fixture_dying(&mut self, cx: &mut Context<'_>) {
        if self.awaits_fixtures() {
            self.clear(TestTimer::Limit, cx);
        }
    }

    /// Decides verdict and reason, once, when it has ended.
    pub fn judge(&mut self, cx: &mut Context<'_>) -> Option<(Verdict, Option<String>)> {
        if self.state != AttemptState::Ended {
            return None;
        }
        self.clear(TestTimer::Limit, cx);
        self.clear(TestTimer::Slow, cx);
        self.close_cases(cx);
        let mut judgement = judge(&self.evidence, self.phase);
        let leak = leak_problem(self.plan.settings.leaks, &self.left);
        let unfinished = || self.slots.as_ref().and_then(|slots| slots.problem());
        let late_problem = leak.or_else(|| self.cases.not_run_problem()).or_else(unfinished);
        if let (Verdict::Passed, Some(problem)) = (judgement.verdict, late_problem) {
            (judgement.verdict, judgement.reason) = (Verdict::Error, Some(problem));
        }
        // Its host skipped only the cases that were left.
        if judgement.verdict == Verdict::Skipped && self.cases.any_carried_passed {
            (judgement.verdict, judgement.reason) = (Verdict::Passed, None);
        }
        self.state = AttemptState::Judged;
        let (exit, critical) = (self.evidence.exit, self.critical.take());
        let result = (judgement.verdict, judgement.reason.clone());
        let carried = self.carried.take();
        self.finished = Some(FinishedAttempt { judgement, exit, critical, carried });
        Some(result)
    }

    pub fn is_judged(&self) -> bool {
        self.state == AttemptState::Judged
    }

    /// Its result, once it is judged. The caller then emits [`Self::finished_event`].
    pub fn take_finished(&mut self) -> Option<FinishedAttempt> {
        self.finished.take()
    }

    /// The last event of this attempt.
    pub fn finished_event(&self, finished: &FinishedAttempt, rerun: bool) -> TestFinished {
        TestFinished {
            test: self.plan.id,
            verdict: finished.judgement.verdict,
            reason: finished.judgement.reason.clone(),
            phase: finished.judgement.phase,
            decided_by: finished.judgement.decided_by,
            exit: finished.exit,
            rerun,
        }
    }
}
