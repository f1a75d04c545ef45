//! Stops a test: a stack dump after a time-out, a request to stop, a stack dump after its
//! grace if there is none yet, SIGTERM, SIGKILL.

use std::time::Duration;

use rtf_model::protocol::Request;
use rtf_model::{EventKind, Phase, StopCause};

use super::{AttemptState, TestRun};
use crate::run::machine::context::Context;
use crate::run::machine::io::{Effect, SignalReach, TestTimer};
use crate::run::machine::kill_escalation::{KILL_WAIT, MAX_KILLS, SIGTERM, TERM_GRACE};
use rtf_process::stack_dump::{DEBUGGER_WAIT, HOST_DUMP_WAIT};

/// A backstop after the host's time: the task of the process gives up a stack dump earlier.
const STACK_DUMP_LIMIT: Duration = Duration::from_secs(14);

/// The number of stack dumps that a host can send unasked.
const MAX_STACK_DUMPS: u32 = 16;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StopStep {
    /// Waits for a stack dump; then the test is asked to stop.
    DumpThenAsk,
    Asked,
    /// Waits for a stack dump; then SIGTERM follows.
    DumpThenTerminate,
    Terminated,
    Killed,
}

impl TestRun<'_> {
    /// Asks the test to stop. The first cause decides.
    pub fn stop(&mut self, cause: StopCause, reason: String, cx: &mut Context<'_>) {
        // After its process has ended, only a collapse can still change the verdict.
        let is_late = self.has_exited() && cause != StopCause::Collapse;
        if self.evidence.stopped.is_some() || self.is_judged() || is_late {
            return;
        }
        cx.emit(EventKind::TestStopping { test: self.plan.id, cause, reason: reason.clone() });
        self.close_questions(&reason, cx);
        self.clear(TestTimer::Slow, cx);
        self.stopwatch = None;
        self.evidence.stopped = Some((cause, reason, self.phase));
        if let (StopCause::Collapse, true) = (cause, self.selects_cases) {
            let history = self.cases.history.take();
            self.carried = history.and_then(|history| history.carry(cx.now())).map(Box::new);
        }
        if self.has_exited() {
            self.state = AttemptState::Ended;
        } else if cause == StopCause::Timeout {
            self.dump_stack(StopStep::DumpThenAsk, cx);
        } else {
            self.ask(cx);
        }
    }

    fn dump_stack(&mut self, step: StopStep, cx: &mut Context<'_>) {
        self.step = Some(step);
        let wait = match self.plan.cases_in_programs {
            Some(_) => DEBUGGER_WAIT,
            None => HOST_DUMP_WAIT,
        };
        cx.push(Effect::DumpStack(self.host, self.stack, wait));
        self.set_limit(wait + STACK_DUMP_LIMIT, cx);
    }

    fn ask(&mut self, cx: &mut Context<'_>) {
        self.step = Some(StopStep::Asked);
        let reason = self.evidence.stopped.as_ref().map(|(_, reason, _)| reason.clone());
        let (reason, request) = (reason.unwrap_or_default(), Some(self.request));
        cx.send(self.host, None, Request::Interrupt { reason, request });
        self.set_limit(self.plan.limits.grace, cx);
    }

    /// The host dumps stacks at the request of the runner, or those of a program before it
    /// kills it.
    pub(super) fn on_host_dump(&mut self, text: String, cx: &mut Context<'_>) {
        let is_requested = self.step.is_some() && !self.has_stack_dump;
        if is_requested || self.stack_dumps < MAX_STACK_DUMPS {
            self.stack_dumps += 1;
            cx.emit(EventKind::StackDumped { source: self.source(), text });
        }
        self.after_stack_dump(cx);
    }

    /// The fallback for a host that does not dump its stacks.
    pub(super) fn on_debugger_dump(&mut self, text: String, cx: &mut Context<'_>) {
        if !self.has_stack_dump {
            cx.emit(EventKind::StackDumped { source: self.source(), text });
        }
        self.after_stack_dump(cx);
    }

    fn after_stack_dump(&mut self, cx: &mut Context<'_>) {
        self.has_stack_dump |= self.step.is_some();
        match self.step {
            Some(StopStep::DumpThenAsk) => self.ask(cx),
            Some(StopStep::DumpThenTerminate) => self.terminate(cx),
            _ => {}
        }
    }

    /// The process has ended, and others that it started are alive: they have the rest of the
    /// grace.
    pub(super) fn on_leader_end(&mut self, cx: &mut Context<'_>) {
        if self.step.is_none() || self.is_released {
            return cx.push(Effect::KillTree(self.host));
        }
        // An ended process has no stacks.
        self.after_stack_dump(cx);
    }

    fn terminate(&mut self, cx: &mut Context<'_>) {
        self.step = Some(StopStep::Terminated);
        cx.push(Effect::Signal(self.host, SIGTERM, SignalReach::Tree));
        self.set_limit(TERM_GRACE, cx);
    }

    /// Kills its process and all descendants.
    pub fn kill(&mut self, cx: &mut Context<'_>) {
        if self.has_exited() {
            if self.awaits_fixtures() {
                self.state = AttemptState::Ended;
            }
            return;
        }
        self.step = Some(StopStep::Killed);
        self.kills += 1;
        cx.push(Effect::KillTree(self.host));
        self.set_limit(KILL_WAIT, cx);
    }

    /// Gives up a process that was killed and does not end.
    fn abandon(&mut self, cx: &mut Context<'_>) {
        cx.abandon(format!("the process of test `{}`", self.plan.name));
        if let Some((_, reason, _)) = &mut self.evidence.stopped {
            reason.push_str("; its process was killed and did not end");
        }
        self.on_exit(None, Vec::new(), cx);
    }

    pub fn on_deadline(&mut self, timer: TestTimer, cx: &mut Context<'_>) {
        match timer {
            TestTimer::Slow => return cx.emit(EventKind::TestSlow { test: self.plan.id }),
            TestTimer::Question(number) => return self.on_question_timeout(number, cx),
            TestTimer::Limit => {}
        }
        if self.has_exited() {
            if !self.is_judged() {
                self.state = AttemptState::Ended;
            }
            return;
        }
        match self.step {
            None => {
                let reason = self.timeout_reason(cx.now());
                self.stop(StopCause::Timeout, reason, cx);
            }
            Some(StopStep::DumpThenAsk) => self.ask(cx),
            Some(StopStep::Asked) if !self.has_stack_dump => {
                self.dump_stack(StopStep::DumpThenTerminate, cx)
            }
            Some(StopStep::Asked | StopStep::DumpThenTerminate) => self.terminate(cx),
            Some(StopStep::Killed) if self.kills >= MAX_KILLS => self.abandon(cx),
            Some(StopStep::Terminated | StopStep::Killed) => self.kill(cx),
        }
    }

    fn timeout_reason(&self, now: Duration) -> String {
        if let Some(stopwatch) = &self.stopwatch {
            return format!("{} did not end {}", self.step_name(), stopwatch.backstop_reason(now));
        }
        let limits = &self.plan.limits;
        if let (Phase::Run, Some(slots)) = (self.phase, &self.slots) {
            return slots.timeout_reason(limits.run);
        }
        match self.phase {
            Phase::Load => format!("the plug-in was not loaded within {:?}", limits.load),
            Phase::Setup => format!("set-up did not end within {:?}", limits.setup),
            Phase::Run => format!("run did not end within {:?}", limits.run),
            Phase::TearDown => format!("tear-down did not end within {:?}", limits.teardown),
            Phase::Exit | Phase::Notify => {
                format!("the process did not end within {:?} after the test", limits.teardown)
            }
        }
    }
}
