//! Hooks.

use rtf_model::{HookRecord, LeakedProcess, Message, Trigger};
use serde::Serialize;
use utoipa::ToSchema;

use super::model;

/// A hook.
#[derive(Debug, Serialize, ToSchema)]
pub struct Hook {
    /// Its id.
    pub id: u32,
    /// Its suite.
    pub suite: u32,
    /// Its name, unique in the suite.
    pub name: String,
    /// What calls for it.
    #[schema(value_type = Vec<model::Trigger>)]
    pub on: Vec<Trigger>,
    /// Each time it was run, in order.
    pub runs: Vec<HookRun>,
}

/// One run of a hook.
#[derive(Debug, Serialize, ToSchema)]
pub struct HookRun {
    /// From 1.
    pub number: usize,
    /// When it started.
    pub started: u64,
    /// When it ended.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub finished: Option<u64>,
    /// What called for it.
    #[schema(value_type = model::Trigger)]
    pub trigger: Trigger,
    /// The same in words.
    pub reason: String,
    /// The test that it is about.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub test: Option<u32>,
    /// Why the robot may not be in a safe state.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub problem: Option<String>,
    /// What it printed.
    pub output: String,
    /// Its failures and errors.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(value_type = Vec<model::Message>, required = false)]
    pub messages: Vec<Message>,
    /// Stack dumps from before it was killed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub stacks: Vec<String>,
    /// Its processes that had to be killed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(value_type = Vec<model::LeakedProcess>, required = false)]
    pub leaked: Vec<LeakedProcess>,
}

/// All hooks of a run.
#[derive(Debug, Serialize, ToSchema)]
pub struct Hooks {
    /// The hooks, by their ids.
    pub hooks: Vec<Hook>,
}

impl Hook {
    /// A view of a hook.
    #[must_use]
    pub fn of(hook: &HookRecord) -> Self {
        Self {
            id: hook.plan.hook.0,
            suite: hook.plan.suite.0,
            name: hook.plan.name.clone(),
            on: hook.plan.on.clone(),
            runs: hook.runs.iter().zip(1..).map(|(run, number)| HookRun::of(run, number)).collect(),
        }
    }
}

impl HookRun {
    fn of(run: &rtf_model::HookRunRecord, number: usize) -> Self {
        let finished = run.finished.as_ref();
        Self {
            number,
            started: run.started.0,
            finished: finished.map(|(at, _)| at.0),
            trigger: run.trigger,
            reason: run.reason.clone(),
            test: run.test.map(|test| test.0),
            problem: finished.and_then(|(_, problem)| problem.clone()),
            output: run.output.clone(),
            messages: run.messages.clone(),
            stacks: run.stacks.clone(),
            leaked: run.leaked.clone(),
        }
    }
}
