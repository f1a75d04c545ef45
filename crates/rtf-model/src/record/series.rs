//! What is known of a signal that an attempt sampled: never its samples.

use crate::{Location, Samples, format_rounded};

/// A signal that an attempt sampled, in numbers. The samples are in the journal.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// The signal.
    pub name: String,
    /// Its unit, empty for a pure number.
    pub unit: String,
    /// The smallest accepted value, as it was last told.
    pub low: Option<f64>,
    /// The largest accepted value, as it was last told.
    pub high: Option<f64>,
    /// Where in the plug-in it was first sampled.
    pub location: Option<Location>,
    /// How many samples there are.
    pub count: u64,
    /// The times of the first and of the last one, in seconds since the test's
    /// set-up began.
    pub span: (f64, f64),
    /// The smallest value that is a finite number, as are the next three.
    pub min: Option<f64>,
    /// The mean value.
    pub mean: Option<f64>,
    /// The largest value.
    pub max: Option<f64>,
    /// The last value.
    pub last: Option<f64>,
    /// How many samples are outside their limits.
    pub outside: u64,
    /// What is wrong with the first of them, in words.
    pub problem: Option<String>,
    /// How many samples are finite numbers.
    finite: u64,
}

impl Series {
    /// A signal of which these are the first samples.
    #[must_use]
    pub fn new(samples: &Samples) -> Self {
        let first = samples.points.first().map_or(0.0, |(at, _)| *at);
        let mut series = Self {
            name: samples.name.clone(),
            unit: String::new(),
            low: None,
            high: None,
            location: samples.location.clone(),
            count: 0,
            span: (first, first),
            min: None,
            mean: None,
            max: None,
            last: None,
            outside: 0,
            problem: None,
            finite: 0,
        };
        series.extend(samples);
        series
    }

    /// Takes in some more samples.
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
            // Neither a sum nor a difference, which values of ±1e308 would overflow.
            let count = self.finite as f64;
            self.mean = Some(mean + (value / count - mean / count));
            self.min = Some(self.min.map_or(value, |min| min.min(value)));
            self.max = Some(self.max.map_or(value, |max| max.max(value)));
            self.last = Some(value);
        }
    }

    /// Takes in samples of any signal.
    pub(super) fn extend_one_of(all: &mut Vec<Self>, samples: &Samples) {
        match all.iter_mut().find(|series| series.name == samples.name) {
            Some(series) => series.extend(samples),
            None => all.push(Self::new(samples)),
        }
    }

    /// The series in numbers, as people read them:
    /// `500 samples in 4.99 s, 0.1 … 0.6 rad, mean 0.31 rad`.
    #[must_use]
    pub fn in_numbers(&self) -> String {
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
