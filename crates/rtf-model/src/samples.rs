//! A signal over time: its samples, and its outline for plots.

use serde::{Deserialize, Serialize};

use crate::report::is_within;
use crate::{CaseId, Location, Measurement, Micros, format_rounded};

/// A batch of samples of one signal, in the order in which they were taken, with the
/// limits that each of them must keep. A host sends a signal in batches.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Samples {
    /// The signal.
    pub name: String,
    /// The unit, empty for a pure number.
    #[serde(default)]
    pub unit: String,
    /// The smallest accepted value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub low: Option<f64>,
    /// The largest accepted value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub high: Option<f64>,
    /// Where in the plug-in they were taken.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub location: Option<Location>,
    /// The case in which it was reported.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub case: Option<CaseId>,
    /// The zero of the points' times, from the runner: when the test was announced to the fixture
    /// that took them. Without it, the test took them, and the zero is the start of its set-up.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub since: Option<Micros>,
    /// Each sample: its time in seconds since the zero, and its value; `null` when that is not a
    /// finite number, which no limit accepts.
    pub points: Vec<(f64, Option<f64>)>,
}

impl Samples {
    /// The times and values of the samples that violate the limits.
    pub fn outside(&self) -> impl Iterator<Item = (f64, Option<f64>)> + '_ {
        self.points.iter().copied().filter(|(_, value)| !is_within(*value, self.low, self.high))
    }

    /// Describes the first violation of the limits.
    #[must_use]
    pub fn problem(&self) -> Option<String> {
        let (at, value) = self.outside().next()?;
        let sample = self.single(value);
        let (name, value, at) = (&self.name, sample.value_with_unit(), format_rounded(at));
        Some(match sample.limits() {
            limits if limits.is_empty() => format!("`{name}` is {value} at {at} s"),
            limits => format!("`{name}` is {value} at {at} s, its limits are {limits}"),
        })
    }

    /// One value of the signal as a measurement.
    #[must_use]
    pub fn single(&self, value: Option<f64>) -> Measurement {
        Measurement {
            learned: false,
            name: self.name.clone(),
            value,
            unit: self.unit.clone(),
            low: self.low,
            high: self.high,
            location: self.location.clone(),
            case: self.case,
        }
    }
}

/// The outline of a signal of any length in bounded memory. Of each stretch of
/// samples, it keeps the lowest and the highest, so that no peak is lost. All stretches
/// have the same length; when there are too many, pairs of them are merged.
#[derive(Clone, Debug)]
pub struct SignalOutline {
    stretches: Vec<Stretch>,
    /// Number of samples in a full stretch, and in the last one.
    length: u64,
    filled: u64,
}

/// Time and value of the lowest and the highest sample of a stretch.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    low: (f64, f64),
    high: (f64, f64),
}

impl Default for SignalOutline {
    fn default() -> Self {
        Self { stretches: Vec::new(), length: 1, filled: 0 }
    }
}

impl SignalOutline {
    /// The maximum number of stretches; there are at most twice as many points.
    pub const STRETCHES: usize = 512;

    /// Adds a batch of samples; values that are not finite are left out.
    pub fn extend(&mut self, samples: &Samples) {
        for (at, value) in &samples.points {
            if let Some(value) = value {
                self.push((*at, *value));
            }
        }
    }

    fn push(&mut self, point: (f64, f64)) {
        if self.filled == self.length && self.stretches.len() == Self::STRETCHES {
            self.halve();
        }
        match self.stretches.last_mut() {
            Some(last) if self.filled < self.length => {
                last.merge(Stretch { low: point, high: point });
                self.filled += 1;
            }
            _ => {
                self.stretches.push(Stretch { low: point, high: point });
                self.filled = 1;
            }
        }
    }

    fn halve(&mut self) {
        let pairs = self.stretches.chunks(2).filter_map(|pair| {
            let (first, rest) = pair.split_first()?;
            let mut whole = *first;
            rest.iter().for_each(|other| whole.merge(*other));
            Some(whole)
        });
        self.stretches = pairs.collect();
        self.length *= 2;
        self.filled = self.length;
    }

    /// The points of the outline: times and values, in the order of the samples.
    #[must_use]
    pub fn points(&self) -> Vec<(f64, f64)> {
        let mut points = Vec::with_capacity(2 * self.stretches.len());
        for Stretch { low, high } in &self.stretches {
            let (first, second) = if low.0 <= high.0 { (low, high) } else { (high, low) };
            points.push(*first);
            if first != second {
                points.push(*second);
            }
        }
        points
    }
}

impl Stretch {
    fn merge(&mut self, other: Self) {
        if other.low.1 < self.low.1 {
            self.low = other.low;
        }
        if other.high.1 > self.high.1 {
            self.high = other.high;
        }
    }
}
