//! One run of a hook: a separate process that brings the robot into a safe state.

use rtf_model::protocol::{Answer, Notification, Plugin, Request};
use rtf_model::{
    EventKind, ExitStatus, LeakedProcess, MessageKind, Outcome, Source, TestId, Trigger,
};

use super::context::Context;
use super::escalation::{KILL_WAIT, MAX_KILLS, SIGTERM, TERM_GRACE};
use super::host_replies::parse_answer;
use super::io::{Deadline, Effect, HostId, HostInput, Program, Start, environment, plugin};
use super::output_capture::OutputCapture;
use rtf_plan::plan::{HookBody, HookPlan, SuitePlan};

/// The number of `run-test` on a hook's channel.
const RUN: u64 = 2;

/// A triggered hook.
#[derive(Clone, Debug)]
pub struct TriggeredHook {
    /// Into the suite's list.
    pub index: usize,
    pub trigger: Trigger,
    pub reason: String,
    /// The test that triggered it.
    pub test: Option<(TestId, String)>,
}

#[derive(Debug)]
pub struct HookProcess<'p> {
    plan: &'p HookPlan,
    host: HostId,
    answer: Option<Answer>,
    problem: Option<String>,
    /// How many signals were sent to stop it.
    signals: u32,
    output: OutputCapture,
}

impl<'p> HookProcess<'p> {
    pub fn start(suite: &'p SuitePlan, triggered: TriggeredHook, cx: &mut Context<'_>) -> Self {
        let plan = &suite.hooks[triggered.index];
        let (host, source) = (cx.next_host_id(), Source::Hook(plan.id));
        cx.emit(started_event(plan, &triggered));
        cx.push(Effect::Spawn { host, source, start: process_start(suite, plan, triggered) });
        if let HookBody::Plugin(body) = &plan.body {
            let plugin = Plugin { is_last: true, ..plugin(suite, &plan.name, body, 1) };
            cx.push(Effect::Send(host, Some(RUN), Request::RunTest(plugin)));
        }
        cx.set(Deadline::Hook, plan.timeout);
        let output = OutputCapture::new(source);
        Self { plan, host, answer: None, problem: None, signals: 0, output }
    }

    pub fn host(&self) -> HostId {
        self.host
    }

    /// True once it has ended.
    pub fn handle(&mut self, input: HostInput, cx: &mut Context<'_>) -> bool {
        match input {
            HostInput::SpawnFailed(reason) => {
                self.record_problem(reason);
                self.end(None, Vec::new(), cx);
                return true;
            }
            HostInput::Exited(status, leaked) => {
                self.end(Some(status), leaked, cx);
                return true;
            }
            HostInput::Told(Notification::Message(message)) => {
                if matches!(message.kind, MessageKind::Failure | MessageKind::Error) {
                    self.record_problem(message.text.clone());
                }
                cx.emit(EventKind::Message {
                    source: Source::Hook(self.plan.id),
                    message,
                    test: None,
                });
            }
            HostInput::Told(Notification::Measured(measurement)) => {
                measurement.problem().into_iter().for_each(|problem| self.record_problem(problem));
            }
            HostInput::Told(Notification::Sampled(samples)) => {
                samples.problem().into_iter().for_each(|problem| self.record_problem(problem));
            }
            HostInput::Answered(RUN, reply) => match parse_answer(reply) {
                Ok(Ok(answer)) => self.answer = Some(answer),
                Ok(Err(error)) => {
                    self.record_problem(format!("its host refused: {}", error.message))
                }
                Err(what) => self.record_problem(format!("its host broke the protocol: {what}")),
            },
            HostInput::Garbage(what) => {
                self.record_problem(format!("its host broke the protocol: {what}"))
            }
            HostInput::Printed(stream, bytes) => self.output.push(stream, &bytes, cx),
            _ => {}
        }
        false
    }

