//! What will be done: suites, fixtures and tests with every plug-in and host found.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use rtf_model::{FixtureId, HookId, SuiteId, SuitePrepared, TestId, Trigger};

pub use crate::suite::{AfterCollapse, Leaks, Resource, Retries};

/// Everything that a run will do. Nothing in it can fail to be understood
/// any more; what can still fail is the world.
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
    /// The plan of these suites, whose names differ: gives the ids.
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

/// One suite.
#[derive(Clone, Debug)]
pub struct SuitePlan {
    /// Its id.
    pub id: SuiteId,
    /// Its name, unique in the run.
    pub name: String,
    /// Its file as the user named it; empty for plug-ins given on the command line.
    pub file: String,
    /// The working folder of its processes: the suite file's, or the current one.
    pub folder: PathBuf,
    /// Its description, white space folded.
    pub description: String,
    /// Its environment string.
    pub environment: String,
    /// Environment variables for all its processes, in order.
    pub env: Arc<Vec<(String, String)>>,
    /// The limit for the whole suite, set-up and tear-down of fixtures included.
    pub timeout: Option<Duration>,
    /// What it is to get for itself when it starts.
    pub isolate: Isolation,
    /// What it got.
    pub given: Given,
    /// What nobody else may use meanwhile, sorted by name.
    pub requires: Vec<Resource>,
    /// Whether a fixture's collapse leaves the suite green.
    pub tolerates_collapse: bool,
    /// Whether a critical test or assertion that fails ends the whole run, not only the suite.
    pub critical_stops_run: bool,
    /// How many of its tests may run at the same time; 1 for one after the other.
    pub parallel: u32,
    /// What its tests follow, if not the wall clock.
    pub clock: Option<ClockPlan>,
    /// The fixtures: each after those that it depends on, else in the order of the file.
    pub fixtures: Vec<FixturePlan>,
    /// The hooks, in the order in which they are run when several are called for.
    pub hooks: Vec<HookPlan>,
    /// The tests, in the order in which they run.
    pub tests: Vec<TestPlan>,
}

impl SuitePlan {
    /// Whether one of its tests has further repetitions.
    #[must_use]
    pub fn repeats(&self) -> bool {
        self.tests.iter().any(|test| test.repetitions > 1)
    }
}

/// A simulated time that tests follow.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClockPlan {
    /// How many times a limit a test may take in wall time, from 1.
    pub backstop: u32,
}

/// What a suite is to get for itself. Its texts still have their `${port:name}`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Isolation {
    /// Whether it gets a network of its own.
    pub network: bool,
    /// Whether it gets middleware of its own.
    pub middleware: OwnMiddleware,
    /// The names of its ports, sorted.
    pub ports: Vec<String>,
}

/// Whether a suite gets middleware of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OwnMiddleware {
    /// It talks to what runs already.
    #[default]
    No,
    /// Where the user's environment does not say which to use.
    UnlessSet,
    /// Whatever the user's environment says.
    Always,
}

/// What a suite got for itself. A plan that was just made knows nothing of it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Given {
    /// It needs nothing.
    #[default]
    Nothing,
    /// All that it needs.
    All(SuitePrepared),
    /// It cannot have what it needs, for this reason: nothing of it is started.
    Refused(String),
}

/// One fixture.
#[derive(Clone, Debug)]
pub struct FixturePlan {
    /// Its id.
    pub id: FixtureId,
    /// Its name, unique in the suite.
    pub name: String,
    /// The places in the suite's list of the fixtures that must be ready before
    /// it is set up, and that are torn down after it.
    pub depends: Vec<usize>,
    /// What it is.
    pub body: FixtureBody,
    /// Environment variables beside the suite's.
    pub env: Vec<(String, String)>,
    /// The limits of its phases.
    pub limits: FixtureLimits,
    /// How often it may be started again after a collapse.
    pub restarts: u32,
    /// How long the first restart waits; each further one waits twice as long,
    /// up to ten seconds.
    pub restart_delay: Duration,
    /// How often `check` (or `<alive>`) is asked while tests run; `None`: only before each test.
    pub check_every: Option<Duration>,
}

/// The limits of a fixture's phases.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FixtureLimits {
    /// From the start of its process to ready.
    pub setup: Duration,
    /// For one `check`.
    pub check: Duration,
    /// For one `testStarted` or `testFinished`.
    pub notice: Duration,
    /// From the request to stop to the end of its process.
    pub teardown: Duration,
}

/// What a fixture is.
#[derive(Clone, Debug)]
pub enum FixtureBody {
    /// A fixture plug-in in a host.
    Plugin(PluginPlan),
    /// The built-in `type="process"`.
    Process(Arc<ProcessPlan>),
    /// Something that runs already, and is only watched.
    Attached(Arc<AttachedPlan>),
}

