//! The declarations of a `<fixture>`, before any name is resolved.

use std::time::Duration;

use super::{DeclaredPlugin, HookKind, Span, Spanned};

#[derive(Clone, Debug)]
pub struct DeclaredFixture {
    /// The position of the tag.
    pub span: Span,
    pub name: Option<Spanned<String>>,
    /// The fixtures that must be ready before it; `None` without the attribute.
    pub depends: Option<Vec<Spanned<String>>>,
    pub body: FixtureKind,
    pub provides: Vec<DeclaredProvide>,
    /// How it is reset between two episodes of a campaign.
    pub reset: Option<DeclaredReset>,
    /// Environment variables in addition to the suite's.
    pub env: Vec<(String, String)>,
    /// The limit for its set-up.
    pub setup: Option<Duration>,
    /// The limit for one `check`.
    pub check: Option<Duration>,
    /// The limit for one `testStarted` or `testFinished`.
    pub notify: Option<Duration>,
    /// The limit for its tear-down.
    pub teardown: Option<Duration>,
    /// The maximum number of restarts after a collapse.
    pub restarts: Option<u32>,
    /// The delay before the first restart.
    pub restart_delay: Option<Duration>,
    /// The interval of checks while tests run.
    pub check_every: Option<Duration>,
}

#[derive(Clone, Debug)]
pub struct DeclaredReset {
    pub body: HookKind,
    pub timeout: Option<Duration>,
    /// After how many episodes the fixture is restarted instead.
    pub restart_every: Option<u32>,
}

#[derive(Clone, Debug)]
pub enum FixtureKind {
    Plugin(DeclaredPlugin),
    /// The built-in `type="process"`.
    Process(Box<DeclaredProcess>),
    /// The built-in `type="process"` with `attach="true"`.
    Attached(DeclaredProbes),
}

/// A `<provide>`: a value of a fixture.
#[derive(Clone, Debug)]
pub struct DeclaredProvide {
    /// The name, unique in the fixture.
    pub name: Spanned<String>,
    pub source: DeclaredValueSource,
    /// Whether it is neither stored nor shown.
    pub secret: bool,
}

#[derive(Clone, Debug)]
pub enum DeclaredValueSource {
    Plugin,
    /// The first group of the first matching line of the output.
    Log(regex::Regex),
    /// The content of a file.
    File(String),
    /// The output of a program.
    Command(Spanned<Vec<String>>),
}

/// A `<fixture type="process">`.
#[derive(Clone, Debug)]
pub struct DeclaredProcess {
    /// The program and its arguments; empty if they are missing, which was reported.
    pub command: Spanned<Vec<String>>,
    pub probes: DeclaredProbes,
    pub stop_signal: Option<i32>,
    /// The time between that signal and the kill.
    pub stop_grace: Option<Duration>,
    /// The accepted exit codes of a stopped process, in addition to 0.
    pub stop_codes: Vec<i32>,
    /// The remote machine on which it runs; `None` for this one.
    pub host: Option<Spanned<String>>,
}

/// The probes of a `<fixture type="process">`.
#[derive(Clone, Debug, Default)]
pub struct DeclaredProbes {
    pub ready: Vec<DeclaredProbe>,
    pub alive: Vec<DeclaredProbe>,
}

/// A `<ready>` or `<alive>` probe.
#[derive(Clone, Debug)]
pub struct DeclaredProbe {
    pub kind: DeclaredProbeKind,
    /// The position of the value.
    pub span: Span,
    pub every: Option<Duration>,
    /// The limit for one answer.
    pub timeout: Option<Duration>,
}

#[derive(Clone, Debug)]
pub enum DeclaredProbeKind {
    /// Whether `host:port` accepts a TCP connection.
    Tcp(String),
    /// Whether an HTTP GET of the URL returns a 2xx status.
    Http(String),
    /// Whether a line of the output matches.
    Log(regex::Regex),
    /// Whether the program exits with code 0.
    Command(Vec<String>),
    /// Whether the file exists.
    File(String),
    /// Whether a node, topic, service or port of a middleware is available.
    Middleware(MiddlewareProbe),
}

#[derive(Clone, Debug)]
pub struct MiddlewareProbe {
    /// The attribute: `ros-node`, `ros-topic`, …
    pub kind: &'static str,
    /// The name of the node, topic, service or port.
    pub name: String,
    /// The minimum rate of a topic in messages per second.
    pub min_rate: Option<f64>,
}