    /// The first problem decides.
    fn record_problem(&mut self, problem: String) {
        self.problem.get_or_insert(problem);
    }

    /// Its limit, or that of a step of its stop, has passed. True if the runner gives it
    /// up, because it was killed and does not end.
    pub fn on_deadline(&mut self, cx: &mut Context<'_>) -> bool {
        let limit = self.plan.timeout;
        let (effect, wait) = match self.signals {
            0 => (Effect::Signal(self.host, SIGTERM), TERM_GRACE),
            kills if kills <= MAX_KILLS => (Effect::KillTree(self.host), KILL_WAIT),
            _ => {
                cx.abandon(format!("the process of hook `{}`", self.plan.name));
                let what = "its process was killed and did not end";
                self.problem = Some(format!("it did not end within {limit:?}; {what}"));
                self.end(None, Vec::new(), cx);
                return true;
            }
        };
        self.record_problem(format!("it did not end within {limit:?}"));
        self.signals += 1;
        cx.push(effect);
        cx.set(Deadline::Hook, wait);
        false
    }

    pub fn kill(&mut self, problem: &str, cx: &mut Context<'_>) {
        self.record_problem(problem.to_owned());
        self.signals += 1;
        cx.push(Effect::KillTree(self.host));
        cx.set(Deadline::Hook, KILL_WAIT);
    }

    fn end(&mut self, exit: Option<ExitStatus>, leaked: Vec<LeakedProcess>, cx: &mut Context<'_>) {
        cx.clear(Deadline::Hook);
        self.output.finish(cx);
        cx.report_leaked(Source::Hook(self.plan.id), leaked);
        if let Some(problem) = self.judge(exit) {
            self.record_problem(problem);
        }
        cx.emit(EventKind::HookFinished { hook: self.plan.id, problem: self.problem.take() });
    }

    fn judge(&self, exit: Option<ExitStatus>) -> Option<String> {
        let plugin = matches!(self.plan.body, HookBody::Plugin(_));
        match (&self.answer, exit) {
            (Some(answer), _) if answer.outcome != Outcome::Passed => {
                Some(answer.reason.clone().unwrap_or_else(|| "it says that it failed".to_owned()))
            }
            (None, Some(status)) if plugin => {
                Some(format!("it ended with {status} before it was over"))
            }
            (_, Some(ExitStatus::Code(0))) | (_, None) => None,
            (_, Some(status)) => Some(format!("it ended with {status}")),
        }
    }
}

/// Reports a triggered hook that does not run.
pub fn report_not_run(
    suite: &SuitePlan,
    triggered: &TriggeredHook,
    problem: &str,
    cx: &mut Context<'_>,
) {
    let plan = &suite.hooks[triggered.index];
    cx.emit(started_event(plan, triggered));
    cx.emit(EventKind::HookFinished { hook: plan.id, problem: Some(problem.to_owned()) });
}

fn started_event(plan: &HookPlan, triggered: &TriggeredHook) -> EventKind {
    EventKind::HookStarted {
        hook: plan.id,
        trigger: triggered.trigger,
        reason: triggered.reason.clone(),
        test: triggered.test.as_ref().map(|(id, _)| *id),
    }
}

fn process_start(suite: &SuitePlan, plan: &HookPlan, triggered: TriggeredHook) -> Start {
    let what = match &plan.body {
        HookBody::Plugin(plugin) => Program::Host(plugin.host.clone()),
        HookBody::Command(command) => Program::Command(command.clone()),
    };
    let mut env = environment(suite, &plan.env, "hook", &plan.name);
    let mut set = |name: &str, value: String| env.push((name.to_owned(), value));
    set("RTF_HOOK_TRIGGER", triggered.trigger.to_string());
    set("RTF_HOOK_REASON", triggered.reason);
    set("RTF_HOOK_TEST", triggered.test.map_or_else(String::new, |(_, name)| name));
    Start { what, env, folder: suite.folder.clone() }
}
