//! What a run was asked to do, so that it can be done again.

use serde::{Deserialize, Serialize};

/// What the user asked for: enough to plan the same tests, in the same order,
/// from the same files. What a field means is said at the command line's
/// option of that name.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Manifest {
    /// The suites, plug-ins and folders, as they were named; relative to the
    /// run's working folder.
    pub inputs: Vec<String>,
    /// Whether folders were descended into.
    #[serde(skip_serializing_if = "is_default")]
    pub recursive: bool,
    /// The parameter string of plug-ins that were named directly.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub param: Option<String>,
    /// The environment string of plug-ins that were named directly.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub environment: Option<String>,
    /// How often plug-ins that were named directly were run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repetition: Option<u32>,
    /// The profile that was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<String>,
    /// The parameters that were set, as `NAME=VALUE`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<String>,
    /// The filters, as they were written.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub filters: Vec<String>,
    /// Of a rerun: the only tests, by the names of their suites and their own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub only: Option<Vec<(String, String)>>,
    /// The number that decided the order.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shuffle: Option<u64>,
    /// The part of the tests that was run: `2/5`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shard: Option<String>,
    /// How often each test was tried again when it failed, whatever its suite says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub retries: Option<u32>,
    /// How many times as often as its suite says each test was run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repeat: Option<u32>,
    /// For how many milliseconds the tests were repeated.
    #[serde(rename = "for", skip_serializing_if = "Option::is_none")]
    pub for_ms: Option<u64>,
    /// Whether a test that passed only when it was tried again counts as failed.
    #[serde(skip_serializing_if = "is_default")]
    pub flaky_fails: bool,
    /// How many suites could run at the same time, when it was more than one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jobs: Option<u32>,
    /// The revision of the sources in the run's working folder, as Git knows it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub revision: Option<Revision>,
    /// How many tests there were of which these were chosen.
    #[serde(skip_serializing_if = "is_default")]
    pub selected_from: u32,
}

/// A revision of sources.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Revision {
    /// The commit's hash, in hexadecimal digits.
    pub commit: String,
    /// The branch, when one was checked out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub branch: Option<String>,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