/// One declared test.
#[derive(Clone, Debug)]
pub struct TestPlan {
    /// Its id.
    pub id: TestId,
    /// Its name, unique in the suite.
    pub name: String,
    /// The plug-in.
    pub plugin: PluginPlan,
    /// Environment variables beside the suite's.
    pub env: Vec<(String, String)>,
    /// How often it runs.
    pub repetitions: u32,
    /// The limits of its phases, shared between tests that have the same.
    pub limits: Arc<TestLimits>,
    /// What happens to it when a fixture collapses while it runs.
    pub after_collapse: AfterCollapse,
    /// What is said of it when it leaves processes behind.
    pub leaks: Leaks,
    /// How often it is tried again when it fails.
    pub retries: Retries,
    /// Whether the rest of the suite is skipped when it does not pass.
    pub critical: bool,
    /// Whether no other test of the suite runs beside it.
    pub exclusive: bool,
    /// Whether it may share a host with the tests around it.
    pub shared: bool,
    /// The tags given in the suite.
    pub tags: Vec<String>,
}

/// The limits of a test's phases.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TestLimits {
    /// From the start of its process to `setup`.
    pub load: Duration,
    /// For `setup`.
    pub setup: Duration,
    /// For `run`.
    pub run: Duration,
    /// For `tearDown`, and then for the end of the process.
    pub teardown: Duration,
    /// After this long in `run` the test is reported as slow.
    pub slow: Duration,
    /// From the request to stop to the use of force.
    pub grace: Duration,
}

/// What brings the robot into a safe state.
#[derive(Clone, Debug)]
pub struct HookPlan {
    /// Its id.
    pub id: HookId,
    /// Its name, unique in the suite.
    pub name: String,
    /// What calls for it.
    pub on: Vec<Trigger>,
    /// What it is.
    pub body: HookBody,
    /// Environment variables beside the suite's.
    pub env: Vec<(String, String)>,
    /// How long it may take.
    pub timeout: Duration,
}

/// What a hook is.
#[derive(Clone, Debug)]
pub enum HookBody {
    /// A test plug-in in a host: it did its work when it passes.
    Plugin(PluginPlan),
    /// A command: it did its work when it ends with exit code 0.
    Command(Vec<String>),
}

/// A plug-in and the host that runs it.
#[derive(Clone, Debug)]
pub struct PluginPlan {
    /// The type as in the suite: `dll`, `lua`, `python`, `ruby`.
    pub plugin_type: Arc<str>,
    /// The plug-in's file, absolute.
    pub file: PathBuf,
    /// The parameter string as in the suite.
    pub param: String,
    /// The parameter string, split into arguments.
    pub args: Vec<String>,
    /// The host, shared between all plug-ins of a type.
    pub host: Arc<HostPlan>,
}

/// How to start a host.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HostPlan {
    /// The program and its arguments.
    pub command: Vec<String>,
    /// Environment variables that it needs.
    pub env: Vec<(String, String)>,
    /// Whether it can be started once and forked for each test.
    pub forks: bool,
}

/// The built-in `type="process"` fixture.
#[derive(Clone, Debug)]
pub struct ProcessPlan {
    /// The program (absolute or found in the path) and its arguments.
    pub command: Vec<String>,
    /// All must hold before it is ready; empty: ready once it was started.
    pub ready: Vec<Probe>,
    /// Each must hold while it is ready.
    pub alive: Vec<Probe>,
    /// The signal that asks it to stop, 15 (SIGTERM) unless told.
    pub stop_signal: i32,
    /// How long it may take to stop before it is killed.
    pub stop_grace: Duration,
    /// The other machine that it runs on.
    pub remote: Option<RemotePlan>,
}

/// Another machine.
#[derive(Clone, Debug)]
pub struct RemotePlan {
    /// The machine, as in the suite.
    pub host: String,
    /// The `ssh` command and the user's options.
    pub ssh: Vec<String>,
}

/// The built-in `type="process"` with `attach="true"`.
#[derive(Clone, Debug)]
pub struct AttachedPlan {
    /// All must hold before it is ready.
    pub ready: Vec<Probe>,
    /// Each must hold while it is ready.
    pub alive: Vec<Probe>,
}

/// A question about a process fixture.
#[derive(Clone, Debug)]
pub struct Probe {
    /// What is asked.
    pub kind: ProbeKind,
    /// How often it is asked.
    pub every: Duration,
    /// How long one answer may take.
    pub timeout: Duration,
}

/// What a [`Probe`] asks.
#[derive(Clone, Debug)]
pub enum ProbeKind {
    /// Whether a TCP connection to `host:port` is accepted.
    Tcp(String),
    /// Whether an HTTP GET of the URL answers with a 2xx status.
    Http(String),
    /// Whether a line of its output matches (for `alive`: whether none does).
    Log(regex::Regex),
    /// Whether the program ends with exit code 0.
    Command(Vec<String>),
    /// Whether the file exists.
    File(PathBuf),
    /// Whether the program, which comes with rtf, ends with exit code 0; else
    /// its output is the reason.
    Middleware {
        /// The program and its arguments.
        command: Vec<String>,
        /// What it looks at: "ROS topic `/chatter`".
        subject: String,
    },
}
