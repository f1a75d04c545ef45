//! Limits of measurements that are learned from earlier runs.

use serde::{Deserialize, Serialize};

use crate::Measurement;

/// Limits of a measurement, learned from earlier runs before this one started.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LearnedLimits {
    /// The name of the measurement.
    pub measurement: String,
    /// Its unit.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// The smallest accepted value; without limits, the measurement is not judged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub low: Option<f64>,
    /// The largest accepted value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub high: Option<f64>,
    /// Number of runs from which they are learned.
    pub runs: u32,
}

impl LearnedLimits {
    /// Gives a measurement these limits if they are its own, and it has no others.
    pub fn apply(&self, measurement: &mut Measurement) {
        let is_meant = measurement.case.is_none()
            && measurement.name == self.measurement
            && measurement.unit == self.unit;
        let has_limits = measurement.low.is_some() || measurement.high.is_some();
        if is_meant && !has_limits && (self.low.is_some() || self.high.is_some()) {
            (measurement.low, measurement.high) = (self.low, self.high);
            measurement.learned = true;
        }
    }
}
