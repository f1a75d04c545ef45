//! The parts of a hook's run that resets of fixtures, the state machine and the guard share: its request, its
//! environment variables and its judgement.

use std::time::Duration;

use rtf_model::protocol::{Answer, Notification, Plugin, Reply};
use rtf_model::{ExitStatus, MessageKind, Outcome, Stream, Trigger};
use rtf_plan::plan::{PluginPlan, SuitePlan};
use serde_json::Value;

use crate::log_watch::LogWatch;
use crate::plugin_request;

/// The id of `run-test` on a hook's channel.
pub const RUN_REQUEST: u64 = 2;
/// The problem of a hook that runs at the third request to end the run.
pub const HOOK_KILLED: &str = "it was killed by the third request to end the run";
/// The problem of a triggered hook that was not started.
pub const HOOK_NOT_RUN: &str = "it did not run: the end of the run was requested three times";

/// The problem of a test or hook that provides a value.
pub const PROVIDED: &str = "values can be provided in the set-up of a fixture only";

/// The problem of a hook that asks an operator.
pub const ASKED: &str = "a hook cannot ask a question: there may be no operator";

/// Returns the parameters of `run-test` for a hook's plug-in.
pub fn request(suite: &SuitePlan, name: &str, plugin: &PluginPlan) -> Plugin {
    Plugin { is_last: true, ..plugin_request::plugin(suite, name, plugin, 1) }
}

/// Returns the variables that describe what triggered a hook.
pub fn trigger_variables(
    trigger: Trigger,
    reason: &str,
    test: Option<&str>,
) -> [(String, String); 3] {
    [
        ("RTF_HOOK_TRIGGER", trigger.as_str()),
        ("RTF_HOOK_REASON", reason),
        ("RTF_HOOK_TEST", test.unwrap_or_default()),
    ]
    .map(|(name, value)| (name.to_owned(), value.to_owned()))
}

/// Judges one run of a hook or a reset. The first problem decides.
#[derive(Debug)]
pub struct HookJudgement {
    is_plugin: bool,
    /// Whether the guard adopted the process from a dead runner, which may have read some of
    /// its messages.
    is_adopted: bool,
    limit: Duration,
    answer: Option<Answer>,
    problem: Option<String>,
    log: LogWatch,
}

impl HookJudgement {
    pub fn new(is_plugin: bool, limit: Duration) -> Self {
        let (answer, problem, log) = (None, None, LogWatch::default());
        Self { is_plugin, is_adopted: false, limit, answer, problem, log }
    }

    /// Starts the judgement of a hook whose runner died.
    pub fn adopted(is_plugin: bool, limit: Duration) -> Self {
        Self { is_adopted: true, ..Self::new(is_plugin, limit) }
    }

    pub fn fail(&mut self, problem: impl Into<String>) {
        self.problem.get_or_insert(problem.into());
    }

    /// Adds to the problem, if there is one.
    pub fn add(&mut self, text: &str) {
        if let Some(problem) = &mut self.problem {
            *problem = format!("{problem}; {text}");
        }
    }

    /// Takes its output into account: the reason of a bad end contains a line of it.
    pub fn printed(&mut self, stream: Stream, bytes: &[u8]) {
        self.log.push(stream, bytes);
    }

    pub fn notified(&mut self, notification: &Notification) {
        let problem = match notification {
            Notification::Message(message) => {
                let is_problem = matches!(message.kind, MessageKind::Failure | MessageKind::Error);
                is_problem.then(|| message.text.clone())
            }
            Notification::Measured(measurement) => measurement.problem(),
            Notification::Sampled(samples) => samples.problem(),
            Notification::Provided { .. } => Some(PROVIDED.to_owned()),
            Notification::QuestionAsked(_) => Some(ASKED.to_owned()),
            Notification::Trajectory(check) => {
                Some(format!("it checks the trajectory `{}`, which only tests can", check.name))
            }
            _ => None,
        };
        problem.into_iter().for_each(|problem| self.fail(problem));
    }

    /// Takes the reply to [`RUN_REQUEST`] into account.
    pub fn replied(&mut self, reply: Reply<Value>) {
        match reply {
            Reply::Result(value) => match serde_json::from_value(value) {
                Ok(answer) => self.answer = Some(answer),
                Err(error) => {
                    let what = format!("an answer is not understood: {error}");
                    self.fail(format!("its host broke the protocol: {what}"));
                }
            },
            Reply::Error(error) => self.fail(format!("its host refused: {}", error.message)),
        }
    }

    pub fn protocol_violated(&mut self, what: &str) {
        // The runner may have read the beginning of the line.
        if !self.is_adopted {
            self.fail(format!("its host broke the protocol: {what}"));
        }
    }

    pub fn limit_passed(&mut self) {
        self.fail(format!("it did not end within {:?}", self.limit));
    }

    /// The runner gives the process up, because it was killed and does not end.
    pub fn give_up(&mut self) {
        let what = "its process was killed and did not end";
        self.problem = Some(format!("it did not end within {:?}; {what}", self.limit));
    }

    /// Returns the problem of the run, if any: the robot may not be in a safe state. `exit`
    /// is `None` if the process did not start or did not end.
    pub fn finish(&mut self, exit: Option<ExitStatus>) -> Option<String> {
        let problem = match (&mut self.answer, exit) {
            (Some(answer), _) if answer.outcome != Outcome::Passed => {
                Some(answer.reason.take().unwrap_or_else(|| "it says that it failed".to_owned()))
            }
            (None, Some(ExitStatus::Code(0))) if self.is_plugin && self.is_adopted => {
                Some("it ended, but what it answered was lost with the runner".to_owned())
            }
            (None, Some(status)) if self.is_plugin => {
                Some(self.log.explain(&format!("it ended with {status} before it was over")))
            }
            (_, Some(ExitStatus::Code(0)) | None) => None,
            (_, Some(status)) => Some(self.log.explain(&format!("it ended with {status}"))),
        };
        self.problem.take().or(problem)
    }
}
