//! One attempt of a test, from its start to the end of its process.

mod carried_cases;
mod case_reruns;
mod cases;
pub mod host;
mod notifications;
mod questions;
mod slots;
mod stop;
mod stopwatch;
mod verdict;

use std::time::Duration;

use rtf_model::protocol::{Reply, StackSupport};
use rtf_model::{EventKind, LeakedProcess, Phase, Source, StopCause, TestId, Verdict};

use crate::run::machine::context::Context;
use crate::run::machine::host_replies::{parse_answer, parse_initialized};
use crate::run::machine::io::{Deadline, Effect, HostId, ProcessEvent, TestTimer};
use crate::run::machine::judge::Evidence;
use crate::run::machine::output_capture::OutputCapture;
pub use carried_cases::CarriedCases;
use cases::OpenCases;
use host::{HostChoice, TestRequest};
use questions::{ENDED, OpenQuestion};
use rtf_plan::plan::{SuitePlan, TestPlan};
use rtf_process::codec::INITIALIZE;
pub use slots::EpisodeSource;
use slots::Slots;
use stop::StopStep;
use stopwatch::Stopwatch;
use verdict::AttemptState;
pub use verdict::FinishedAttempt;

#[derive(Debug)]
pub struct TestRun<'p> {
    plan: &'p TestPlan,
    host: HostId,
    /// The number of its `run-test`.
    request: u64,
    /// Whether its host can serve several tests.
    shares_host: bool,
    /// Whether its host stays alive for further tests.
    is_released: bool,
    phase: Phase,
    evidence: Evidence,
    stack: StackSupport,
    stack_dumps: u32,
    /// Whether one arrived since the runner asked for it.
    has_stack_dump: bool,
    step: Option<StopStep>,
    kills: u32,
    /// With a simulated clock: the wall-clock limit, as a multiple of each limit.
    backstop: Option<u32>,
    /// With a simulated clock: measures the phase.
    stopwatch: Option<Stopwatch>,
    state: AttemptState,
    /// Whether fixtures were notified that its process has ended.
    is_end_notified: bool,
    has_fixtures: bool,
    /// What it left behind, apart from what one of its cases left.
    left: Vec<LeakedProcess>,
    output: OutputCapture,
    cases: OpenCases,
    /// Of a test that runs many episodes: those that its host has.
    slots: Option<Box<Slots>>,
    /// Its questions that wait for an answer.
    questions: Vec<OpenQuestion>,
    /// The runner reads its messages more slowly.
    is_throttled: bool,
    /// Whether its host can select cases.
    selects_cases: bool,
    /// The cases that a rerun after a collapse does not run again.
    carried: Option<Box<CarriedCases>>,
    /// The critical assertion that failed.
    critical: Option<String>,
    finished: Option<FinishedAttempt>,
}

