//! What the runner tells the guard: one JSON object a line. Descriptors travel
//! beside the line that announces them.

use std::path::PathBuf;
use std::time::Duration;

use rtf_model::protocol::{ENVIRONMENT_VARIABLE, OWNER_VARIABLE, Plugin};
use rtf_model::{EventKind, HookId, SuiteId, TestId, Trigger};
use rtf_process::task::ProcessStream;
use serde::{Deserialize, Serialize};

use rtf_plan::plan::{HookBody, HookPlan, SuitePlan};

/// One thing that the guard must know, should the runner die.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "note", rename_all = "kebab-case")]
pub enum Note {
    /// The run begins.
    RunBegins {
        /// Its journal, absolute.
        journal: PathBuf,
        /// Its folder for files that are gone when the run is over.
        scratch: PathBuf,
        /// When its clock started, since the fork.
        started: Duration,
    },
    /// The run is over: there is nothing left to be done.
    RunEnds,
    /// The guard did not read for so long that notes were lost. Until
    /// [`Note::RunEnds`], no other follows.
    Missed,
    /// What a suite has for itself. The descriptors of its namespaces, or some
    /// of what keeps its numbers from other runs, come with this line.
    SuiteHolds {
        /// Which.
        suite: SuiteId,
        /// How many descriptors.
        descriptors: usize,
        /// The process that holds the namespaces, when it is these.
        holder: Option<i32>,
    },
    /// A suite begins, with these hooks.
    SuiteBegins {
        /// Which.
        suite: SuiteId,
        /// Its hooks, in their order.
        hooks: Vec<Hook>,
    },
    /// A suite is over; its hooks are not needed any more.
    SuiteEnds {
        /// Which.
        suite: SuiteId,
    },
    /// A test begins: every hook of its suite is due again.
    TestBegins {
        /// Its suite.
        suite: SuiteId,
        /// Which.
        test: TestId,
        /// Its name.
        name: String,
    },
    /// A test is over.
    TestEnds {
        /// Its suite.
        suite: SuiteId,
        /// Which.
        test: TestId,
    },
    /// A hook is about to be started.
    HookBegins(HookBegins),
    /// The hook's process is there, and waits to be asked.
    HookStarted {
        /// Which.
        hook: HookId,
        /// Its process.
        pid: i32,
        /// Which descriptors come with this line, in this order.
        streams: Vec<ProcessStream>,
    },
    /// The hook is over.
    HookEnds {
        /// Which.
        hook: HookId,
        /// Why the robot may not be in a safe state.
        problem: Option<String>,
    },
    /// A fixture's process is there. It must live on while hooks run.
    FixtureStarted {
        /// Its process.
        pid: i32,
        /// Which descriptors come with this line, in this order.
        streams: Vec<ProcessStream>,
    },
    /// A fixture's process has ended.
    FixtureEnds {
        /// Its process.
        pid: i32,
    },
}

/// A hook is about to be started.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HookBegins {
    /// Which.
    pub hook: HookId,
    /// The scope of its process.
    pub scope: String,
    /// What called for it.
    pub trigger: Trigger,
    /// The same in words.
    pub reason: String,
    /// The test that it is about.
    pub test: Option<TestId>,
}

impl HookBegins {
    /// The same as an event.
    #[must_use]
    pub fn event(&self) -> EventKind {
        EventKind::HookStarted {
            hook: self.hook,
            trigger: self.trigger,
            reason: self.reason.clone(),
            test: self.test,
        }
    }
}

/// A hook as the guard needs it to run it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hook {
    /// Its id.
    pub id: HookId,
    /// Its suite.
    pub suite: SuiteId,
    /// Its name.
    pub name: String,
    /// Whether it is run when the runner dies; the others are only let come to their end.
    pub aborts: bool,
    /// The program and its arguments.
    pub command: Vec<String>,
    /// Environment variables beside the runner's own.
    pub env: Vec<(String, String)>,
    /// The working folder.
    pub folder: PathBuf,
    /// How long it may take.
    pub limit: Duration,
    /// What its host is asked to run, when it is a plug-in.
    pub plugin: Option<Plugin>,
}

impl Hook {
    /// What the guard needs of a suite's hook.
    #[must_use]
    pub fn of(suite: &SuitePlan, plan: &HookPlan) -> Self {
        let mut env = vec![(ENVIRONMENT_VARIABLE.to_owned(), suite.environment.clone())];
        env.extend(suite.env.iter().chain(&plan.env).cloned());
        env.push((OWNER_VARIABLE.to_owned(), format!("hook {}/{}", suite.name, plan.name)));
        let (command, plugin) = match &plan.body {
            HookBody::Command(command) => (command.clone(), None),
            HookBody::Plugin(plugin) => {
                env.extend_from_slice(&plugin.host.env);
                let asked = Plugin {
                    file: plugin.file.to_string_lossy().into_owned(),
                    name: plan.name.clone(),
                    param: plugin.param.clone(),
                    args: plugin.args.clone(),
                    environment: suite.environment.clone(),
                    repetition: 1,
                    is_last: true,
                    end_marker: None,
                    attachments_dir: None,
                };
                (plugin.host.command.clone(), Some(asked))
            }
        };
        Self {
            id: plan.id,
            suite: suite.id,
            name: plan.name.clone(),
            aborts: plan.on.iter().any(|on| matches!(on, Trigger::Interrupt | Trigger::End)),
            command,
            env,
            folder: suite.folder.clone(),
            limit: plan.timeout,
            plugin,
        }
    }
}
