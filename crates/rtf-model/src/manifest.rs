//! The options of a run, from which it can be repeated.

use serde::{Deserialize, Serialize};

/// The options of a run: enough to plan the same tests, in the same order,
/// from the same files. Each field is documented at the command-line
/// option of the same name.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Manifest {
    /// The suites, plug-ins and directories, as the user named them; relative to the
    /// run's working directory.
    pub inputs: Vec<String>,
    /// Whether directories were searched recursively.
    #[serde(skip_serializing_if = "is_default")]
    pub recursive: bool,
    /// The parameter string of plug-ins that were named directly.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub param: Option<String>,
    /// The environment string of plug-ins that were named directly.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub environment: Option<String>,
    /// Number of repetitions of plug-ins that were named directly.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repetition: Option<u32>,
    /// The profile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<String>,
    /// The parameters that were set, as `NAME=VALUE`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<String>,
    /// The filters, as they were written.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub filters: Vec<String>,
    /// In a rerun: the selected tests, by suite name and test name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub only: Option<Vec<(String, String)>>,
    /// In a rerun: the selected cases of tests of `only`, by suite name, test name and paths.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub only_cases: Vec<(String, String, Vec<String>)>,
    /// The seed of the random order.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shuffle: Option<u64>,
    /// The order by past results: `failed-first` or `slowest-first`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order: Option<String>,
    /// The shard: `2/5`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shard: Option<String>,
    /// A hash of the assignment of tests to shards, if it depends on past durations: equal in
    /// all shards.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shard_assignment: Option<String>,
    /// Whether a test or a case that skips itself makes the run red.
    #[serde(skip_serializing_if = "is_default")]
    pub no_skips: bool,
    /// Number of retries of each failed test; overrides the suites.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub retries: Option<u32>,
    /// Multiplies the repetitions of each test.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repeat: Option<u32>,
    /// The time for which tests were repeated, in milliseconds.
    #[serde(rename = "for", skip_serializing_if = "Option::is_none")]
    pub for_ms: Option<u64>,
    /// Whether a test that passed only after a retry counts as failed.
    #[serde(skip_serializing_if = "is_default")]
    pub flaky_fails: bool,
    /// Maximum number of suites that ran at the same time, if more than one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jobs: Option<u32>,
    /// The Git revision of the sources in the run's working directory.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub revision: Option<Revision>,
    /// Which run it is, and where it was started.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub origin: Option<Origin>,
    /// The ids of the runs that were merged into this one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<String>,
    /// Number of tests before filters were applied.
    #[serde(skip_serializing_if = "is_default")]
    pub selected_from: u32,
}

/// A revision of sources.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Revision {
    /// The commit hash, in hexadecimal digits.
    pub commit: String,
    /// The branch, if one was checked out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub branch: Option<String>,
    /// The working directory of the run, relative to the root of the repository.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dir: Option<String>,
    /// Whether tracked files differed from the commit, if Git could find out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dirty: Option<bool>,
    /// The author time of the commit, as RFC 3339, if Git could find out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub author_time: Option<String>,
}

/// Which run it is, and where it was started.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Origin {
    /// The identity of the run: a UUID.
    pub id: String,
    /// The name of the machine.
    pub host: String,
    /// The number of CPUs that the runner may use.
    pub cpus: u32,
    /// The load of the machine when the run started: the average number of runnable
    /// threads in the last minute, in percent of its CPUs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load_percent: Option<u32>,
    /// The address of the CI job.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ci_job: Option<String>,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
