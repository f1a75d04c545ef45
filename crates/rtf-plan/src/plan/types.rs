//! The plan: suites, fixtures, hooks and tests with every plug-in and host resolved.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use rtf_model::protocol::EpisodeSlots;
use rtf_model::{
    Episode, ExpectedFailure, FixtureId, HookId, LearnedLimits, Location, Parameter, SuiteId,
    SuitePrepared, TestId, Trigger,
};
use serde::{Deserialize, Serialize};

use super::hosts::SIGNALS;
use super::{CaseSelection, ProbePlans, ProcessPlan};
pub use crate::suite::{
    AfterCollapse, Leaks, LearnPlan, LearnedSides, RequiredResource, Retries, SuiteSettings,
    TestSettings,
};

/// The plan of a run. All input files are valid; only the outside world can still fail.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// The suites, in the order in which they run; the index is the [`SuiteId`].
    pub suites: Vec<SuitePlan>,
    /// The number of fixtures over all suites.
    pub fixtures: u32,
    /// The number of hooks over all suites.
    pub hooks: u32,
    /// The number of tests over all suites.
    pub tests: u32,
}

impl Plan {
    /// Creates a plan of suites with distinct names, and assigns all ids.
    #[must_use]
    pub fn new(mut suites: Vec<SuitePlan>) -> Self {
        let (mut fixtures, mut hooks, mut tests) = (0, 0, 0);
        for (id, suite) in (0..).zip(&mut suites) {
            suite.id = SuiteId(id);
            for fixture in &mut suite.fixtures {
                fixture.id = FixtureId(fixtures);
                fixtures += 1;
            }
            for hook in &mut suite.hooks {
                hook.id = HookId(hooks);
                hooks += 1;
            }
            for test in &mut suite.tests {
                test.id = TestId(tests);
                tests += 1;
            }
        }
        Self { suites, fixtures, hooks, tests }
    }
}

#[derive(Clone, Debug, Default)]
pub struct SuitePlan {
    pub id: SuiteId,
    /// The name, unique in the run.
    pub name: String,
    /// The file as the user named it; empty for plug-ins that are given directly.
    pub file: String,
    /// The working directory of its processes: the suite file's, or the current one.
    pub folder: PathBuf,
    /// Environment variables of all its processes, in order.
    pub env: Arc<Vec<(String, String)>>,
    pub isolate: Isolation,
    pub preparation: Preparation,
    pub settings: SuiteSettings,
    /// The episodes of a campaign that it runs; empty for one run without a campaign.
    pub episodes: Arc<[Episode]>,
    /// Whether further episodes may arrive while it runs.
    pub awaits_episodes: bool,
    /// Whether its texts contain references to values of fixtures or to parameters of episodes, or
    /// escaped ones.
    pub refers_to_values: bool,
    /// The simulated clock; `None` for the wall clock.
    pub clock: Option<ClockPlan>,
    /// The fixtures: each after its dependencies, otherwise in the order of the file.
    pub fixtures: Vec<FixturePlan>,
    /// The hooks, in the order in which simultaneously triggered ones run.
    pub hooks: Vec<HookPlan>,
    /// The tests, in the order in which they run.
    pub tests: Vec<TestPlan>,
}

impl SuitePlan {
    /// Checks whether any test has more than one repetition.
    #[must_use]
    pub fn repeats(&self) -> bool {
        self.tests.iter().any(|test| test.settings.repetitions > 1)
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClockPlan {
    /// The limit in wall time, as a multiple of a test's limit; at least 1.
    pub backstop: u32,
}

/// The private resources of a suite. The texts of the plan still contain `${port:name}`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Isolation {
    /// Whether it gets a private network.
    pub network: bool,
    pub middleware: OwnMiddleware,
    /// Whether it uses the user's YARP name server although its other middleware is private.
    pub shares_name_server: bool,
    /// The names of its ports, sorted.
    pub ports: Vec<String>,
}

/// Whether a suite gets private middleware.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OwnMiddleware {
    /// It shares existing middleware.
    No,
    /// It gets a private ROS 2 domain, unless the user's environment selects one. It shares
    /// other middleware.
    #[default]
    Ros2UnlessSet,
    /// It gets private middleware unless the user's environment selects one.
    UnlessSet,
    /// It gets private middleware, regardless of the user's environment.
    Always,
}

