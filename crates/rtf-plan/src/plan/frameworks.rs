//! The catalogue of other test frameworks, whose tests `rtf-host-framework` runs
//! (`spec/frameworks.md`).

use std::time::Duration;

use super::framework_kind::{CaseLimits, Forks, Framework, TestSubject};
use super::host_kind::{HostKind, SHIPPED};
use super::sdk::PYTHON_SDK;

/// The limit of a check that starts the program, or imports the user's modules.
const LIST_LIMIT: Option<Duration> = Some(Duration::from_secs(2 * 60));
/// The limit of a check that compiles or starts a virtual machine.
const COMPILE_LIMIT: Option<Duration> = Some(Duration::from_secs(10 * 60));

const LISTED_PROGRAM: Framework = Framework {
    subject: TestSubject::Program,
    lists_cases: true,
    lists_before_run: true,
    limits: CaseLimits::All,
    forks: Forks::Never,
    check_limit: LIST_LIMIT,
};
const FORKED_PROGRAM: Framework = Framework { forks: Forks::IfSeparate, ..LISTED_PROGRAM };
const UNLISTED_PROGRAM: Framework =
    Framework { lists_cases: false, check_limit: None, ..LISTED_PROGRAM };
const UNLIMITED_CASES: Framework = Framework { limits: CaseLimits::None, ..UNLISTED_PROGRAM };
const TAP: Framework = Framework { limits: CaseLimits::AnnouncedSubtests, ..UNLISTED_PROGRAM };
const PYTHON_TESTS: Framework =
    Framework { subject: TestSubject::FileOrDirectory, lists_before_run: false, ..LISTED_PROGRAM };
const BUILT_DIRECTORY: Framework =
    Framework { subject: TestSubject::Directory, check_limit: COMPILE_LIMIT, ..LISTED_PROGRAM };

pub(super) static FRAMEWORKS: [HostKind; 16] = [
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
    HostKind { sdk: Some(&PYTHON_SDK), ..kind(&["pytest"], PYTHON_TESTS) },
    HostKind { sdk: Some(&PYTHON_SDK), ..kind(&["unittest"], PYTHON_TESTS) },
    HostKind {
        sdk: Some(&PYTHON_SDK),
        ..kind(&["launch_testing"], Framework { subject: TestSubject::File, ..PYTHON_TESTS })
    },
    kind(&["ctest"], Framework { check_limit: LIST_LIMIT, ..BUILT_DIRECTORY }),
    HostKind {
        extensions: &["test"],
        ..kind(&["rostest"], Framework { subject: TestSubject::File, ..UNLIMITED_CASES })
    },
    kind(&["cargo"], BUILT_DIRECTORY),
    kind(&["go"], BUILT_DIRECTORY),
    kind(&["tap"], TAP),
    kind(&["program"], UNLIMITED_CASES),
];

/// The arguments of the host are the name of the type.
const fn kind(arguments: &'static [&'static str; 1], framework: Framework) -> HostKind {
    HostKind {
        name: arguments[0],
        framework: Some(framework),
        program: "rtf-host-framework",
        arguments,
        ..SHIPPED
    }
}

/// Returns the type of this name, ignoring case as for other types.
pub(super) fn by_name(name: &str) -> Option<&'static HostKind> {
    FRAMEWORKS.iter().find(|kind| kind.name.eq_ignore_ascii_case(name))
}
