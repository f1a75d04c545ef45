//! What tests of another framework need: the file that they name, their list, their processes.

use std::path::Path;
use std::time::Duration;

use super::unix::is_executable;

/// The properties of a type whose tests another framework runs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Framework {
    pub subject: TestSubject,
    /// Whether its cases can be listed before the run.
    pub lists_cases: bool,
    /// Whether `rtf run` lists them although no case is selected: the list checks the program,
    /// or compiles it.
    pub lists_before_run: bool,
    pub limits: CaseLimits,
    /// Which processes of its programs can be forked (`spec/frameworks.md`).
    pub forks: Forks,
    /// The limit of the check of one file; `None` for the usual one.
    pub check_limit: Option<Duration>,
}

/// Which cases of a test `case-timeout` limits: those whose start is reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CaseLimits {
    All,
    /// Subtests that the program announces.
    AnnouncedSubtests,
    /// There are none, or they are reported when the program has ended.
    None,
}

/// Which processes of the programs of a framework can be forked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Forks {
    Never,
    /// Those of tests whose cases have a process each.
    IfSeparate,
    /// All: each case always has a process.
    Always,
}

/// The kind of file that a test of another framework names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TestSubject {
    Program,
    File,
    Directory,
    FileOrDirectory,
}

impl TestSubject {
    /// Returns the noun for messages.
    pub fn noun(self) -> &'static str {
        match self {
            Self::Program => "program",
            Self::File => "file",
            Self::Directory => "directory",
            Self::FileOrDirectory => "file or directory",
        }
    }

    pub fn accepts(self, path: &Path) -> bool {
        match self {
            Self::Program => is_executable(path),
            Self::File => path.is_file(),
            Self::Directory => path.is_dir(),
            Self::FileOrDirectory => path.exists(),
        }
    }
}
