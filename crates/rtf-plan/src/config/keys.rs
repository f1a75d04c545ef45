//! The keys of an `rtf.toml` and the formats of their values.

/// The format of a value.
#[derive(Clone, Copy, Debug)]
pub(super) enum ValueFormat {
    /// Any text.
    Text,
    /// A non-empty text.
    Path,
    /// A list of `FORMAT=PATH`.
    Reports,
    /// A duration as in a suite.
    Duration,
    /// A number above 0.
    Scale,
    /// A whole number from the first to the second bound, inclusive.
    Count(u32, u32),
    /// One of these words.
    Words(&'static [&'static str]),
    /// A table of user-defined names with texts, numbers or booleans as values.
    Named(NameKind),
    /// A table of keys.
    Table(&'static [(&'static str, ValueFormat)]),
}

/// The kind of names in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NameKind {
    /// Environment variables.
    Variables,
    /// Parameters.
    Parameters,
}

/// The report formats.
pub const REPORTS: [&str; 5] = ["junit", "text", "tap", "code-quality", "github"];

/// The keys of a file and of each profile.
pub(super) const KEYS: &[(&str, ValueFormat)] = &[
    ("environment", ValueFormat::Text),
    ("env", ValueFormat::Named(NameKind::Variables)),
    ("param", ValueFormat::Named(NameKind::Parameters)),
    ("timeouts", ValueFormat::Table(TIMEOUTS)),
    ("parallel", ValueFormat::Count(1, 1_000_000)),
    ("results", ValueFormat::Path),
    ("reports", ValueFormat::Reports),
    ("filter", ValueFormat::Path),
    ("annotations", ValueFormat::Words(&["auto", "github", "gitlab", "none"])),
    ("fork", ValueFormat::Words(&["auto", "always", "never"])),
    ("shutdown-timeout", ValueFormat::Duration),
    ("jobs", ValueFormat::Count(1, u16::MAX as u32)),
    ("lock-timeout", ValueFormat::Duration),
    ("retries", ValueFormat::Count(0, 1_000_000)),
    ("flaky-result", ValueFormat::Words(&["pass", "fail"])),
    ("max-fail", ValueFormat::Count(1, u32::MAX)),
];

/// The keys that apply to a whole run.
pub(super) const RUN_KEYS: &[&str] = &[
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

const TIMEOUTS: &[(&str, ValueFormat)] = &[
    ("load", ValueFormat::Duration),
    ("setup", ValueFormat::Duration),
    ("run", ValueFormat::Duration),
    ("teardown", ValueFormat::Duration),
    ("slow", ValueFormat::Duration),
    ("grace", ValueFormat::Duration),
    ("fixture-setup", ValueFormat::Duration),
    ("fixture-check", ValueFormat::Duration),
    ("fixture-teardown", ValueFormat::Duration),
    ("hook", ValueFormat::Duration),
    ("suite", ValueFormat::Duration),
    ("scale", ValueFormat::Scale),
];
