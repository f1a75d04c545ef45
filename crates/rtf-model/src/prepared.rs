//! What a suite got for itself when it started: a network, ports, ids.

use serde::{Deserialize, Serialize};

use crate::SuiteId;

/// What a suite got for itself.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SuitePrepared {
    /// The suite.
    pub suite: SuiteId,
    /// Its own network namespace.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub network: Option<SuiteNetwork>,
    /// Its own ports, in the order of their names.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ports: Vec<SuitePort>,
    /// Environment variables that name its own middleware.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub variables: Vec<SuiteVariable>,
    /// A command for a shell, with which a person joins in while the suite runs.
    pub join_command: String,
}

/// A network namespace with nothing but a loopback interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SuiteNetwork {
    /// A process in it that lives as long as the suite: `/proc/<pid>/ns/net`.
    pub pid: i32,
    /// Whether it came with a user namespace, because the runner is not root.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub user_namespace: bool,
}

/// A TCP port that no other suite has.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SuitePort {
    /// Its name in the suite: `${port:name}`.
    pub name: String,
    /// Its number.
    pub port: u16,
}

impl SuitePort {
    /// The environment variable that holds the port of this name.
    #[must_use]
    pub fn variable(name: &str) -> String {
        format!("RTF_PORT_{}", name.to_ascii_uppercase().replace('-', "_"))
    }
}

/// An environment variable of a suite's processes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SuiteVariable {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: String,
    /// Whether it is the user's: it was set before, and was kept.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub inherited: bool,
}
