//! Batches of samples: a test may take thousands of samples per second.

use std::time::{Duration, Instant};

use rtf_model::protocol::Notification;
use rtf_model::{CaseId, Location, Samples};
use rustix::process::{Pid, getpid};

use crate::writer::Writer;

/// A batch of this size is sent.
const BATCH_SAMPLES: usize = 256;

/// A batch whose oldest sample has this age is sent with the next sample.
const BATCH_AGE: Duration = Duration::from_millis(100);

/// A sample of a signal, as a plug-in takes it.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// The signal.
    pub name: &'a str,
    pub value: f64,
    /// Its unit, empty for a pure number.
    pub unit: &'a str,
    /// The smallest accepted value.
    pub low: Option<f64>,
    /// The largest accepted value.
    pub high: Option<f64>,
    /// The time in seconds since the test's set-up began; `None` is the current time.
    pub time: Option<f64>,
    /// The source file, and the line in it.
    pub place: Option<(&'a str, u32)>,
}

/// The samples that are not sent yet.
#[derive(Debug)]
pub(crate) struct Sampling {
    /// The process that took the samples: a child that the plug-in forks inherits them.
    process: Pid,
    /// Start of the test's set-up: times count from then.
    began: Option<Instant>,
    /// The time of the last sample for which the test gave none.
    last: Duration,
    /// One for each signal, in the order of their first samples.
    batches: Vec<Samples>,
    /// The time of the oldest sample.
    oldest: Option<Instant>,
    is_due: bool,
    /// Whether a sample of this test was outside its limits.
    has_failed: bool,
}

impl Default for Sampling {
    fn default() -> Self {
        Self {
            process: getpid(),
            began: None,
            last: Duration::ZERO,
            batches: Vec::new(),
            oldest: None,
            is_due: false,
            has_failed: false,
        }
    }
}

impl Sampling {
    /// Starts the time of a test: its set-up begins.
    pub(crate) fn begin(&mut self) {
        (self.began, self.last, self.has_failed) = (Some(Instant::now()), Duration::ZERO, false);
    }

    /// Adds a sample of a case, and returns whether it is within its limits.
    pub(crate) fn add(&mut self, sample: &Sample<'_>, case: Option<CaseId>) -> bool {
        self.drop_inherited();
        let now = Instant::now();
        let oldest = *self.oldest.get_or_insert(now);
        let time = sample.time.filter(|time| time.is_finite());
        let point = (
            time.unwrap_or_else(|| self.next_time(now)),
            Some(sample.value).filter(|value| value.is_finite()),
        );
        // The last one with that name: other limits need another batch.
        let batch = self.batches.iter_mut().rev().find(|batch| batch.name == sample.name);
        let count = match batch.filter(|batch| batch.case == case && sample.fits(batch)) {
            Some(batch) => {
                batch.points.push(point);
                batch.points.len()
            }
            None => {
                self.batches.push(Samples { case, ..sample.batch(point) });
                1
            }
        };
        let is_full = count >= BATCH_SAMPLES || self.batches.len() >= BATCH_SAMPLES;
        self.is_due |= is_full || now - oldest >= BATCH_AGE;
        let is_within = sample.is_within_limits();
        // The first violation may decide the verdict: a crash must not lose it.
        if !is_within && !self.has_failed {
            (self.is_due, self.has_failed) = (true, true);
        }
        is_within
    }

    /// Seconds since the set-up began, to the nanosecond. They increase with each sample, also if the
    /// clock does not: monitors ignore a sample that is not later than the one before it.
    fn next_time(&mut self, now: Instant) -> f64 {
        let elapsed = self.began.map_or(Duration::ZERO, |began| now - began);
        self.last = elapsed.max(self.last + Duration::from_nanos(1));
        self.last.as_nanos() as f64 / 1e9
    }

    /// Forgets samples of the parent process, which sends them itself.
    fn drop_inherited(&mut self) {
        let process = getpid();
        if process != self.process {
            (self.process, self.oldest, self.is_due) = (process, None, false);
            self.batches.clear();
        }
    }

    /// Sends all batches if one is due.
    pub(crate) fn send_due(&mut self, writer: &Writer) {
        if self.is_due {
            self.send(writer);
        }
    }

    /// Sends all batches if they would become too old during this wait.
    pub(crate) fn send_before(&mut self, wait: Duration, writer: &Writer) {
        if self.oldest.is_some_and(|oldest| oldest.elapsed().saturating_add(wait) >= BATCH_AGE) {
            self.send(writer);
        }
    }

    /// Sends all batches.
    pub(crate) fn send(&mut self, writer: &Writer) {
        if self.batches.is_empty() {
            return;
        }
        self.drop_inherited();
        (self.oldest, self.is_due) = (None, false);
        for batch in self.batches.drain(..) {
            writer.notify(&Notification::Sampled(batch));
        }
    }
}

impl Sample<'_> {
    fn fits(&self, batch: &Samples) -> bool {
        batch.unit == self.unit && (batch.low, batch.high) == (self.low, self.high)
    }

    fn batch(&self, point: (f64, Option<f64>)) -> Samples {
        let location = self.place.map(|(file, line)| Location { file: file.to_owned(), line });
        Samples {
            name: self.name.to_owned(),
            unit: self.unit.to_owned(),
            low: self.low,
            high: self.high,
            location,
            points: vec![point],
            ..Samples::default()
        }
    }

    fn is_within_limits(&self) -> bool {
        self.value.is_finite()
            && self.low.is_none_or(|low| self.value >= low)
            && self.high.is_none_or(|high| self.value <= high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_increase_with_each_sample() {
        let mut sampling = Sampling::default();
        sampling.begin();
        let sample = Sample {
            name: "q",
            value: 1.0,
            unit: "rad",
            low: None,
            high: None,
            time: None,
            place: None,
        };
        for _ in 0..200 {
            assert!(sampling.add(&sample, None));
        }
        let times: Vec<f64> = sampling.batches[0].points.iter().map(|point| point.0).collect();
        assert_eq!(times.len(), 200);
        assert!(times.is_sorted_by(|earlier, later| earlier < later), "{times:?}");
    }
}
