//! The runs of one hook.

use std::time::Duration;

use crate::{EventKind, HookPlanned, LeakedProcess, Message, MessageKind, Micros, TestId, Trigger};

/// A hook and its runs.
#[derive(Clone, Debug)]
pub struct HookRecord {
    /// How it was planned.
    pub plan: HookPlanned,
    /// Its runs, the oldest first.
    pub runs: Vec<HookRunRecord>,
}

/// One run of a hook.
#[derive(Clone, Debug)]
pub struct HookRunRecord {
    /// When it started.
    pub started: Micros,
    /// Its trigger.
    pub trigger: Trigger,
    /// The reason for the trigger, as text.
    pub reason: String,
    /// The test that triggered it, if there is one.
    pub test: Option<TestId>,
    /// When it finished, and why the robot may not be in a safe state.
    pub finished: Option<(Micros, Option<String>)>,
    /// Its failures and errors.
    pub messages: Vec<Message>,
    /// Its output.
    pub output: String,
    /// Stack dumps from before it was killed.
    pub stacks: Vec<String>,
    /// Its processes that had to be killed.
    pub leaked: Vec<LeakedProcess>,
}

impl HookRecord {
    pub(super) fn new(plan: HookPlanned) -> Self {
        Self { plan, runs: Vec::new() }
    }

    pub(super) fn apply(&mut self, at: Micros, kind: &EventKind) {
        if let EventKind::HookStarted { trigger, reason, test, .. } = kind {
            self.runs.push(HookRunRecord::new(at, *trigger, reason, *test));
        } else if let Some(run) = self.runs.last_mut() {
            run.apply(at, kind);
        }
    }

    /// Why the robot may not be in a safe state: runs that failed
    /// or did not finish.
    pub fn problems(&self) -> impl Iterator<Item = String> {
        let name = &self.plan.name;
        self.runs.iter().filter_map(move |run| {
            run.problem().map(|problem| format!("hook `{name}` on {}: {problem}", run.trigger))
        })
    }
}

impl HookRunRecord {
    fn new(started: Micros, trigger: Trigger, reason: &str, test: Option<TestId>) -> Self {
        Self {
            started,
            trigger,
            reason: reason.to_owned(),
            test,
            finished: None,
            messages: Vec::new(),
            output: String::new(),
            stacks: Vec::new(),
            leaked: Vec::new(),
        }
    }

    fn apply(&mut self, at: Micros, kind: &EventKind) {
        match kind {
            EventKind::HookFinished { problem, .. } => self.finished = Some((at, problem.clone())),
            EventKind::Message { message, .. } => {
                if matches!(message.kind, MessageKind::Failure | MessageKind::Error) {
                    self.messages.push(message.clone());
                }
            }
            EventKind::Output(output) => output.append_to(&mut self.output),
            EventKind::StackDumped { text, .. } => self.stacks.push(text.clone()),
            EventKind::ProcessesLeaked { processes, .. } => {
                self.leaked.extend_from_slice(processes)
            }
            _ => {}
        }
    }
    /// Why the robot may not be in a safe state; `None` when the hook
    /// succeeded. A run that has not finished has not succeeded.
    #[must_use]
    pub fn problem(&self) -> Option<&str> {
        match &self.finished {
            Some((_, problem)) => problem.as_deref(),
            None => Some("it did not finish"),
        }
    }

    /// Its duration, `None` when it did not finish.
    #[must_use]
    pub fn duration(&self) -> Option<Duration> {
        self.finished.as_ref().map(|(at, _)| at.since(self.started))
    }
}