impl<'p> TestRun<'p> {
    pub fn start(
        suite: &SuitePlan,
        plan: &'p TestPlan,
        attempt: u32,
        (choice, request): (HostChoice, TestRequest<'_>),
        cx: &mut Context<'_>,
    ) -> Self {
        let repetition = request.repetition;
        cx.emit(EventKind::TestStarted { test: plan.id, repetition, attempt });
        let (host, number) = host::acquire(suite, plan, (choice, request), cx);
        cx.set(Deadline::Test(plan.id, TestTimer::Limit), plan.limits.load);
        Self {
            plan,
            host,
            request: number,
            shares_host: !matches!(choice, HostChoice::New),
            is_released: false,
            phase: Phase::Load,
            evidence: Evidence::default(),
            stack: StackSupport::None,
            stack_dumps: 0,
            has_stack_dump: false,
            step: None,
            kills: 0,
            backstop: suite.clock.as_ref().map(|clock| clock.backstop),
            stopwatch: None,
            state: AttemptState::Running,
            is_end_notified: false,
            has_fixtures: !suite.fixtures.is_empty(),
            left: Vec::new(),
            output: OutputCapture::new(Source::Test(plan.id)),
            cases: OpenCases::new(plan),
            slots: plan.slots.map(|slots| Box::new(Slots::new(slots))),
            questions: Vec::new(),
            is_throttled: false,
            selects_cases: false,
            carried: None,
            critical: None,
            finished: None,
        }
    }

    pub fn id(&self) -> TestId {
        self.plan.id
    }

    pub fn host(&self) -> HostId {
        self.host
    }

    fn source(&self) -> Source {
        Source::Test(self.plan.id)
    }

    fn set_limit(&self, after: Duration, cx: &mut Context<'_>) {
        cx.set(Deadline::Test(self.plan.id, TestTimer::Limit), after);
    }

    fn clear(&self, timer: TestTimer, cx: &mut Context<'_>) {
        cx.clear(Deadline::Test(self.plan.id, timer));
    }

    pub fn handle(&mut self, input: ProcessEvent, cx: &mut Context<'_>) {
        match input {
            ProcessEvent::SpawnFailed(reason) => {
                self.record_problem(Verdict::Error, reason);
                self.state = AttemptState::Ended;
            }
            ProcessEvent::Exited(status, leaked) => self.on_exit(Some(status), leaked, cx),
            ProcessEvent::LeaderEnded(..) => self.on_leader_end(cx),
            ProcessEvent::Released => {
                self.is_released = true;
                self.on_exit(None, Vec::new(), cx);
            }
            ProcessEvent::Notified(notification) => self.on_notification(notification, cx),
            ProcessEvent::Attached(Ok(mut attachment)) => {
                attachment.case = self.cases.open(attachment.case);
                cx.emit(EventKind::Attached { test: self.plan.id, fixture: None, attachment });
            }
            ProcessEvent::Attached(Err(reason)) => self.report_error(reason, cx),
            ProcessEvent::Replied(INITIALIZE, reply) => self.on_initialized(reply, cx),
            ProcessEvent::Replied(id, reply) if id == self.request => self.on_answer(reply, cx),
            ProcessEvent::Replied(id, _) => {
                self.on_protocol_error(format!("answered request {id}"), cx);
            }
            ProcessEvent::ProtocolViolated(what) => self.on_protocol_error(what, cx),
            ProcessEvent::Printed(stream, bytes) => self.output.push(stream, &bytes, cx),
            ProcessEvent::StackDumped(text) => self.on_debugger_dump(text, cx),
            ProcessEvent::ResourcesMeasured { usage, tests_served } => {
                let source = self.source();
                cx.emit(EventKind::ResourcesMeasured { source, usage, tests_served });
            }
            ProcessEvent::Throttled => self.set_throttled(true),
            ProcessEvent::Resumed => self.set_throttled(false),
            ProcessEvent::NotStarted(_)
            | ProcessEvent::ValueRead { .. }
            | ProcessEvent::ProbesPassed
            | ProcessEvent::ProbePending(_)
            | ProcessEvent::ProbeFailed(_)
            | ProcessEvent::Alive
            | ProcessEvent::Dying => {}
        }
    }

    fn on_initialized(&mut self, reply: Reply<serde_json::Value>, cx: &mut Context<'_>) {
        match parse_initialized(reply) {
            Ok(initialized) => {
                self.stack = initialized.stack;
                self.shares_host = self.plan.settings.shared && initialized.supports_shared;
                let needs_support = self.selects_cases
                    || self.plan.cases.as_ref().is_some_and(|it| it.needs_support());
                self.selects_cases = initialized.selects_cases;
                if needs_support && !initialized.selects_cases {
                    let reason = format!("{} cannot select cases", initialized.host);
                    self.stop(StopCause::Protocol, reason, cx);
                }
                if self.slots.is_some() && !initialized.runs_episodes {
                    let reason = format!("{} cannot run a test with `slots`", initialized.host);
                    self.stop(StopCause::Protocol, reason, cx);
                }
            }
            Err(what) => self.on_protocol_error(what, cx),
        }
    }

    fn on_answer(&mut self, reply: Reply<serde_json::Value>, cx: &mut Context<'_>) {
        if self.evidence.answer.is_some() {
            return self.on_protocol_error("answered the same request twice".to_owned(), cx);
        }
        match parse_answer(reply) {
            Ok(answer) => {
                if !answer.as_ref().is_ok_and(|answer| answer.continues) {
                    cx.push(Effect::CloseChannel(self.host));
                }
                self.close_questions(ENDED, cx);
                self.evidence.answer = Some(answer);
                self.phase = Phase::Exit;
                self.stopwatch = None;
                self.clear(TestTimer::Slow, cx);
                if self.step.is_none() {
                    self.set_limit(self.plan.limits.teardown, cx);
                }
            }
            Err(what) => self.on_protocol_error(what, cx),
        }
    }

    fn on_protocol_error(&mut self, what: String, cx: &mut Context<'_>) {
        self.stop(StopCause::Protocol, format!("the host broke the protocol: {what}"), cx);
    }
}
