//! The ways in which tests get their hosts.

/// How hosts are started, and how many tests each of them serves.
#[derive(Clone, Copy, Debug)]
pub struct Mode {
    /// Its name.
    pub name: &'static str,
    /// The word after `--fork`.
    pub fork: &'static str,
    /// The word of `isolation`.
    pub isolation: &'static str,
}

impl Mode {
    /// Whether tests that pass may have a host together.
    pub fn shares(self) -> bool {
        self.isolation == "shared"
    }
}

/// Executed for each test.
pub const PROCESS: Mode = Mode { name: "process", fork: "never", isolation: "process" };
/// Forked for each test.
pub const FORKED: Mode = Mode { name: "forked", fork: "always", isolation: "process" };
/// One for the tests that follow each other.
pub const SHARED: Mode = Mode { name: "shared", fork: "auto", isolation: "shared" };

/// All of them.
pub const MODES: [Mode; 3] = [PROCESS, FORKED, SHARED];
