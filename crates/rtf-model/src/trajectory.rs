//! A check that a signal of a test follows a stored trajectory.

use serde::{Deserialize, Serialize};

use crate::{CaseId, Location};

/// A check that a signal, as the test has sampled it so far, follows a stored trajectory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrajectoryCheck {
    /// The signal.
    pub name: String,
    /// The file of the stored trajectory, relative to the working directory.
    pub reference: String,
    /// The largest accepted difference, in the unit of the signal.
    pub tolerance: f64,
    /// How times are aligned.
    #[serde(default)]
    pub align: Alignment,
    /// With dynamic time warping, by how many seconds times may differ; a tenth of the reference
    /// if it is missing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub band: Option<f64>,
    /// Where in the plug-in the check is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub location: Option<Location>,
    /// The case in which it was made.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub case: Option<CaseId>,
}

/// How the times of two trajectories are aligned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Alignment {
    /// Both start at their first sample.
    #[default]
    Time,
    /// By dynamic time warping.
    Dtw,
}

impl Alignment {
    /// Every alignment, with its word in the SDKs.
    pub const ALL: [(&'static str, Self); 2] = [("time", Self::Time), ("dtw", Self::Dtw)];
}
