//! The catalogue of other test frameworks, whose tests `rtf-host-framework` runs
//! (`spec/frameworks.md`).

use std::path::Path;
use std::time::Duration;

use super::hosts::{HostKind, HostStart, PYTHON_SDK, Sdk};
use super::unix::is_executable;

/// The properties of a type whose tests another framework runs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Framework {
    /// The kind of file that a test names.
    pub subject: TestSubject,
    /// Whether its cases can be listed before the run.
    pub lists_cases: bool,
    /// Whether `rtf run` lists them although no case is selected: the list checks the program,
    /// or compiles it.
    pub lists_before_run: bool,
    /// Which processes of its programs can be forked (`spec/frameworks.md`).
    pub forks: Forks,
    /// The limit of the check of one file; `None` for the usual one.
    pub check_limit: Option<Duration>,
}

/// Which processes of the programs of a framework can be forked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Forks {
    /// None.
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

    /// Checks whether a path is of this kind.
    pub fn accepts(self, path: &Path) -> bool {
        match self {
            Self::Program => is_executable(path),
            Self::File => path.is_file(),
            Self::Directory => path.is_dir(),
            Self::FileOrDirectory => path.exists(),
        }
    }
}

/// The limit of a check that starts the program, or imports the user's modules.
const LIST_LIMIT: Option<Duration> = Some(Duration::from_secs(2 * 60));
/// The limit of a check that compiles or starts a virtual machine.
const COMPILE_LIMIT: Option<Duration> = Some(Duration::from_secs(10 * 60));

const LISTED_PROGRAM: Framework = Framework {
    subject: TestSubject::Program,
    lists_cases: true,
    lists_before_run: true,
    forks: Forks::Never,
    check_limit: LIST_LIMIT,
};
const FORKED_PROGRAM: Framework = Framework { forks: Forks::IfSeparate, ..LISTED_PROGRAM };
const UNLISTED_PROGRAM: Framework =
    Framework { lists_cases: false, check_limit: None, ..LISTED_PROGRAM };
const PYTHON_TESTS: Framework =
    Framework { subject: TestSubject::FileOrDirectory, lists_before_run: false, ..LISTED_PROGRAM };
const BUILT_DIRECTORY: Framework =
    Framework { subject: TestSubject::Directory, check_limit: COMPILE_LIMIT, ..LISTED_PROGRAM };

/// All frameworks.
pub(super) static FRAMEWORKS: [HostKind; 15] = [
    kind(&["gtest"], FORKED_PROGRAM),
    kind(&["catch2"], FORKED_PROGRAM),
    kind(&["doctest"], FORKED_PROGRAM),
    kind(&["boost"], Framework { forks: Forks::Always, ..LISTED_PROGRAM }),
    kind(&["cppunit"], UNLISTED_PROGRAM),
    kind(&["aunit"], UNLISTED_PROGRAM),
    HostKind {
        extensions: &["jar"],
        ..kind(&["junit"], Framework { subject: TestSubject::FileOrDirectory, ..BUILT_DIRECTORY })
    },
    with_python_sdk(kind(&["pytest"], PYTHON_TESTS)),
    with_python_sdk(kind(&["unittest"], PYTHON_TESTS)),
    kind(&["ctest"], Framework { check_limit: LIST_LIMIT, ..BUILT_DIRECTORY }),
    HostKind {
        extensions: &["test"],
        ..kind(&["rostest"], Framework { subject: TestSubject::File, ..UNLISTED_PROGRAM })
    },
    kind(&["cargo"], BUILT_DIRECTORY),
    kind(&["go"], BUILT_DIRECTORY),
    kind(&["tap"], UNLISTED_PROGRAM),
    kind(&["program"], UNLISTED_PROGRAM),
];

/// The arguments of the host are the name of the type.
const fn kind(arguments: &'static [&'static str; 1], framework: Framework) -> HostKind {
    HostKind {
        name: arguments[0],
        extensions: &[],
        prefixes: &[""],
        library_path: None,
        class_prefix: None,
        framework: Some(framework),
        start: start(arguments, None),
    }
}

const fn with_python_sdk(kind: HostKind) -> HostKind {
    match kind.start {
        HostStart::Shipped { arguments, .. } => {
            HostKind { start: start(arguments, Some(&PYTHON_SDK)), ..kind }
        }
        HostStart::Interpreter { .. } => kind,
    }
}

const fn start(arguments: &'static [&'static str], sdk: Option<&'static Sdk>) -> HostStart {
    HostStart::Shipped { program: "rtf-host-framework", arguments, sdk, forks: false }
}

/// Returns the type of this name, ignoring case as for other types.
pub(super) fn by_name(name: &str) -> Option<&'static HostKind> {
    FRAMEWORKS.iter().find(|kind| kind.name.eq_ignore_ascii_case(name))
}
