//! A request to start a process.

use std::path::PathBuf;
use std::sync::Arc;

use crate::namespaces::Namespaces;

/// The captured outputs of a process.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Streams {
    #[default]
    Both,
    /// Standard output; standard error is discarded.
    StdoutOnly,
    /// None; both are discarded.
    None,
    /// None: the process has those of the runner, its standard input, and the foreground
    /// of its terminal.
    Terminal,
}

/// What a process is for. Decides on reserved descriptors, on the out-of-memory score
/// and on back-pressure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProcessRole {
    Test,
    Fixture,
    /// Is a hook, which must run under all circumstances.
    Hook,
}

/// A process to start. It becomes the leader of a new process group.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SpawnRequest {
    /// The program and its arguments.
    pub command: Vec<String>,
    /// Environment variables in addition to the runner's; later ones win.
    pub env: Vec<(String, String)>,
    /// The working directory; the runner's when `None`.
    pub working_dir: Option<PathBuf>,
    /// The first bytes written to its channel; `None` for a process without one.
    pub channel: Option<Vec<u8>>,
    pub streams: Streams,
    /// Whether the command is a host that supports forking, and may be forked.
    pub can_fork: bool,
    /// The namespaces that it enters; the runner's when `None`.
    pub namespaces: Option<Arc<Namespaces>>,
    /// `None` for a process of the runner itself.
    pub role: Option<ProcessRole>,
}
