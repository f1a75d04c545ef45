//! Which keys there are, and the form of their values.

/// The form of a value.
#[derive(Clone, Copy, Debug)]
pub(super) enum Form {
    /// Any text.
    Text,
    /// A text that is not empty.
    Path,
    /// A list of `FORMAT=PATH`.
    Reports,
    /// A duration as in a suite.
    Duration,
    /// A number above 0.
    Scale,
    /// A whole number, not below the first and not above the second.
    Count(u32, u32),
    /// One of these words.
    Words(&'static [&'static str]),
    /// A name of the user's, with a value that is a text, a number or a truth.
    Named(Names),
    /// A table of keys.
    Table(&'static [(&'static str, Form)]),
}

/// Whose names a table has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Names {
    /// Environment variables.
    Variables,
    /// Parameters.
    Parameters,
}

/// The formats of reports.
pub const REPORTS: [&str; 5] = ["junit", "text", "tap", "code-quality", "github"];

/// The keys of a file and of each profile.
pub(super) const KEYS: &[(&str, Form)] = &[
    ("environment", Form::Text),
    ("env", Form::Named(Names::Variables)),
    ("param", Form::Named(Names::Parameters)),
    ("timeouts", Form::Table(TIMEOUTS)),
    ("parallel", Form::Count(1, 1_000_000)),
    ("results", Form::Path),
    ("reports", Form::Reports),
    ("filter", Form::Path),
    ("annotations", Form::Words(&["auto", "github", "gitlab", "none"])),
    ("fork", Form::Words(&["auto", "always", "never"])),
    ("shutdown-timeout", Form::Duration),
    ("jobs", Form::Count(1, u16::MAX as u32)),
    ("lock-timeout", Form::Duration),
    ("retries", Form::Count(0, 1_000_000)),
    ("flaky-result", Form::Words(&["pass", "fail"])),
    ("max-fail", Form::Count(1, u32::MAX)),
];

/// The keys that concern a run as a whole.
pub(super) const OF_RUN: &[&str] = &[
    "results",
    "reports",
    "filter",
    "annotations",
    "fork",
    "shutdown-timeout",
    "jobs",
    "lock-timeout",
    "retries",
    "flaky-result",
    "max-fail",
];

const TIMEOUTS: &[(&str, Form)] = &[
    ("load", Form::Duration),
    ("setup", Form::Duration),
    ("run", Form::Duration),
    ("teardown", Form::Duration),
    ("slow", Form::Duration),
    ("grace", Form::Duration),
    ("fixture-setup", Form::Duration),
    ("fixture-check", Form::Duration),
    ("fixture-teardown", Form::Duration),
    ("hook", Form::Duration),
    ("suite", Form::Duration),
    ("scale", Form::Scale),
];
