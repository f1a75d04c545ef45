//! One run of a hook: a fresh process that brings the robot into a safe state.

use rtf_model::protocol::{Answer, Notification, Plugin, Request};
use rtf_model::{
    EventKind, ExitStatus, LeakedProcess, MessageKind, Outcome, Source, Stream, TestId, Trigger,
};

use super::capture::Capture;
use super::io::{Deadline, Effect, HostId, HostInput, Program, Start, environment};
use super::suite::Context;
use super::test::{KILL_WAIT, KILLS, TERM_GRACE, parse_answer};
use rtf_plan::plan::{HookBody, HookPlan, SuitePlan};

/// The number of `run-test` on a hook's channel.
const RUN: u64 = 2;
const SIGTERM: i32 = 15;

/// Why a hook is run.
#[derive(Clone, Debug)]
pub struct Call {
    /// The hook's place in the suite's list.
    pub place: usize,
    /// What called for it.
    pub trigger: Trigger,
    /// The same in words.
    pub reason: String,
    /// The test that it is about: its id and name.
    pub test: Option<(TestId, String)>,
}

/// One run of a hook.
#[derive(Debug)]
pub struct HookRun<'p> {
    plan: &'p HookPlan,
    host: HostId,
    answer: Option<Answer>,
    problem: Option<String>,
    force: u32,
    captures: [Capture; 2],
}

impl<'p> HookRun<'p> {
    /// Starts it: emits `hook-started`.
    pub fn start(suite: &'p SuitePlan, call: Call, cx: &mut Context<'_>) -> Self {
        let plan = &suite.hooks[call.place];
        let (host, source) = (cx.new_host(), Source::Hook(plan.id));
        cx.emit(started(plan, &call));
        cx.out(Effect::Spawn { host, source, start: start(suite, plan, call) });
        if let HookBody::Plugin(plugin) = &plan.body {
            let request = Request::RunTest(Plugin {
                file: plugin.file.to_string_lossy().into_owned(),
                name: plan.name.clone(),
                param: plugin.param.clone(),
                args: plugin.args.clone(),
                environment: suite.environment.clone(),
                repetition: 1,
                is_last: true,
                end_marker: None,
                attachments_dir: None,
            });
            cx.out(Effect::Send(host, Some(RUN), request));
        }
        cx.set(Deadline::Hook, plan.timeout);
        let captures = [Capture::new(source, Stream::Stdout), Capture::new(source, Stream::Stderr)];
        Self { plan, host, answer: None, problem: None, force: 0, captures }
    }

    pub fn host(&self) -> HostId {
        self.host
    }

    /// Takes in what its process did; true when it is over.
    pub fn handle(&mut self, input: HostInput, cx: &mut Context<'_>) -> bool {
        match input {
            HostInput::SpawnFailed(reason) => {
                self.note(reason);
                self.end(None, Vec::new(), cx);
                return true;
            }
            HostInput::Exited(status, left) => {
                self.end(Some(status), left, cx);
                return true;
            }
            HostInput::Told(Notification::Message(message)) => {
                if matches!(message.kind, MessageKind::Failure | MessageKind::Error) {
                    self.note(message.text.clone());
                }
                cx.emit(EventKind::Message {
                    source: Source::Hook(self.plan.id),
                    message,
                    test: None,
                });
            }
            HostInput::Told(Notification::Measured(measurement)) => {
                self.problem = self.problem.take().or_else(|| measurement.problem());
            }
            HostInput::Told(Notification::Sampled(samples)) => {
                self.problem = self.problem.take().or_else(|| samples.problem());
            }
            HostInput::Answered(RUN, reply) => match parse_answer(reply) {
                Ok(Ok(answer)) => self.answer = Some(answer),
                Ok(Err(error)) => self.note(format!("its host refused: {}", error.message)),
                Err(what) => self.note(format!("its host broke the protocol: {what}")),
            },
            HostInput::Garbage(what) => self.note(format!("its host broke the protocol: {what}")),
            HostInput::Printed(stream, bytes) => {
                if let Some(output) = self.captures[stream as usize].push(&bytes) {
                    cx.emit(EventKind::Output(output));
                }
            }
            _ => {}
        }
        false
    }

    /// The first problem is the one that is told.
    fn note(&mut self, problem: String) {
        self.problem.get_or_insert(problem);
    }

    /// Its limit, or that of a step of its stop, has passed; true when it is over,
    /// since its process does not end although it was killed.
    pub fn deadline(&mut self, cx: &mut Context<'_>) -> bool {
        let limit = self.plan.timeout;
        let (effect, wait) = match self.force {
            0 => (Effect::Signal(self.host, SIGTERM), TERM_GRACE),
            kills if kills <= KILLS => (Effect::KillTree(self.host), KILL_WAIT),
            _ => {
                cx.abandon(format!("the process of hook `{}`", self.plan.name));
                let what = "its process was killed and did not end";
                self.problem = Some(format!("it did not end within {limit:?}; {what}"));
                self.end(None, Vec::new(), cx);
                return true;
            }
        };
        self.note(format!("it did not end within {limit:?}"));
        self.force += 1;
        cx.out(effect);
        cx.set(Deadline::Hook, wait);
        false
    }

    /// Kills it, with this problem.
    pub fn kill(&mut self, why: &str, cx: &mut Context<'_>) {
        self.note(why.to_owned());
        self.force += 1;
        cx.out(Effect::KillTree(self.host));
        cx.set(Deadline::Hook, KILL_WAIT);
    }

    fn end(&mut self, exit: Option<ExitStatus>, left: Vec<LeakedProcess>, cx: &mut Context<'_>) {
        cx.clear(Deadline::Hook);
        for capture in &mut self.captures {
            if let Some(output) = capture.finish() {
                cx.emit(EventKind::Output(output));
            }
        }
        if !left.is_empty() {
            let source = Source::Hook(self.plan.id);
            cx.emit(EventKind::ProcessesLeaked { source, processes: left });
        }
        if let Some(problem) = self.judge(exit) {
            self.note(problem);
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

/// Reports a hook that was called for and is not run, with this problem.
pub fn refuse(suite: &SuitePlan, call: &Call, why: &str, cx: &mut Context<'_>) {
    let plan = &suite.hooks[call.place];
    cx.emit(started(plan, call));
    cx.emit(EventKind::HookFinished { hook: plan.id, problem: Some(why.to_owned()) });
}

fn started(plan: &HookPlan, call: &Call) -> EventKind {
    EventKind::HookStarted {
        hook: plan.id,
        trigger: call.trigger,
        reason: call.reason.clone(),
        test: call.test.as_ref().map(|(id, _)| *id),
    }
}

fn start(suite: &SuitePlan, plan: &HookPlan, call: Call) -> Start {
    let what = match &plan.body {
        HookBody::Plugin(plugin) => Program::Host(plugin.host.clone()),
        HookBody::Command(command) => Program::Command(command.clone()),
    };
    let mut env = environment(suite, &plan.env, "hook", &plan.name);
    let mut tell = |name: &str, value: String| env.push((name.to_owned(), value));
    tell("RTF_HOOK_TRIGGER", call.trigger.to_string());
    tell("RTF_HOOK_REASON", call.reason);
    tell("RTF_HOOK_TEST", call.test.map_or_else(String::new, |(_, name)| name));
    Start { what, env, folder: suite.folder.clone() }
}
