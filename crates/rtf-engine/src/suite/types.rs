//! What a suite file says, before anything is looked up.

use std::time::Duration;

use rtf_model::Trigger;

use super::{Span, Spanned};

/// A suite file.
#[derive(Clone, Debug)]
pub struct Suite {
    /// The name of the `<suite>` element's tag.
    pub span: Span,
    /// Its name, if it has one.
    pub name: Option<Spanned<String>>,
    /// Its description, white space folded.
    pub description: String,
    /// Its environment string.
    pub environment: String,
    /// Environment variables for all its processes, in order.
    pub env: Vec<(String, String)>,
    /// The limit for the whole suite.
    pub timeout: Option<Duration>,
    /// Tags that all its tests have.
    pub tags: Vec<String>,
    /// What it gets for itself.
    pub isolate: WrittenIsolation,
    /// What nobody else may use meanwhile, sorted by name.
    pub requires: Vec<Resource>,
    /// Whether a fixture's collapse leaves the suite green.
    pub tolerates_collapse: bool,
    /// Whether a critical test or assertion that fails ends the whole run, not only the suite.
    pub critical_stops_run: bool,
    /// How many of its tests may run at the same time.
    pub parallel: u32,
    /// Whose time its tests follow, if not the wall clock's.
    pub clock: Option<WrittenClock>,
    /// The fixtures, in order.
    pub fixtures: Vec<Fixture>,
    /// The hooks, in order.
    pub hooks: Vec<Hook>,
    /// The tests, in order.
    pub tests: Vec<Test>,
}

/// Something of which there is a certain number in the world.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Resource {
    /// Its name: `robot:icub`.
    pub name: String,
    /// How many suites may have one of it at the same time.
    pub slots: u32,
}

/// What a suite asks to get for itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WrittenIsolation {
    /// Whether it gets a network of its own.
    pub network: bool,
    /// Which middleware it talks to, if it says so.
    pub middleware: Option<Middleware>,
    /// The names of its ports, sorted.
    pub ports: Vec<String>,
}

/// A simulated time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WrittenClock {
    /// Where it comes from.
    pub source: ClockSource,
    /// How many times a limit a test may take in wall time.
    pub backstop: Option<u32>,
    /// Where the suite says so.
    pub span: Span,
}

/// Where simulated time comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClockSource {
    /// The ROS 1 topic `/clock`.
    Ros,
    /// The ROS 2 topic `/clock`.
    Ros2,
    /// YARP's network clock.
    Yarp,
    /// A file that a fixture writes.
    File,
}

impl ClockSource {
    /// As suites write it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Ros => "ros",
            Self::Ros2 => "ros2",
            Self::Yarp => "yarp",
            Self::File => "file",
        }
    }
}

/// Which middleware the processes of a suite talk to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Middleware {
    /// The suite's own.
    Own,
    /// What runs already.
    Shared,
}

/// A `<test>`.
#[derive(Clone, Debug)]
pub struct Test {
    /// The name of the element's tag.
    pub span: Span,
    /// Its name, if the file gives one.
    pub name: Option<Spanned<String>>,
    /// The plug-in and its parameters.
    pub plugin: Plugin,
    /// How often it runs.
    pub repetitions: u32,
    /// Its limits, those of the suite included.
    pub limits: WrittenLimits,
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
    /// Its own tags.
    pub tags: Vec<String>,
    /// Environment variables beside the suite's.
    pub env: Vec<(String, String)>,
}

/// How often a test is tried again when it fails.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Retries {
    /// The most attempts after the first one, of each repetition.
    pub count: u32,
    /// How long each of them waits.
    pub delay: Duration,
}

/// What a plug-in is called.
#[derive(Clone, Debug)]
pub struct Plugin {
    /// The plug-in's name as written.
    pub name: Spanned<String>,
    /// The type as written, if there is one.
    pub plugin_type: Option<Spanned<String>>,
    /// The parameter string.
    pub param: String,
}

/// The limits that a suite sets, where it sets them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct WrittenLimits {
    /// For loading.
    pub load: Option<Duration>,
    /// For `setup`.
    pub setup: Option<Duration>,
    /// For `run`.
    pub run: Option<Duration>,
    /// For `tearDown`.
    pub teardown: Option<Duration>,
    /// After this long in `run` the test is reported as slow.
    pub slow: Option<Duration>,
    /// From the request to stop to the use of force.
    pub grace: Option<Duration>,
}

/// What happens to a test when a fixture collapses while it runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum AfterCollapse {
    /// It is `collapsed`; the suite goes on with the next test.
    #[default]
    Fail,
    /// It is run again once the fixture is back.
    Rerun,
    /// It is `skipped`.
    Skip,
}

