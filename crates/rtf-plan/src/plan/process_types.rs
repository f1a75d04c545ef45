//! The plan of a process fixture and of its probes.

use std::path::PathBuf;
use std::time::Duration;

/// The plan of a fixture with `type="process"`.
#[derive(Clone, Debug)]
pub struct ProcessPlan {
    /// The program, as an absolute path unless it is remote, and its arguments.
    pub command: Vec<String>,
    /// Its probes; without `ready` probes, it is ready once started.
    pub probes: ProbePlans,
    /// The signal that stops it, by default 15 (SIGTERM).
    pub stop_signal: i32,
    /// The time between that signal and the kill.
    pub stop_grace: Duration,
    /// The accepted exit codes of a stopped process, in addition to 0.
    pub stop_codes: Vec<i32>,
    /// The remote machine on which it runs; `None` for this one.
    pub remote: Option<RemotePlan>,
}

#[derive(Clone, Debug)]
pub struct RemotePlan {
    /// The machine, as declared in the suite.
    pub host: String,
    /// The `ssh` command with the user's options.
    pub ssh: Vec<String>,
}

#[derive(Clone, Debug, Default)]
pub struct ProbePlans {
    /// The probes that must pass before it is ready.
    pub ready: Vec<Probe>,
    /// The probes that must pass while it is ready.
    pub alive: Vec<Probe>,
    pub values: Vec<ValueProbe>,
}

/// The source of a value of a process.
#[derive(Clone, Debug)]
pub struct ValueProbe {
    pub name: String,
    /// A log, whose pattern has a group for the value; a file or a command.
    pub probe: Probe,
}

#[derive(Clone, Debug)]
pub struct Probe {
    pub kind: ProbeKind,
    pub every: Duration,
    /// The limit for one answer.
    pub timeout: Duration,
}

#[derive(Clone, Debug)]
pub enum ProbeKind {
    /// Whether `host:port` accepts a TCP connection.
    Tcp(String),
    /// Whether an HTTP GET of the URL returns a 2xx status.
    Http(String),
    /// Whether a line of its output matches (for `alive`: whether none does).
    Log(regex::Regex),
    /// Whether the program exits with code 0.
    Command(Vec<String>),
    /// Whether the file exists.
    File(PathBuf),
    /// Whether a program that comes with `rtf` exits with code 0; otherwise its
    /// output is the reason.
    Middleware {
        /// The program and its arguments.
        command: Vec<String>,
        /// The probed object, for messages: "ros-topic `/chatter`".
        subject: String,
    },
}
