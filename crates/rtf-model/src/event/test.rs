//! The phases and the result of a test's attempt.

use serde::{Deserialize, Serialize};

use super::ExitStatus;
use crate::{CaseId, TestId, Verdict};

/// A phase of a test, in the order in which they happen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// The host starts and loads the plug-in.
    Load,
    /// The plug-in's `setup`.
    Setup,
    /// The plug-in's `run`.
    Run,
    /// The plug-in's `tearDown`.
    TearDown,
    /// The host exits, after it has answered.
    Exit,
    /// The attempt is judged, and fixtures are notified.
    Notify,
}

impl Phase {
    /// The phase for display: `set-up`.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Load => "load",
            Self::Setup => "set-up",
            Self::Run => "run",
            Self::TearDown => "tear-down",
            Self::Exit => "exit",
            Self::Notify => "notify",
        }
    }
}

impl std::fmt::Display for Phase {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.as_str())
    }
}

/// Why a test was asked to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum StopCause {
    /// A phase reached its limit.
    Timeout,
    /// A fixture collapsed.
    Collapse,
    /// The user interrupted the run.
    Interrupt,
    /// The host violated the protocol.
    Protocol,
    /// A fixture found a problem with which the test must not continue.
    Finding,
}

/// The result of one attempt of a test.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestFinished {
    /// The test.
    pub test: TestId,
    /// The verdict.
    pub verdict: Verdict,
    /// Why it did not pass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The phase that decided the verdict.
    pub phase: Phase,
    /// The case whose problem decided the verdict, or in which the test was stopped or its
    /// process ended.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub decided_by: Option<CaseId>,
    /// How the host's process exited, if it was started and is not shared.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exit: Option<ExitStatus>,
    /// Whether the same repetition will be retried.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub rerun: bool,
}
