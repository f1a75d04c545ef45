//! All hooks of a suite: which were called for, and which one runs.

use std::collections::VecDeque;

use rtf_model::{TestId, Trigger};

use super::hook::{self, Call, HookRun};
use super::io::{HostId, HostInput};
use super::suite::Context;
use rtf_plan::plan::SuitePlan;

/// The problem of a hook that runs when nothing may run any more.
pub const HOOK_KILLED: &str = "it was killed by the third request to end the run";
/// The problem of a hook that was called for and not begun.
pub const HOOK_NOT_RUN: &str = "it did not run: the end of the run was requested three times";

/// The hooks of a suite. They run one after the other, while no test runs that is
/// not judged.
#[derive(Debug)]
pub struct Hooks<'p> {
    plan: &'p SuitePlan,
    queue: VecDeque<Call>,
    running: Option<HookRun<'p>>,
    /// Which ran, or wait to be run, since the last test.
    done: Vec<bool>,
    /// Whether none may run any more.
    killed: bool,
}

impl<'p> Hooks<'p> {
    pub fn new(plan: &'p SuitePlan) -> Self {
        let done = vec![false; plan.hooks.len()];
        Self { plan, queue: VecDeque::new(), running: None, done, killed: false }
    }

    /// Calls for the hooks of a trigger. One that waits already for the same
    /// trigger is not run twice.
    pub fn call(&mut self, trigger: Trigger, reason: &str, test: Option<(TestId, String)>) {
        for (place, plan) in self.plan.hooks.iter().enumerate() {
            let waits =
                self.queue.iter().any(|call| call.place == place && call.trigger == trigger);
            let idle = trigger == Trigger::End && self.done[place];
            if plan.on.contains(&trigger) && !waits && !idle {
                self.done[place] = true;
                let (reason, test) = (reason.to_owned(), test.clone());
                self.queue.push_back(Call { place, trigger, reason, test });
            }
        }
    }

    /// The robot will move again: what was done is of no use any more.
    pub fn test_starts(&mut self) {
        self.done.fill(false);
    }

    /// Whether a hook runs; the next one that waits is started.
    pub fn run_next(&mut self, cx: &mut Context<'_>) -> bool {
        if self.killed && self.running.is_none() {
            for call in self.queue.drain(..) {
                hook::refuse(self.plan, &call, HOOK_NOT_RUN, cx);
            }
        }
        if self.running.is_none() {
            self.running = self.queue.pop_front().map(|call| HookRun::start(self.plan, call, cx));
        }
        self.running.is_some()
    }

    /// Whether a hook runs, or waits to be run.
    pub fn any(&self) -> bool {
        self.running.is_some() || !self.queue.is_empty()
    }

    /// Kills the one that runs; those that were called for do not run any more.
    pub fn kill_all(&mut self, cx: &mut Context<'_>) {
        self.killed = true;
        if let Some(hook) = &mut self.running {
            hook.kill(HOOK_KILLED, cx);
        }
    }

    pub fn owns(&self, host: HostId) -> bool {
        self.running.as_ref().is_some_and(|hook| hook.host() == host)
    }

    /// Takes in what the running hook's process did.
    pub fn handle(&mut self, input: HostInput, cx: &mut Context<'_>) {
        if self.running.as_mut().is_some_and(|hook| hook.handle(input, cx)) {
            self.running = None;
        }
    }

    /// The running hook's deadline has passed.
    pub fn deadline(&mut self, cx: &mut Context<'_>) {
        if self.running.as_mut().is_some_and(|hook| hook.deadline(cx)) {
            self.running = None;
        }
    }
}
