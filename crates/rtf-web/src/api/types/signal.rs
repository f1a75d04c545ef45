//! A signal that a test sampled.

use rtf_model::{SignalOutline, SignalSummary};
use serde::Serialize;
use utoipa::ToSchema;

/// The signals of an attempt, in the order of their first samples.
#[derive(Debug, Serialize, ToSchema)]
pub struct Signals {
    /// The signals.
    pub series: Vec<Signal>,
}

/// A signal in numbers, and its curve.
#[derive(Debug, Serialize, ToSchema)]
pub struct Signal {
    /// Its name.
    pub name: String,
    /// Its unit, empty for a pure number.
    pub unit: String,
    /// The smallest accepted value, as last reported.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub low: Option<f64>,
    /// The largest accepted value, as last reported.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub high: Option<f64>,
    /// How many samples there are.
    pub count: u64,
    /// The smallest value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// The mean value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean: Option<f64>,
    /// The largest value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
    /// The last value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last: Option<f64>,
    /// How many samples are outside their limits.
    pub outside: u64,
    /// What is wrong with the first of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub problem: Option<String>,
    /// The times of the curve's points, in seconds since the test's set-up began.
    pub times: Vec<f64>,
    /// The values of the curve's points.
    pub values: Vec<f64>,
}

impl Signal {
    /// The view of a signal and of its curve.
    pub fn of(series: SignalSummary, curve: &SignalOutline) -> Self {
        let (times, values) = curve.points().into_iter().unzip();
        let SignalSummary { name, unit, low, high, count, min, mean, max, last, .. } = series;
        let (outside, problem) = (series.outside, series.problem);
        Self { name, unit, low, high, count, min, mean, max, last, outside, problem, times, values }
    }
}
