//! Handles the notifications of a test: phases, messages, measurements and samples.

use rtf_model::protocol::Notification;
use rtf_model::{CaseId, EventKind, Message, MessageKind, Phase, Verdict};

use super::TestRun;
use super::cases::FinishedCase;
use super::questions::ENDED;
use crate::hook::PROVIDED;
use crate::run::machine::context::{Context, error_message};
use crate::run::machine::judge::TestProblem;

impl TestRun<'_> {
    pub(super) fn on_notification(&mut self, notification: Notification, cx: &mut Context<'_>) {
        let test = self.plan.id;
        match notification {
            Notification::Phase { phase } => self.enter_phase(phase, cx),
            Notification::Message(message) => self.report(message, cx),
            Notification::Measured(mut measurement) => {
                measurement.case = self.cases.open(measurement.case);
                measurement.learned = false;
                self.plan.learned.iter().for_each(|limits| limits.apply(&mut measurement));
                let problem = (measurement.problem(), measurement.case);
                self.record(problem, EventKind::Measured { test, fixture: None, measurement }, cx);
            }
            Notification::Sampled(mut samples) => {
                samples.case = self.cases.open(samples.case);
                samples.since = None;
                let problem = (samples.problem(), samples.case);
                self.record(problem, EventKind::Sampled { test, samples }, cx);
            }
            Notification::Stack { text } => self.on_host_dump(text, cx),
            Notification::CasesPlanned { names } => self.plan_cases(names, cx),
            Notification::CaseStarted(start) => self.start_case(start, cx),
            Notification::CaseFinished { case, outcome, reason, duration_us, rerun, episode } => {
                let finished = FinishedCase { case, outcome, reason, duration_us, rerun, episode };
                self.finish_case(finished, cx);
            }
            Notification::ProcessesLeft { case, processes } => {
                self.on_processes_left(case, processes, cx);
            }
            Notification::QuestionAsked(question) => self.ask_person(question, cx),
            // Handled by the task of the process.
            Notification::Attached(_) | Notification::Trajectory(_) => {}
            Notification::Provided { .. } => self.report_error(PROVIDED.to_owned(), cx),
            Notification::Collapsed { .. } => self.on_fixture_notification("collapsed", cx),
            // `SuiteMachine::forward_report` passes it to a fixture, or reports why not.
            Notification::Monitor(_) => {}
            Notification::Finding(_) => self.on_fixture_notification("finding", cx),
            Notification::Observed { .. } => self.on_fixture_notification("observed", cx),
            Notification::FaultInjected(_) => self.on_fixture_notification("fault-injected", cx),
            Notification::FaultRemoved { .. } => self.on_fixture_notification("fault-removed", cx),
        }
    }

    fn on_fixture_notification(&mut self, method: &str, cx: &mut Context<'_>) {
        self.on_protocol_error(format!("sent `{method}`, which is for fixtures"), cx);
    }

    fn enter_phase(&mut self, phase: Phase, cx: &mut Context<'_>) {
        if phase <= self.phase || phase >= Phase::Exit || self.evidence.answer.is_some() {
            let what = format!("entered {phase} after {}", self.phase);
            return self.on_protocol_error(what, cx);
        }
        if phase == Phase::TearDown {
            self.close_questions(ENDED, cx);
        }
        self.phase = phase;
        cx.emit(EventKind::TestPhase { test: self.plan.id, phase });
        if self.step.is_some() {
            return;
        }
        let limits = &self.plan.limits;
        if phase == Phase::Run && self.slots.is_some() {
            // Each episode has a limit.
            return self.set_limit(limits.run, cx);
        }
        let limit = match phase {
            Phase::Setup => limits.setup,
            Phase::Run => limits.run,
            _ => limits.teardown,
        };
        let slow = Some(limits.slow).filter(|slow| phase == Phase::Run && *slow < limit);
        self.set_phase_limit(limit, slow, cx);
    }

    fn report(&mut self, mut message: Message, cx: &mut Context<'_>) {
        message.case = self.cases.open(message.case);
        let verdict = match message.kind {
            MessageKind::Failure => Some(Verdict::Failed),
            MessageKind::Error => Some(Verdict::Error),
            MessageKind::Report | MessageKind::Check => None,
        };
        if let Some(verdict) = verdict {
            self.record_case_problem(message.case, verdict, message.text.clone());
        }
        if message.critical && message.kind != MessageKind::Check && self.critical.is_none() {
            self.critical = Some(message.text.clone());
        }
        cx.emit(EventKind::Message { source: self.source(), message, test: None });
    }

    fn record(
        &mut self,
        (problem, case): (Option<String>, Option<CaseId>),
        result: EventKind,
        cx: &mut Context<'_>,
    ) {
        if let Some(problem) = problem {
            self.record_case_problem(case, Verdict::Failed, problem);
        }
        cx.emit(result);
    }

    pub(in crate::run::machine) fn report_error(&mut self, text: String, cx: &mut Context<'_>) {
        self.report(error_message(text), cx);
    }

    /// Records the first failure or error of a case, or of the test outside of cases.
    fn record_case_problem(&mut self, case: Option<CaseId>, verdict: Verdict, reason: String) {
        match case.and_then(|case| self.cases.get_mut(case)) {
            Some(case) => {
                case.record(TestProblem { verdict, reason, phase: self.phase, case: None })
            }
            None => self.record_problem(verdict, reason),
        }
    }

    /// Records the first failure or error. Only `run` can show that the robot is wrong;
    /// a failure in another phase is an error of the bench.
    pub(super) fn record_problem(&mut self, verdict: Verdict, reason: String) {
        let verdict = if self.phase == Phase::Run { verdict } else { Verdict::Error };
        let phase = self.phase;
        self.evidence.first_problem.get_or_insert(TestProblem {
            verdict,
            reason,
            phase,
            case: None,
        });
    }
}
