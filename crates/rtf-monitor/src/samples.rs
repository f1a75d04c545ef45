//! The samples of a signal, as a function of time.

use std::collections::VecDeque;

use crate::function::interpolate;

/// The samples of a signal that are kept, and the current one.
#[derive(Clone, Debug)]
pub(crate) struct Samples {
    /// The index of the signal in the formula.
    pub signal: usize,
    /// Times in seconds and values. The first one may be before the start of the trace.
    samples: VecDeque<(f64, f64)>,
    /// The last sample that has been passed.
    current: usize,
}

impl Samples {
    pub(crate) fn new(signal: usize) -> Self {
        Self { signal, samples: VecDeque::new(), current: 0 }
    }

    pub(crate) fn push(&mut self, sample: (f64, f64)) {
        self.samples.push_back(sample);
    }

    pub(crate) fn len(&self) -> usize {
        self.samples.len()
    }

    /// How many samples follow the current one.
    pub(crate) fn waiting(&self) -> usize {
        self.samples.len().saturating_sub(self.current + 1)
    }

    /// The time of the last sample, or `-inf`.
    pub(crate) fn last_time(&self) -> f64 {
        self.samples.back().map_or(f64::NEG_INFINITY, |last| last.0)
    }

    /// The time of the sample after the current one, or `inf`.
    pub(crate) fn next_time(&self) -> f64 {
        self.samples.get(self.current + 1).map_or(f64::INFINITY, |next| next.0)
    }

    /// Makes the last sample that is not after a time the current one.
    pub(crate) fn pass(&mut self, time: f64) {
        while self.next_time() <= time {
            self.current += 1;
        }
    }

    /// Whether the value of the current sample is finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.samples[self.current].1.is_finite()
    }

    /// The value between the current sample and the next one.
    pub(crate) fn value(&self, is_held: bool, time: f64) -> f64 {
        self.between(self.current, is_held, time)
    }

    /// The value at any time that is kept.
    pub(crate) fn past_value(&self, is_held: bool, time: f64) -> f64 {
        let index = self.samples.partition_point(|sample| sample.0 <= time).saturating_sub(1);
        self.between(index, is_held, time)
    }

    /// The value between a sample and the next one. Next to a value that is not finite, it is held.
    fn between(&self, index: usize, is_held: bool, time: f64) -> f64 {
        let start = self.samples[index];
        match self.samples.get(index + 1) {
            Some(end) if !is_held && start.1.is_finite() && end.1.is_finite() => {
                interpolate(start, *end, time)
            }
            _ => start.1,
        }
    }

    /// Forgets what is before a time.
    pub(crate) fn forget(&mut self, time: f64) {
        let count = self.samples.partition_point(|sample| sample.0 <= time);
        let count = count.saturating_sub(1).min(self.current);
        self.samples.drain(..count);
        self.current -= count;
    }
}