/// The result of preparing a suite's isolation. The engine sets it when the suite starts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Preparation {
    /// No isolation is needed, or the suite has not started yet.
    #[default]
    NotNeeded,
    Done(SuitePrepared),
    /// The isolation is not available, for this reason; the suite is not started.
    Refused(String),
}

#[derive(Clone, Debug)]
pub struct FixturePlan {
    pub id: FixtureId,
    /// The name, unique in the suite.
    pub name: String,
    /// The dependencies, as indexes of the suite's fixtures. They must be ready
    /// before its set-up and are torn down after it.
    pub depends: Vec<usize>,
    pub body: FixtureBody,
    /// The values that it must provide before it is ready.
    pub provides: Vec<ProvidePlan>,
    /// Environment variables in addition to the suite's.
    pub env: Vec<(String, String)>,
    pub limits: FixtureLimits,
    /// How it is reset between two episodes of a campaign; without, it is restarted.
    pub reset: Option<ResetPlan>,
    /// The maximum number of restarts after a collapse.
    pub restarts: u32,
    /// The delay before the first restart; it doubles with each further restart,
    /// up to ten seconds.
    pub restart_delay: Duration,
    /// The interval of `check` or `<alive>` while tests run; `None`: only before each test.
    pub check_every: Option<Duration>,
}

impl FixturePlan {
    /// Whether it is the fixture that evaluates monitors: it measures what it has judged itself.
    #[must_use]
    pub fn evaluates_monitors(&self) -> bool {
        let is_signals = |plugin: &PluginPlan| &*plugin.plugin_type == SIGNALS.name;
        matches!(&self.body, FixtureBody::Plugin(plugin) if is_signals(plugin))
    }

    /// Checks whether a value is neither stored nor shown. An undeclared value is not secret.
    #[must_use]
    pub fn is_secret(&self, value: &str) -> bool {
        self.provides.iter().any(|known| known.secret && known.name == value)
    }
}

/// How a fixture is reset between two episodes of a campaign.
#[derive(Clone, Debug)]
pub struct ResetPlan {
    pub body: HookBody,
    pub timeout: Duration,
    /// After how many episodes the fixture is restarted; `None`: never.
    pub restart_every: Option<u32>,
}

/// A declared value of a fixture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProvidePlan {
    /// The name, unique in the fixture.
    pub name: String,
    /// Whether it is neither stored nor shown.
    pub secret: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FixtureLimits {
    /// From the start of its process until it is ready.
    pub setup: Duration,
    pub check: Duration,
    /// For one `testStarted` or `testFinished`.
    pub notify: Duration,
    /// From the request to stop until its process has exited.
    pub teardown: Duration,
}

#[derive(Clone, Debug)]
pub enum FixtureBody {
    Plugin(PluginPlan),
    /// The built-in `type="process"`.
    Process(Arc<ProcessPlan>),
    /// A process that is already running, and is only monitored.
    Attached(Arc<ProbePlans>),
}

impl FixtureBody {
    #[must_use]
    pub fn probes(&self) -> Option<&ProbePlans> {
        match self {
            Self::Plugin(_) => None,
            Self::Process(process) => Some(&process.probes),
            Self::Attached(probes) => Some(probes),
        }
    }
}

#[derive(Clone, Debug)]
pub struct TestPlan {
    pub id: TestId,
    /// The name, unique in the suite.
    pub name: String,
    /// The former name.
    pub was: Option<Box<str>>,
    /// The line of its tag in the file of the suite; 0 for a plug-in on the command line.
    pub line: u32,
    pub plugin: PluginPlan,
    /// Environment variables in addition to the suite's.
    pub env: Vec<(String, String)>,
    /// Tests with equal limits share them.
    pub limits: Arc<TestLimits>,
    pub settings: TestSettings,
    /// The tags of the suite and of the test.
    pub tags: Vec<String>,
    pub combination: Option<Box<CombinationPlan>>,
    pub learn: Vec<LearnPlan>,
    /// Set before the run starts.
    pub learned: Vec<LearnedLimits>,
    pub expected: Option<Box<ExpectedFailure>>,
    /// Of a test that runs many episodes: how.
    pub slots: Option<EpisodeSlots>,
    /// The cases that it runs; `None` for all.
    pub cases: Option<Box<CaseSelection>>,
    /// For a test of another framework, whose host runs cases in programs.
    pub cases_in_programs: Option<Box<CasesInPrograms>>,
}

