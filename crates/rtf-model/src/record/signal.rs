//! Statistics of a signal that an attempt sampled.

use crate::{Location, Micros, Samples, format_rounded};

/// Statistics of a signal that an attempt sampled. The samples are in the journal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SignalSummary {
    /// The signal.
    pub name: String,
    /// Its unit, empty for a pure number.
    pub unit: String,
    /// The smallest accepted value, as last reported.
    pub low: Option<f64>,
    /// The largest accepted value, as last reported.
    pub high: Option<f64>,
    /// Where in the plug-in it was first sampled.
    pub location: Option<Location>,
    /// Number of samples.
    pub count: u64,
    /// The zero of times, as in [`Samples::since`].
    pub since: Option<Micros>,
    /// The times of the first and the last sample, in seconds since the zero.
    pub span: (f64, f64),
    /// The smallest finite value. The next three are finite, too.
    pub min: Option<f64>,
    /// The mean value.
    pub mean: Option<f64>,
    /// The largest value.
    pub max: Option<f64>,
    /// The last value.
    pub last: Option<f64>,
    /// Number of samples outside the limits.
    pub outside: u64,
    /// Describes the first of them.
    pub problem: Option<String>,
    /// Number of finite samples.
    finite: u64,
}

impl SignalSummary {
    /// Starts with the first samples of a signal.
    #[must_use]
    pub fn new(samples: &Samples) -> Self {
        let first = samples.points.first().map_or(0.0, |(at, _)| *at);
        let mut series = Self {
            name: samples.name.clone(),
            location: samples.location.clone(),
            since: samples.since,
            span: (first, first),
            ..Self::default()
        };
        series.extend(samples);
        series
    }

    /// Adds a batch of samples.
    pub fn extend(&mut self, samples: &Samples) {
        self.unit.clone_from(&samples.unit);
        (self.low, self.high) = (samples.low, samples.high);
        self.count += samples.points.len() as u64;
        self.outside += samples.outside().count() as u64;
        if self.problem.is_none() {
            self.problem = samples.problem();
        }
        for (at, value) in &samples.points {
            self.span.1 = *at;
            let Some(value) = *value else { continue };
            self.finite += 1;
            let mean = self.mean.unwrap_or(value);
            // A sum or a difference of values near ±1e308 would overflow.
            let count = self.finite as f64;
            self.mean = Some(mean + (value / count - mean / count));
            self.min = Some(self.min.map_or(value, |min| min.min(value)));
            self.max = Some(self.max.map_or(value, |max| max.max(value)));
            self.last = Some(value);
        }
    }

    /// Adds a batch to the signal of its name.
    pub(super) fn extend_one_of(all: &mut Vec<Self>, samples: &Samples) {
        match all.iter_mut().find(|series| series.name == samples.name) {
            Some(series) => series.extend(samples),
            None => all.push(Self::new(samples)),
        }
    }

    /// One line of text:
    /// `500 samples in 4.99 s, 0.1 … 0.6 rad, mean 0.31 rad`.
    #[must_use]
    pub fn summary(&self) -> String {
        let seconds = format_rounded(self.span.1 - self.span.0);
        let samples = if self.count == 1 { "sample" } else { "samples" };
        let mut text = format!("{} {samples} in {seconds} s", self.count);
        if let (Some(min), Some(mean), Some(max)) = (self.min, self.mean, self.max) {
            let [min, mean, max] = [min, mean, max].map(format_rounded);
            let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
            text += &format!(", {min} … {max}{unit}, mean {mean}{unit}");
        }
        text
    }
}
