//! The keys of an `rtf.toml` and the formats of their values.

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
    Boolean,
    /// One of these words.
    Words(&'static [&'static str]),
    /// A table of user-defined names with texts, numbers or booleans as values.
    Named(NameKind),
    Table(&'static [Key]),
}

/// A key, the format of its value, and a summary for editors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Key {
    /// Its name in its table.
    pub name: &'static str,
    pub format: ValueFormat,
    /// What it does, in one line of `schemas/config.json`.
    pub summary: &'static str,
}

const fn key(name: &'static str, format: ValueFormat, summary: &'static str) -> Key {
    Key { name, format, summary }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NameKind {
    /// Environment variables.
    Variables,
    Parameters,
}

/// The report formats.
pub const REPORTS: [&str; 8] =
    ["junit", "text", "tap", "code-quality", "github", "markdown", "html", "otlp"];

/// The keys of a file and of each profile.
pub(super) const KEYS: &[Key] = &[
    key("environment", ValueFormat::Text, "Environment string of the suites"),
    key(
        "env",
        ValueFormat::Named(NameKind::Variables),
        "Environment variables of all processes of a suite",
    ),
    key(
        "param",
        ValueFormat::Named(NameKind::Parameters),
        "Parameters: ${param:NAME} in suites, RTF_PARAM_NAME in tests",
    ),
    key("timeouts", ValueFormat::Table(TIMEOUTS), "Limits of tests, fixtures, hooks and suites"),
    key(
        "parallel",
        ValueFormat::Count(1, 1_000_000),
        "Upper bound for the number of tests of a suite that run at the same time",
    ),
    key("results", ValueFormat::Path, "Results directory, as --results"),
    key("reports", ValueFormat::Reports, "Reports to write, as --report"),
    key("filter", ValueFormat::Path, "Run only tests that match this filter, as --filter"),
    key(
        "annotations",
        ValueFormat::Words(&["auto", "github", "gitlab", "none"]),
        "Code host for which annotations are printed, as --annotations",
    ),
    key(
        "fork",
        ValueFormat::Words(&["auto", "always", "never"]),
        "Fork the hosts of tests from a warm host, as --fork",
    ),
    key(
        "shutdown-timeout",
        ValueFormat::Duration,
        "Limit for all tear-downs and hooks after a signal, as --shutdown-timeout",
    ),
    key(
        "jobs",
        ValueFormat::Count(1, u16::MAX as u32),
        "Number of suites that run in parallel, as --jobs",
    ),
    key(
        "lock-timeout",
        ValueFormat::Duration,
        "How long a suite waits for its locks, as --lock-timeout",
    ),
    key(
        "retries",
        ValueFormat::Count(0, 1_000_000),
        "Number of retries of a failed test, as --retries",
    ),
    key(
        "flaky-result",
        ValueFormat::Words(&["pass", "fail"]),
        "Result of a test that passes only on a retry, as --flaky-result",
    ),
    key(
        "max-fail",
        ValueFormat::Count(1, u32::MAX),
        "Skip the remaining tests after this number of failed tests, as --max-fail",
    ),
    key(
        "order",
        ValueFormat::Words(&["file", "failed-first", "slowest-first"]),
        "Order of tests by their past results, as --order",
    ),
    key("history", ValueFormat::Table(HISTORY), "The history: results of many runs"),
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
    "order",
    "history.enabled",
    "history.url",
];

const HISTORY: &[Key] = &[
    key("enabled", ValueFormat::Boolean, "Whether runs are imported when they end"),
    key("url", ValueFormat::Path, "The database, by default history.db in the results directory"),
];

const TIMEOUTS: &[Key] = &[
    key("load", ValueFormat::Duration, "Limit for loading a plug-in"),
    key("setup", ValueFormat::Duration, "Limit for the set-up of a test"),
    key("run", ValueFormat::Duration, "Limit for a test"),
    key("teardown", ValueFormat::Duration, "Limit for the tear-down of a test"),
    key("slow", ValueFormat::Duration, "Time after which a test is reported as slow"),
    key("grace", ValueFormat::Duration, "Time between the request to stop and the kill"),
    key("fixture-setup", ValueFormat::Duration, "Limit for the set-up of a fixture"),
    key("fixture-check", ValueFormat::Duration, "Limit for the check of a fixture"),
    key("fixture-teardown", ValueFormat::Duration, "Limit for the tear-down of a fixture"),
    key("hook", ValueFormat::Duration, "Limit for a hook"),
    key("suite", ValueFormat::Duration, "Limit for a suite"),
    key("scale", ValueFormat::Scale, "Factor for all limits except grace and those of probes"),
];