impl TestPlan {
    /// Restricts the test to cases. It then has a separate process: only the first test of a
    /// shared host knows whether the host can select cases.
    pub fn select_cases(&mut self, cases: CaseSelection) {
        self.settings.shared = false;
        self.cases = Some(Box::new(cases));
    }

    /// Checks whether both tests can run in one host, one after the other.
    #[must_use]
    pub fn can_share_host(&self, other: &Self) -> bool {
        let needs = (self.settings.leaks, &self.env, &self.plugin.host);
        self.settings.shared
            && other.settings.shared
            && needs == (other.settings.leaks, &other.env, &other.plugin.host)
    }

    /// Returns all its cases, if they are known before the run.
    #[must_use]
    pub fn listed_cases(&self) -> Option<&[ListedCase]> {
        self.cases_in_programs.as_ref()?.listed.as_deref()
    }

    /// Returns its values of a matrix.
    #[must_use]
    pub fn parameters(&self) -> &[Parameter] {
        self.combination.as_ref().map_or(&[], |combination| &combination.parameters)
    }

    /// Returns the name of the test with the matrix: `Move` of `Move[joint=0]`.
    #[must_use]
    pub fn matrix(&self) -> Option<&str> {
        self.combination.as_ref().map(|combination| &*combination.test)
    }
}

/// How a host runs cases in programs of another framework.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CasesInPrograms {
    pub case_timeout: Option<Duration>,
    /// Whether each case needs a separate process.
    pub separate: bool,
    /// Whether these processes may be forked after the program's static objects are
    /// constructed.
    pub fork_at_main: bool,
    /// All cases of the test, in the order of the framework; `None` if they are known only
    /// when it runs.
    pub listed: Option<Arc<[ListedCase]>>,
}

/// A case that a host lists before the run (`spec/frameworks.md`).
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
pub struct ListedCase {
    /// The name, unique in the test. It may contain slashes.
    pub name: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub location: Option<Location>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
    /// Whether its framework does not run it unless it is selected.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub disabled: bool,
}

/// One combination of the values of a matrix.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CombinationPlan {
    /// The name of the test with the matrix.
    pub test: Arc<str>,
    pub parameters: Vec<Parameter>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TestLimits {
    /// From the start of its process to `setup`.
    pub load: Duration,
    pub setup: Duration,
    pub run: Duration,
    /// For `tearDown`, and then for the exit of the process.
    pub teardown: Duration,
    /// The time in `run` after which the test is reported as slow.
    pub slow: Duration,
    /// The time between the request to stop and the kill.
    pub grace: Duration,
}

/// The plan of a hook, which brings the robot into a safe state.
#[derive(Clone, Debug)]
pub struct HookPlan {
    pub id: HookId,
    /// The name, unique in the suite.
    pub name: String,
    pub on: Vec<Trigger>,
    pub body: HookBody,
    /// Environment variables in addition to the suite's.
    pub env: Vec<(String, String)>,
    pub timeout: Duration,
}

/// The kinds of hooks and resets.
#[derive(Clone, Debug)]
pub enum HookBody {
    /// A test plug-in in a host; it succeeds by passing.
    Plugin(PluginPlan),
    /// A command; it succeeds with exit code 0.
    Command(Vec<String>),
}

#[derive(Clone, Debug)]
pub struct PluginPlan {
    /// The type: `dll`, `lua`, `python`, `ruby`.
    pub plugin_type: Arc<str>,
    /// The absolute path of the plug-in's file.
    pub file: PathBuf,
    pub param: String,
    /// The parameter string, split into arguments.
    pub args: Vec<String>,
    /// The host, shared by all plug-ins of a type.
    pub host: Arc<HostPlan>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HostPlan {
    /// The program and its arguments.
    pub command: Vec<String>,
    pub env: Vec<(String, String)>,
    /// Whether it can run as a fork server, which is forked for each test.
    pub forks: bool,
}
