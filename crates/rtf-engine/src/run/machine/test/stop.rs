//! How a test is stopped: a stack dump when a limit was reached, the request to
//! stop, its grace, a stack dump when there is none yet, SIGTERM, SIGKILL.

use std::time::Duration;

use rtf_model::protocol::Request;
use rtf_model::{EventKind, Phase, Source, StopCause};

use super::{KILL_WAIT, KILLS, Process, Step, TERM_GRACE, TestRun};
use crate::run::machine::io::{Deadline, Effect, TestTimer};
use crate::run::machine::suite::Context;

const SIGTERM: i32 = 15;
/// A stack dump takes no longer than this; the shell answers earlier.
const STACK_LIMIT: Duration = Duration::from_secs(15);

impl TestRun<'_> {
    /// Asks the test to stop. The first cause is the one that counts.
    pub fn stop(&mut self, cause: StopCause, reason: String, cx: &mut Context<'_>) {
        if self.evidence.stopped.is_some() || self.process == Process::Judged {
            return;
        }
        if self.process != Process::Alive && cause != StopCause::Collapse {
            // It has ended; whether the fixtures live still counts.
            return;
        }
        cx.emit(EventKind::TestStopping { test: self.plan.id, cause, reason: reason.clone() });
        cx.clear(Deadline::Test(self.plan.id, TestTimer::Slow));
        self.stopwatch = None;
        self.evidence.stopped = Some((cause, reason, self.phase));
        if self.process != Process::Alive {
            self.process = Process::Over;
            return;
        }
        if cause == StopCause::Timeout {
            self.dump_stack(Step::DumpThenAsk, cx);
        } else {
            self.ask(cx);
        }
    }

    fn dump_stack(&mut self, step: Step, cx: &mut Context<'_>) {
        self.step = Some(step);
        cx.out(Effect::TakeStack(self.host, self.stack));
        cx.set(Deadline::Test(self.plan.id, TestTimer::Limit), STACK_LIMIT);
    }

    fn ask(&mut self, cx: &mut Context<'_>) {
        self.step = Some(Step::Asked);
        let reason = self.evidence.stopped.as_ref().map(|(_, reason, _)| reason.clone());
        let (reason, request) = (reason.unwrap_or_default(), Some(self.request));
        cx.out(Effect::Send(self.host, None, Request::Interrupt { reason, request }));
        cx.set(Deadline::Test(self.plan.id, TestTimer::Limit), self.plan.limits.grace);
    }

    pub(super) fn stack_taken(&mut self, text: String, cx: &mut Context<'_>) {
        if !self.stack_taken {
            self.stack_taken = true;
            cx.emit(EventKind::StackDumped { source: Source::Test(self.plan.id), text });
        }
        match self.step {
            Some(Step::DumpThenAsk) => self.ask(cx),
            Some(Step::DumpThenForce) => self.terminate(cx),
            _ => {}
        }
    }

    fn terminate(&mut self, cx: &mut Context<'_>) {
        self.step = Some(Step::Terminated);
        cx.out(Effect::Signal(self.host, SIGTERM));
        cx.set(Deadline::Test(self.plan.id, TestTimer::Limit), TERM_GRACE);
    }

    /// Kills its process and everything below it, now.
    pub fn kill(&mut self, cx: &mut Context<'_>) {
        if self.process != Process::Alive {
            if self.is_looking() {
                self.process = Process::Over;
            }
            return;
        }
        self.step = Some(Step::Killed);
        self.kills += 1;
        cx.out(Effect::KillTree(self.host));
        cx.set(Deadline::Test(self.plan.id, TestTimer::Limit), KILL_WAIT);
    }

    /// Its process does not end although it was killed: nobody waits any more.
    fn abandon(&mut self, cx: &mut Context<'_>) {
        cx.abandon(format!("the process of test `{}`", self.plan.name));
        if let Some((_, reason, _)) = &mut self.evidence.stopped {
            reason.push_str("; its process was killed and did not end");
        }
        self.exited(None, Vec::new(), cx);
    }

    /// A deadline about this test has passed.
    pub fn deadline(&mut self, timer: TestTimer, cx: &mut Context<'_>) {
        if timer == TestTimer::Slow {
            return cx.emit(EventKind::TestSlow { test: self.plan.id });
        }
        if self.process == Process::Judged {
            return;
        }
        if self.process != Process::Alive {
            self.process = Process::Over;
            return;
        }
        match self.step {
            None => {
                let reason = self.limit_reached(cx.now());
                self.stop(StopCause::Timeout, reason, cx);
            }
            Some(Step::DumpThenAsk) => self.ask(cx),
            Some(Step::Asked) if !self.stack_taken => self.dump_stack(Step::DumpThenForce, cx),
            Some(Step::Asked | Step::DumpThenForce) => self.terminate(cx),
            Some(Step::Killed) if self.kills >= KILLS => self.abandon(cx),
            Some(Step::Terminated | Step::Killed) => self.kill(cx),
        }
    }

    fn limit_reached(&self, now: Duration) -> String {
        if let Some(stopwatch) = &self.stopwatch {
            return format!("{} did not end {}", self.measured_step(), stopwatch.at_backstop(now));
        }
        let limits = &self.plan.limits;
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
