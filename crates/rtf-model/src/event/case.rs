//! Events about cases: named results inside an attempt of a test.

use serde::{Deserialize, Serialize};

use super::{CaseEpisode, EpisodeEnd};
use crate::{CaseId, Location, TestId, Verdict};

/// A named value: of a matrix, or of a case.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Parameter {
    /// The name.
    pub name: String,
    /// The value as text.
    pub value: String,
}

/// A case of a test starts, as its host announces it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CaseStart {
    /// The case: 1 for the first one of an attempt, and one more for each further one.
    pub case: CaseId,
    /// Its name, unique in its parent.
    pub name: String,
    /// The case that contains it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parent: Option<CaseId>,
    /// Its parameters.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parameters: Vec<Parameter>,
    /// Its tags, as its framework reports them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
    /// Where in the plug-in it starts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub location: Option<Location>,
    /// Number of its attempts before this one. The runner counts them.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub earlier_attempts: u32,
    /// Of an episode of a test with slots: which one. Its parameters are those of the case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub episode: Option<CaseEpisode>,
}

impl CaseStart {
    /// A top-level case of which only the name is known.
    #[must_use]
    pub fn new(case: CaseId, name: String) -> Self {
        Self { case, name, ..Self::default() }
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde requires a reference")]
fn is_zero(number: &u32) -> bool {
    *number == 0
}

/// A case of a running test starts. [`CaseFinished`] is the matching end.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CaseStarted {
    /// The test.
    pub test: TestId,
    /// The case.
    #[serde(flatten)]
    pub start: CaseStart,
}

/// A case has finished. Matches [`CaseStarted`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CaseFinished {
    /// The test.
    pub test: TestId,
    /// The case.
    pub case: CaseId,
    /// The verdict.
    pub verdict: Verdict,
    /// Why it did not pass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The case in it whose problem decided the verdict, or in which the test was stopped
    /// or its process ended.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub decided_by: Option<CaseId>,
    /// Its duration in microseconds, if its framework measured it or it is carried. Otherwise
    /// it is the time since its start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub duration_us: Option<u64>,
    /// It finished in an earlier attempt, which a collapse interrupted.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub carried: bool,
    /// Another attempt of this top-level case follows, which decides.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub rerun: bool,
    /// What its test reported about an episode.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub episode: Option<Box<EpisodeEnd>>,
}
