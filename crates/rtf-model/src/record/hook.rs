//! What is known of one hook.

use std::time::Duration;

use crate::{EventKind, HookPlanned, LeakedProcess, Message, MessageKind, Micros, TestId, Trigger};

/// What is known of one hook.
#[derive(Clone, Debug)]
pub struct HookRecord {
    /// How it was planned.
    pub plan: HookPlanned,
    /// Each time it was run, the oldest first.
    pub runs: Vec<HookRun>,
}

/// One run of a hook.
#[derive(Clone, Debug)]
pub struct HookRun {
    /// When it started.
    pub started: Micros,
    /// What called for it.
    pub trigger: Trigger,
    /// The same in words.
    pub reason: String,
    /// The test that it is about, if there is one.
    pub test: Option<TestId>,
    /// Its end, and why the robot may not be in a safe state.
    pub finished: Option<(Micros, Option<String>)>,
    /// Its failures and errors.
    pub messages: Vec<Message>,
    /// What it printed.
    pub output: String,
    /// Where it was before it was stopped by force.
    pub stacks: Vec<String>,
    /// Processes of it that had to be killed.
    pub leaked: Vec<LeakedProcess>,
}

impl HookRecord {
    pub(super) fn new(plan: HookPlanned) -> Self {
        Self { plan, runs: Vec::new() }
    }

    pub(super) fn apply(&mut self, at: Micros, kind: &EventKind) {
        if let EventKind::HookStarted { trigger, reason, test, .. } = kind {
            self.runs.push(HookRun::new(at, *trigger, reason, *test));
        } else if let Some(run) = self.runs.last_mut() {
            run.apply(at, kind);
        }
    }

    /// Why the robot may not be in a safe state, in words: runs that went wrong
    /// or did not come to their end.
    pub fn problems(&self) -> impl Iterator<Item = String> {
        let name = &self.plan.name;
        self.runs.iter().filter_map(move |run| {
            run.problem().map(|problem| format!("hook `{name}` on {}: {problem}", run.trigger))
        })
    }
}

impl HookRun {
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
            EventKind::Output(output) => {
                if output.omitted_bytes > 0 {
                    self.output += &format!("\n[… {} bytes left out …]\n", output.omitted_bytes);
                }
                self.output += &output.text;
            }
            EventKind::StackDumped { text, .. } => self.stacks.push(text.clone()),
            EventKind::ProcessesLeaked { processes, .. } => {
                self.leaked.extend_from_slice(processes)
            }
            _ => {}
        }
    }
    /// Why the robot may not be in a safe state; nothing when the hook did its
    /// work. A run that has not ended has not done it.
    #[must_use]
    pub fn problem(&self) -> Option<&str> {
        match &self.finished {
            Some((_, problem)) => problem.as_deref(),
            None => Some("it did not come to its end"),
        }
    }

    /// How long it took, `None` when it did not end.
    #[must_use]
    pub fn duration(&self) -> Option<Duration> {
        self.finished.as_ref().map(|(at, _)| at.since(self.started))
    }
}
