//! The messages of the runner to its guard, one JSON object per line. Descriptors travel
//! with the line that announces them.

use std::path::PathBuf;
use std::time::Duration;

use rtf_model::protocol::{ENVIRONMENT_VARIABLE, OWNER_VARIABLE, Plugin};
use rtf_model::{EventKind, HookId, SuiteId, TestId, Trigger};
use rtf_process::task::ProcessStream;
use serde::{Deserialize, Serialize};

use super::fixture_stop::FixtureStop;
use crate::fixture_values::FixtureValues;
use crate::hook::request;
use crate::unbuffered;
use rtf_plan::plan::{HookBody, HookPlan, SuitePlan};

/// A fact that the guard needs if the runner dies.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "message", rename_all = "kebab-case")]
pub enum GuardMessage {
    RunStarted {
        /// Its journal, absolute.
        journal: PathBuf,
        scratch_dir: PathBuf,
        /// The start of its clock, as the time since the fork.
        started: Duration,
    },
    /// The run has finished: nothing needs recovery.
    RunFinished,
    /// The guard did not read for so long that messages were lost. Only
    /// [`GuardMessage::RunFinished`] follows.
    MessagesLost,
    /// Exclusive resources of a suite: the descriptors of its namespaces, or of some of its
    /// locks and leases, come with this line.
    SuiteResources {
        suite: SuiteId,
        /// The number of descriptors.
        descriptors: usize,
        /// The process that holds the namespaces, if the descriptors are theirs.
        holder: Option<i32>,
    },
    SuiteStarted {
        suite: SuiteId,
        /// Its hooks, in their order.
        hooks: Vec<HookSpec>,
    },
    /// A suite has finished; its hooks will not run.
    SuiteFinished {
        suite: SuiteId,
    },
    /// The fixtures of a suite have provided these values.
    FixtureValues {
        suite: SuiteId,
        values: FixtureValues,
    },
    /// A test starts: all hooks of its suite become due.
    TestStarted {
        suite: SuiteId,
        test: TestId,
        name: String,
    },
    TestFinished {
        suite: SuiteId,
        test: TestId,
    },
    HookStarting(HookStart),
    /// The hook's process was started, and waits for its request.
    HookStarted {
        hook: HookId,
        pid: i32,
        /// The streams whose descriptors come with this line, in this order.
        streams: Vec<ProcessStream>,
    },
    HookFinished {
        hook: HookId,
        /// Why the robot may not be in a safe state.
        problem: Option<String>,
    },
    /// A fixture's process was started. It must remain alive while hooks run, and is stopped then.
    FixtureStarted {
        pid: i32,
        /// The streams whose descriptors come with this line, in this order.
        streams: Vec<ProcessStream>,
        stop: FixtureStop,
    },
    FixtureEnded {
        pid: i32,
    },
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HookStart {
    pub hook: HookId,
    pub scope: String,
    pub trigger: Trigger,
    /// The reason, for users.
    pub reason: String,
    /// The test that triggered it.
    pub test: Option<TestId>,
}

impl HookStart {
    /// Returns its `hook-started`.
    pub fn event(&self) -> EventKind {
        EventKind::HookStarted {
            hook: self.hook,
            trigger: self.trigger,
            reason: self.reason.clone(),
            test: self.test,
        }
    }
}

/// A hook as the guard runs it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HookSpec {
    pub id: HookId,
    pub suite: SuiteId,
    pub name: String,
    /// Whether it runs after the runner's death. Other hooks may only finish.
    pub is_abort_hook: bool,
    /// The program and its arguments.
    pub command: Vec<String>,
    /// Environment variables in addition to the runner's.
    pub env: Vec<(String, String)>,
    pub working_dir: PathBuf,
    pub limit: Duration,
    /// The request to its host, for a plug-in.
    pub plugin: Option<Plugin>,
}

impl HookSpec {
    /// Replaces the references to values of fixtures.
    ///
    /// # Errors
    /// Why the hook cannot run: a value was not provided.
    pub fn resolve(&mut self, values: &FixtureValues) -> Result<(), String> {
        let env = self.env.iter().map(|(_, value)| value);
        let plugin =
            self.plugin.iter().flat_map(|plugin| plugin.args.iter().chain([&plugin.param]));
        if let Some(problem) = values.missing(self.command.iter().chain(env).chain(plugin)) {
            return Err(problem);
        }
        self.command = values.in_command(&self.command);
        values.extend_env(&mut self.env);
        if let Some(plugin) = &mut self.plugin {
            values.extend_request(plugin);
        }
        Ok(())
    }

    pub fn new(suite: &SuitePlan, plan: &HookPlan) -> Self {
        let mut env = vec![(ENVIRONMENT_VARIABLE.to_owned(), suite.settings.environment.clone())];
        env.extend(unbuffered::variable());
        env.extend(suite.env.iter().chain(&plan.env).cloned());
        env.push((OWNER_VARIABLE.to_owned(), format!("hook {}/{}", suite.name, plan.name)));
        let (command, plugin) = match &plan.body {
            HookBody::Command(command) => (command.clone(), None),
            HookBody::Plugin(plugin) => {
                env.extend_from_slice(&plugin.host.env);
                (plugin.host.command.clone(), Some(request(suite, &plan.name, plugin)))
            }
        };
        Self {
            id: plan.id,
            suite: suite.id,
            name: plan.name.clone(),
            is_abort_hook: plan.on.iter().any(|on| matches!(on, Trigger::Interrupt | Trigger::End)),
            command,
            env,
            working_dir: suite.folder.clone(),
            limit: plan.timeout,
            plugin,
        }
    }
}
