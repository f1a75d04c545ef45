//! The messages between the runner and a fork server.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// The runner's request to a fork server: one more process. Three descriptors
/// come with it: the channel, the standard output, the standard error.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ForkRequest {
    /// The working directory.
    pub working_dir: PathBuf,
    /// Environment variables of this process only.
    pub env: BTreeMap<String, String>,
}

/// The answer of a fork server.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ForkReply {
    /// The id of the new process.
    Pid(i32),
    /// Why there is no new process.
    Error(String),
}
