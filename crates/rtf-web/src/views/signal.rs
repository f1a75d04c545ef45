//! A signal that a test sampled.

use rtf_model::{Samples, SignalOutline, SignalSummary};
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
    /// The zero of times, in microseconds since the run started; without it, the start of the
    /// test's set-up.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub since: Option<u64>,
    /// The times of the curve's points, in seconds since the zero.
    pub times: Vec<f64>,
    /// The values of the curve's points.
    pub values: Vec<f64>,
}

/// The signals of an attempt while its samples are read.
#[derive(Debug, Default)]
pub struct SignalList(Vec<(SignalSummary, SignalOutline)>);

impl SignalList {
    /// Adds samples to the signal of their name; its curve gets those that `shown` returns.
    pub fn add_samples(&mut self, samples: Samples, shown: impl Fn(Samples) -> Samples) {
        match self.0.iter_mut().find(|(signal, _)| signal.name == samples.name) {
            Some((signal, curve)) => {
                signal.extend(&samples);
                curve.extend(&shown(samples));
            }
            None => {
                let (signal, mut curve) = (SignalSummary::new(&samples), SignalOutline::default());
                curve.extend(&shown(samples));
                self.0.push((signal, curve));
            }
        }
    }

    /// The signals, in the order of their first samples.
    pub fn into_signals(self) -> Vec<Signal> {
        self.0.into_iter().map(|(signal, curve)| Signal::of(signal, &curve)).collect()
    }
}

impl Signal {
    /// The view of a signal and of its curve.
    fn of(series: SignalSummary, curve: &SignalOutline) -> Self {
        let (times, values) = curve.points().into_iter().unzip();
        Self {
            name: series.name,
            unit: series.unit,
            low: series.low,
            high: series.high,
            count: series.count,
            min: series.min,
            mean: series.mean,
            max: series.max,
            last: series.last,
            outside: series.outside,
            problem: series.problem,
            since: series.since.map(|since| since.0),
            times,
            values,
        }
    }
}
