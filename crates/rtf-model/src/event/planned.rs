//! The plan of a run: its first events.

use serde::{Deserialize, Serialize};

use super::{ExpectedFailure, LearnedLimits, Parameter};
use crate::{FixtureId, HookId, Manifest, SuiteId, TestId};

/// The first event of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RunStarted {
    /// The version of this event stream, see [`crate::EVENTS_VERSION`].
    pub version: u32,
    /// The run's name, which is also the name of its directory.
    pub run: String,
    /// The version of the runner.
    pub rtf: String,
    /// The time of day, as RFC 3339 with an offset.
    pub started_at: String,
    /// The command line, program first.
    pub command: Vec<String>,
    /// The directory in which the command was run.
    pub working_dir: String,
    /// Number of planned suites.
    pub suites: u32,
    /// Number of planned tests.
    pub tests: u32,
    /// The options of the run.
    #[serde(default)]
    pub manifest: Box<Manifest>,
}

impl RunStarted {
    /// The identity of the run. Journals of old runners and merged runs have no id.
    #[must_use]
    pub fn id(&self) -> String {
        let id = self.manifest.origin.as_ref().map(|origin| origin.id.as_str());
        match id.filter(|id| !id.is_empty()) {
            Some(id) => id.to_owned(),
            None => format!("run:{}", self.run),
        }
    }
}

/// A suite that will be run.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SuitePlanned {
    /// The suite.
    pub suite: SuiteId,
    /// Its name, unique in the run.
    pub name: String,
    /// Its file as the user named it; empty for plug-ins given on the command line.
    #[serde(default)]
    pub file: String,
    /// Its description, with white space folded.
    #[serde(default)]
    pub description: String,
    /// Its environment string (`--robot simulator`).
    #[serde(default)]
    pub environment: String,
    /// Whether a collapse of a fixture leaves the suite green.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub tolerates_collapse: bool,
    /// Whether a test or a case that skips itself makes the run red.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub skips_fail: bool,
    /// Maximum number of its tests that run at the same time.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub parallel: u32,
    /// The names of the exclusive resources that it requires, for example a robot.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub requires: Vec<String>,
}

/// A fixture that will be set up.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FixturePlanned {
    /// The fixture.
    pub fixture: FixtureId,
    /// Its suite.
    pub suite: SuiteId,
    /// Its name, unique in the suite.
    pub name: String,
    /// The plug-in's type (`dll`, `lua`, `python`, `ruby`, `process`).
    pub plugin_type: String,
}

/// A hook, which brings the robot into a safe state.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HookPlanned {
    /// The hook.
    pub hook: HookId,
    /// Its suite.
    pub suite: SuiteId,
    /// Its name, unique in the suite.
    pub name: String,
    /// Its triggers.
    pub on: Vec<Trigger>,
}

/// The trigger of a hook.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Trigger {
    /// A test failed, had an error, or crashed.
    Failure,
    /// A fixture collapsed.
    Collapse,
    /// A test, or the suite, reached its limit.
    Timeout,
    /// The run is interrupted: by a signal, or because the runner died.
    Interrupt,
    /// A fixture will not be started again.
    FixtureBroken,
    /// The suite ends, with any result.
    End,
}

impl Trigger {
    /// Every trigger.
    pub const ALL: [Self; 6] = [
        Self::Failure,
        Self::Collapse,
        Self::Timeout,
        Self::Interrupt,
        Self::FixtureBroken,
        Self::End,
    ];

    /// The word for this trigger, as in a suite.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Failure => "failure",
            Self::Collapse => "collapse",
            Self::Timeout => "timeout",
            Self::Interrupt => "interrupt",
            Self::FixtureBroken => "fixture-broken",
            Self::End => "end",
        }
    }
}

impl std::fmt::Display for Trigger {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.as_str())
    }
}

/// A test that will be run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestPlanned {
    /// The test.
    pub test: TestId,
    /// Its suite.
    pub suite: SuiteId,
    /// Its name, unique in the suite.
    pub name: String,
    /// The plug-in's type (`dll`, `lua`, `python`, `ruby`).
    pub plugin_type: String,
    /// The plug-in's file.
    pub plugin: String,
    /// The hash of the plug-in's file: 64 bits as hexadecimal digits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plugin_hash: Option<String>,
    /// The hash of its sources, as far as they are known: 64 bits as hexadecimal digits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source_hash: Option<String>,
    /// Number of repetitions; when `timed`, in each round.
    pub repetitions: u32,
    /// Whether it is repeated, round by round, for a given time.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub timed: bool,
    /// The tags given in the suite.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
    /// Its values of a matrix.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parameters: Vec<Parameter>,
    /// Its former name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub was: Option<String>,
    /// Limits of measurements that are learned from earlier runs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub learned: Vec<LearnedLimits>,
    /// Its known failure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expected: Option<Box<ExpectedFailure>>,
}

impl TestPlanned {
    /// Whether there is more than one repetition, or may be.
    #[must_use]
    pub fn is_repeated(&self) -> bool {
        self.repetitions > 1 || self.timed
    }
}

fn one() -> u32 {
    1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it with a reference")]
fn is_one(number: &u32) -> bool {
    *number == 1
}