/// What is said of a test that left processes behind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Leaks {
    /// The processes are killed and named.
    #[default]
    Report,
    /// And the test, had it passed, is an error.
    Fail,
}

/// A `<fixture>`.
#[derive(Clone, Debug)]
pub struct Fixture {
    /// The name of the element's tag.
    pub span: Span,
    /// Its name, if the file gives one.
    pub name: Option<Spanned<String>>,
    /// The fixtures that must stand before it; `None` when it does not say.
    pub depends: Option<Vec<Spanned<String>>>,
    /// What it is.
    pub body: FixtureKind,
    /// Environment variables beside the suite's.
    pub env: Vec<(String, String)>,
    /// The limit for its set-up.
    pub setup: Option<Duration>,
    /// The limit for one `check`.
    pub check: Option<Duration>,
    /// The limit for one `testStarted` or `testFinished`.
    pub notice: Option<Duration>,
    /// The limit for its tear-down.
    pub teardown: Option<Duration>,
    /// How often it may be started again after a collapse.
    pub restarts: Option<u32>,
    /// How long the first of these restarts waits.
    pub restart_delay: Option<Duration>,
    /// How often it is checked while tests run.
    pub check_every: Option<Duration>,
}

/// What a `<fixture>` is.
#[derive(Clone, Debug)]
pub enum FixtureKind {
    /// A fixture plug-in.
    Plugin(Plugin),
    /// The built-in `type="process"`.
    Process(Box<Process>),
    /// The same with `attach="true"`.
    Attached(Attached),
}

/// A `<fixture type="process" attach="true">`.
#[derive(Clone, Debug)]
pub struct Attached {
    /// The `<ready>` probes.
    pub ready: Vec<Probe>,
    /// The `<alive>` probes.
    pub alive: Vec<Probe>,
}

/// A `<fixture type="process">`.
#[derive(Clone, Debug)]
pub struct Process {
    /// The program and its arguments; empty when the file has none (a problem is reported).
    pub command: Spanned<Vec<String>>,
    /// The `<ready>` probes.
    pub ready: Vec<Probe>,
    /// The `<alive>` probes.
    pub alive: Vec<Probe>,
    /// The signal that asks it to stop.
    pub stop_signal: Option<i32>,
    /// How long it may take to stop.
    pub stop_grace: Option<Duration>,
    /// The machine that it runs on, if it is another one.
    pub host: Option<Spanned<String>>,
}

/// A `<hook>`.
#[derive(Clone, Debug)]
pub struct Hook {
    /// Its name, if the file gives one.
    pub name: Option<Spanned<String>>,
    /// What calls for it, each once; empty when the file says nothing that is
    /// known (a problem is reported).
    pub on: Vec<Trigger>,
    /// What it is.
    pub body: HookKind,
    /// Environment variables beside the suite's.
    pub env: Vec<(String, String)>,
    /// How long it may take.
    pub timeout: Option<Duration>,
}

/// What a `<hook>` is.
#[derive(Clone, Debug)]
pub enum HookKind {
    /// A test plug-in.
    Plugin(Plugin),
    /// A program and its arguments; empty when they cannot be read (a problem is reported).
    Command(Spanned<Vec<String>>),
}

/// A `<ready>` or an `<alive>`.
#[derive(Clone, Debug)]
pub struct Probe {
    /// What is asked.
    pub question: Question,
    /// Where the question was written.
    pub span: Span,
    /// How often it is asked.
    pub every: Option<Duration>,
    /// How long one answer may take.
    pub timeout: Option<Duration>,
}

/// What a [`Probe`] asks.
#[derive(Clone, Debug)]
pub enum Question {
    /// Whether a TCP connection to `host:port` is accepted.
    Tcp(String),
    /// Whether an HTTP GET of the URL answers with a 2xx status.
    Http(String),
    /// Whether a line of the output matches.
    Log(regex::Regex),
    /// Whether the program ends with exit code 0.
    Command(Vec<String>),
    /// Whether the file exists.
    File(String),
    /// Whether something of a middleware is there and well.
    Middleware(MiddlewareQuestion),
}

/// What is asked of a middleware.
#[derive(Clone, Debug)]
pub struct MiddlewareQuestion {
    /// The attribute: `ros-node`, `ros-topic`, …
    pub kind: &'static str,
    /// The node, topic, service or port.
    pub name: String,
    /// How many messages a second a topic has at least.
    pub min_rate: Option<f64>,
}
