//! The private resources of a suite: a network, ports, middleware ids.

use serde::{Deserialize, Serialize};

use crate::SuiteId;

/// The private resources of a suite.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SuitePrepared {
    /// The suite.
    pub suite: SuiteId,
    /// Its private network namespace.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub network: Option<SuiteNetwork>,
    /// Its private ports, sorted by name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ports: Vec<SuitePort>,
    /// Environment variables that select its private middleware.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub variables: Vec<SuiteVariable>,
    /// A shell command with which a user joins the suite while it runs.
    pub join_command: String,
}

/// A network namespace that has only a loopback interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SuiteNetwork {
    /// A process in it that runs as long as the suite: `/proc/<pid>/ns/net`.
    pub pid: i32,
    /// Whether it is part of a user namespace, because the runner is not root.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub user_namespace: bool,
}

/// A TCP port that no other suite uses.
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
    /// Whether the runner inherited it from the user's environment.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub inherited: bool,
}
