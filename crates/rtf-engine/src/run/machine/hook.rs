//! One run of a hook: a separate process that brings the robot into a safe state.

use rtf_model::protocol::{Notification, QuestionEnd, Request};
use rtf_model::{EventKind, ExitStatus, LeakedProcess, Question, Source, TestId, Trigger};

use super::context::Context;
use super::io::{
    Deadline, Effect, HostId, ProcessEvent, Program, SignalReach, StartRequest, environment,
};
use super::kill_escalation::{KILL_WAIT, MAX_KILLS, SIGTERM, TERM_GRACE, killed_text};
use super::output_capture::OutputCapture;
use crate::hook::{ASKED, HookJudgement, RUN_REQUEST, request, trigger_variables};
use rtf_plan::plan::{HookBody, HookPlan, SuitePlan};

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
pub struct RunningHook<'p> {
    plan: &'p HookPlan,
    host: HostId,
    judgement: HookJudgement,
    /// How many signals were sent to stop it.
    signals: u32,
    output: OutputCapture,
}

impl<'p> RunningHook<'p> {
    pub fn start(suite: &'p SuitePlan, triggered: TriggeredHook, cx: &mut Context<'_>) -> Self {
        let plan = &suite.hooks[triggered.index];
        let source = Source::Hook(plan.id);
        cx.emit(started_event(plan, &triggered));
        let mut env = environment(suite, &plan.env, ("hook", &plan.name), cx.values());
        let test = triggered.test.as_ref().map(|(_, name)| name.as_str());
        env.extend(trigger_variables(triggered.trigger, &triggered.reason, test));
        let host = start_body(suite, (source, &plan.name), &plan.body, env, cx);
        cx.set(Deadline::Hook, plan.timeout);
        let output = OutputCapture::new(source);
        let is_plugin = matches!(plan.body, HookBody::Plugin(_));
        let judgement = HookJudgement::new(is_plugin, plan.timeout);
        Self { plan, host, judgement, signals: 0, output }
    }

    pub fn host(&self) -> HostId {
        self.host
    }

    /// True once it has ended.
    pub fn handle(&mut self, input: ProcessEvent, cx: &mut Context<'_>) -> bool {
        match input {
            ProcessEvent::SpawnFailed(reason) => {
                self.judgement.fail(reason);
                self.end(None, Vec::new(), cx);
                return true;
            }
            ProcessEvent::Exited(status, leaked) => {
                self.end(Some(status), leaked, cx);
                return true;
            }
            // After a stop, the processes that are left have the rest of the grace.
            ProcessEvent::LeaderEnded(..) if self.signals == 0 => {
                cx.push(Effect::KillTree(self.host));
            }
            ProcessEvent::Notified(notification) => {
                self.judgement.notified(&notification);
                match notification {
                    Notification::Message(message) => {
                        let source = Source::Hook(self.plan.id);
                        cx.emit(EventKind::Message { source, message, test: None });
                    }
                    Notification::QuestionAsked(Question { question, .. }) => {
                        let problem = Some(ASKED.to_owned());
                        let end = QuestionEnd { question, answer: None, problem };
                        cx.send(self.host, None, Request::QuestionClosed(end));
                    }
                    _ => {}
                }
            }
            ProcessEvent::Replied(RUN_REQUEST, reply) => self.judgement.replied(reply),
            ProcessEvent::ProtocolViolated(what) => self.judgement.protocol_violated(&what),
            ProcessEvent::Printed(stream, bytes) => {
                self.judgement.printed(stream, &bytes);
                self.output.push(stream, &bytes, cx);
            }
            ProcessEvent::Attached(Err(why)) => self.judgement.fail(why),
            _ => {}
        }
        false
    }

    /// Its limit, or that of a step of its stop, has passed. True if the runner gives it
    /// up, because it was killed and does not end.
    pub fn on_deadline(&mut self, cx: &mut Context<'_>) -> bool {
        let (effect, wait) = match self.signals {
            0 => (Effect::Signal(self.host, SIGTERM, SignalReach::Tree), TERM_GRACE),
            kills if kills <= MAX_KILLS => (Effect::KillTree(self.host), KILL_WAIT),
            _ => {
                cx.abandon(format!("the process of hook `{}`", self.plan.name));
                self.judgement.give_up();
                self.end(None, Vec::new(), cx);
                return true;
            }
        };
        self.judgement.limit_passed();
        self.signals += 1;
        cx.push(effect);
        cx.set(Deadline::Hook, wait);
        false
    }

    pub fn kill(&mut self, problem: &str, cx: &mut Context<'_>) {
        self.judgement.fail(problem);
        self.signals += 1;
        cx.push(Effect::KillTree(self.host));
        cx.set(Deadline::Hook, KILL_WAIT);
    }

    fn end(&mut self, exit: Option<ExitStatus>, leaked: Vec<LeakedProcess>, cx: &mut Context<'_>) {
        cx.clear(Deadline::Hook);
        self.output.finish(cx);
        if self.signals > 1 {
            killed_text(&leaked).into_iter().for_each(|text| self.judgement.add(&text));
        } else {
            cx.report_leaked(Source::Hook(self.plan.id), leaked);
        }
        let problem = self.judgement.finish(exit);
        cx.emit(EventKind::HookFinished { hook: self.plan.id, problem });
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

/// Starts the command or plug-in of a hook or reset.
pub fn start_body(
    suite: &SuitePlan,
    (source, name): (Source, &str),
    body: &HookBody,
    env: Vec<(String, String)>,
    cx: &mut Context<'_>,
) -> HostId {
    let host = cx.next_host_id();
    let (what, request) = match body {
        HookBody::Plugin(plugin) => {
            let mut request = request(suite, name, plugin);
            cx.values().extend_request(&mut request);
            (Program::Host(cx.values().in_host(&plugin.host)), Some(request))
        }
        HookBody::Command(command) => (Program::Command(cx.values().in_command(command)), None),
    };
    let start = StartRequest { what, env, folder: suite.folder.clone() };
    cx.push(Effect::Spawn { host, source, start });
    if let Some(request) = request {
        cx.send(host, Some(RUN_REQUEST), Request::RunTest(request));
    }
    host
}
