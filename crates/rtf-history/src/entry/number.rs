//! Summaries of measurements and signals: what a run contributes to a series.

use std::collections::BTreeMap;

use rtf_model::{Measurement, SignalSummary};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::statistics::robust::median;

/// Where the numbers of a series come from.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, ToSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum NumberKind {
    /// Measurements.
    Measurement,
    /// The samples of a signal.
    Signal,
}

impl NumberKind {
    /// The word, as in the store and in JSON.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Measurement => "measurement",
            Self::Signal => "signal",
        }
    }
}

/// The name of a series of a test.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, ToSchema)]
pub struct SeriesName {
    /// Measurement or signal.
    pub kind: NumberKind,
    /// The name.
    pub name: String,
    /// The unit; a number in another unit belongs to another series.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub unit: String,
}

/// All numbers of a run in one series. Statistics are those of finite numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NumberSummary {
    /// The median; of a signal, the mean. `None` if no number is finite.
    pub value: Option<f64>,
    /// The smallest.
    pub min: Option<f64>,
    /// The largest.
    pub max: Option<f64>,
    /// How many numbers there are, finite or not.
    pub count: u64,
    /// How many of them are not finite.
    pub not_finite: u64,
    /// How many of them violate their limits.
    pub outside: u64,
    /// The smallest accepted value, as last reported.
    pub low: Option<f64>,
    /// The largest accepted value, as last reported.
    pub high: Option<f64>,
}

/// Collects the numbers of a test in a run.
#[derive(Debug, Default)]
pub(super) struct NumberCollector {
    measured: BTreeMap<SeriesName, (Vec<f64>, NumberSummary)>,
    sampled: BTreeMap<SeriesName, NumberSummary>,
}

impl NumberCollector {
    pub fn add_measurement(&mut self, measurement: &Measurement) {
        let (name, unit) = (measurement.name.clone(), measurement.unit.clone());
        let series = SeriesName { kind: NumberKind::Measurement, name, unit };
        let (values, summary) = self.measured.entry(series).or_default();
        let finite = measurement.value.filter(|value| value.is_finite());
        values.extend(finite);
        summary.count += 1;
        summary.not_finite += u64::from(finite.is_none());
        summary.outside += u64::from(!measurement.is_within_limits());
        (summary.low, summary.high) = (measurement.low, measurement.high);
    }

    pub fn add_signal(&mut self, signal: &SignalSummary) {
        let (name, unit) = (signal.name.clone(), signal.unit.clone());
        let series = SeriesName { kind: NumberKind::Signal, name, unit };
        let summary = self.sampled.entry(series).or_default();
        let (before, added) = (summary.count as f64, signal.count as f64);
        summary.value = match (summary.value, signal.mean) {
            (Some(known), Some(mean)) => {
                Some(known * (before / (before + added)) + mean * (added / (before + added)))
            }
            (known, mean) => mean.or(known),
        };
        summary.min = [summary.min, signal.min].into_iter().flatten().min_by(f64::total_cmp);
        summary.max = [summary.max, signal.max].into_iter().flatten().max_by(f64::total_cmp);
        summary.count += signal.count;
        summary.outside += signal.outside;
        (summary.low, summary.high) = (signal.low, signal.high);
    }

    pub fn finish(self) -> Vec<(SeriesName, NumberSummary)> {
        let measured = self.measured.into_iter().map(|(series, (values, mut summary))| {
            summary.min = values.iter().copied().min_by(f64::total_cmp);
            summary.max = values.iter().copied().max_by(f64::total_cmp);
            summary.value = median(&values);
            (series, summary)
        });
        measured.chain(self.sampled).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(name: &str, value: Option<f64>, unit: &str) -> Measurement {
        let (name, unit) = (name.to_owned(), unit.to_owned());
        Measurement {
            learned: false,
            name,
            value,
            unit,
            low: None,
            high: Some(2.0),
            location: None,
            case: None,
        }
    }

    #[test]
    fn the_median_of_what_is_finite() {
        let mut numbers = NumberCollector::default();
        for value in [Some(3.0), Some(1.0), None, Some(f64::NAN), Some(1.5), Some(2.0)] {
            numbers.add_measurement(&measured("lag", value, "ms"));
        }
        let all = numbers.finish();
        let [(series, summary)] = all.as_slice() else { panic!("{all:?}") };
        assert_eq!((series.name.as_str(), series.unit.as_str()), ("lag", "ms"));
        assert_eq!((summary.value, summary.min, summary.max), (Some(1.75), Some(1.0), Some(3.0)));
        assert_eq!((summary.count, summary.not_finite, summary.outside), (6, 2, 3));
        assert_eq!((summary.low, summary.high), (None, Some(2.0)));
    }

    #[test]
    fn another_unit_is_another_series() {
        let mut numbers = NumberCollector::default();
        numbers.add_measurement(&measured("lag", Some(1.0), "ms"));
        numbers.add_measurement(&measured("lag", Some(0.001), "s"));
        assert_eq!(numbers.finish().len(), 2);
    }

    #[test]
    fn nothing_finite_is_no_value() {
        let mut numbers = NumberCollector::default();
        numbers.add_measurement(&measured("lag", None, ""));
        let (_, summary) = &numbers.finish()[0];
        assert_eq!((summary.value, summary.min, summary.count), (None, None, 1));
    }
}
