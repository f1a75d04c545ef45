//! The hooks of a suite: which were triggered, and which one runs.

use std::collections::VecDeque;

use rtf_model::protocol::TestAttempt;
use rtf_model::{TestId, Trigger, Verdict};

use super::context::Context;
use super::hook::{RunningHook, TriggeredHook, report_not_run};
use super::io::{HostId, ProcessEvent};
use crate::hook::{HOOK_KILLED, HOOK_NOT_RUN};
use rtf_plan::plan::SuitePlan;

/// Hooks run one at a time, and never while a test without a verdict runs.
#[derive(Debug)]
pub struct HookQueue<'p> {
    plan: &'p SuitePlan,
    queue: VecDeque<TriggeredHook>,
    running: Option<RunningHook<'p>>,
    /// Which were triggered since the last test started.
    triggered: Vec<bool>,
    is_killed: bool,
}

impl<'p> HookQueue<'p> {
    pub fn new(plan: &'p SuitePlan) -> Self {
        let triggered = vec![false; plan.hooks.len()];
        Self { plan, queue: VecDeque::new(), running: None, triggered, is_killed: false }
    }

    /// Queues the hooks of a trigger, each once. `end` hooks that ran since the last test
    /// are not repeated.
    pub fn trigger(&mut self, trigger: Trigger, reason: &str, test: Option<(TestId, String)>) {
        for (index, plan) in self.plan.hooks.iter().enumerate() {
            let mut queue = self.queue.iter();
            let is_queued = queue.any(|hook| hook.index == index && hook.trigger == trigger);
            let has_run = trigger == Trigger::End && self.triggered[index];
            if plan.on.contains(&trigger) && !is_queued && !has_run {
                self.triggered[index] = true;
                let (reason, test) = (reason.to_owned(), test.clone());
                self.queue.push_back(TriggeredHook { index, trigger, reason, test });
            }
        }
    }

    pub fn trigger_by_verdict(
        &mut self,
        test: &TestAttempt,
        verdict: Verdict,
        reason: Option<&str>,
    ) {
        let trigger = match verdict {
            Verdict::Failed | Verdict::Error | Verdict::Crashed => Trigger::Failure,
            Verdict::TimedOut => Trigger::Timeout,
            _ => return,
        };
        let reason = format!("`{}` is {verdict}: {}", test.name, reason.unwrap_or_default());
        self.trigger(trigger, &reason, Some((test.id, test.name.clone())));
    }

    /// The test may move the robot out of its safe state: `end` hooks have to run again.
    pub fn on_test_start(&mut self) {
        self.triggered.fill(false);
    }

    /// Starts the next hook unless one runs; true if one runs now.
    pub fn run_next(&mut self, cx: &mut Context<'_>) -> bool {
        if self.is_killed && self.running.is_none() {
            for hook in self.queue.drain(..) {
                report_not_run(self.plan, &hook, HOOK_NOT_RUN, cx);
            }
        }
        while self.running.is_none()
            && let Some(hook) = self.queue.pop_front()
        {
            match cx.values().missing_in(&self.plan.hooks[hook.index]) {
                Some(problem) => report_not_run(self.plan, &hook, &problem, cx),
                None => self.running = Some(RunningHook::start(self.plan, hook, cx)),
            }
        }
        self.running.is_some()
    }

    /// Whether a hook runs or is queued.
    pub fn any(&self) -> bool {
        self.running.is_some() || !self.queue.is_empty()
    }

    /// Kills the running hook; queued ones will not run.
    pub fn kill_all(&mut self, cx: &mut Context<'_>) {
        self.is_killed = true;
        if let Some(hook) = &mut self.running {
            hook.kill(HOOK_KILLED, cx);
        }
    }

    pub fn owns(&self, host: HostId) -> bool {
        self.running.as_ref().is_some_and(|hook| hook.host() == host)
    }

    pub fn handle(&mut self, input: ProcessEvent, cx: &mut Context<'_>) {
        self.running.take_if(|hook| hook.handle(input, cx));
    }

    pub fn on_deadline(&mut self, cx: &mut Context<'_>) {
        self.running.take_if(|hook| hook.on_deadline(cx));
    }
}
