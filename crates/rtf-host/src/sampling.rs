//! Samples of signals, which are sent in batches: a test may take thousands of
//! them in a second.

use std::time::{Duration, Instant};

use rtf_model::protocol::Notification;
use rtf_model::{Location, Samples};

use crate::writer::Writer;

/// A batch is sent when it has so many samples.
const COUNT: usize = 256;

/// A sample waits no longer for the next ones. Who takes no more and does
/// something else for long is behind by the last batch.
const AGE: Duration = Duration::from_millis(100);

/// A sample of a signal, as a plug-in gives it.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// The signal.
    pub name: &'a str,
    /// The value.
    pub value: f64,
    /// Its unit, empty for a pure number.
    pub unit: &'a str,
    /// The smallest accepted value.
    pub low: Option<f64>,
    /// The largest accepted value.
    pub high: Option<f64>,
    /// When, in seconds since the test's set-up began; now unless told.
    pub time: Option<f64>,
    /// The source file, and the line in it.
    pub place: Option<(&'a str, u32)>,
}

/// The samples that were not sent yet.
#[derive(Debug, Default)]
pub(crate) struct Sampling {
    /// When the test's set-up began: times count from then.
    began: Option<Instant>,
    /// One for each signal, in the order of their first samples.
    batches: Vec<Samples>,
    /// When the oldest sample was taken.
    since: Option<Instant>,
    is_due: bool,
    /// Whether a sample of this test was outside its limits.
    has_failed: bool,
}

impl Sampling {
    /// The set-up of a test begins.
    pub(crate) fn begin(&mut self) {
        (self.began, self.has_failed) = (Some(Instant::now()), false);
    }

    /// Takes a sample; what is wrong with it, in words.
    pub(crate) fn take(&mut self, sample: &Sample<'_>) -> Option<String> {
        let now = Instant::now();
        let since = *self.since.get_or_insert(now);
        let time = sample.time.filter(|time| time.is_finite());
        let point = (
            time.unwrap_or_else(|| self.seconds(now)),
            Some(sample.value).filter(|value| value.is_finite()),
        );
        // The last one of that name: with other limits it is another batch.
        let batch = self.batches.iter_mut().rev().find(|batch| batch.name == sample.name);
        let count = match batch.filter(|batch| sample.fits(batch)) {
            Some(batch) => {
                batch.points.push(point);
                batch.points.len()
            }
            None => {
                self.batches.push(sample.batch(point));
                1
            }
        };
        self.is_due |= count >= COUNT || self.batches.len() >= COUNT || now - since >= AGE;
        // Nearly all hold: only for the others there is something to be written.
        let problem = if sample.holds() { None } else { sample.batch(point).problem() };
        // The first one that does not decides the verdict: it must not get lost.
        if problem.is_some() && !self.has_failed {
            (self.is_due, self.has_failed) = (true, true);
        }
        problem
    }

    /// Microseconds are enough, and shorter to write.
    fn seconds(&self, now: Instant) -> f64 {
        let since = self.began.map_or(Duration::ZERO, |began| now - began);
        since.as_micros() as f64 / 1e6
    }

    /// Sends all of them if it is time to.
    pub(crate) fn send_due(&mut self, writer: &Writer) {
        if self.is_due {
            self.send(writer);
        }
    }

    /// Sends all of them if they would grow too old in this time.
    pub(crate) fn send_before(&mut self, wait: Duration, writer: &Writer) {
        if self.since.is_some_and(|since| since.elapsed().saturating_add(wait) >= AGE) {
            self.send(writer);
        }
    }

    /// Sends all of them.
    pub(crate) fn send(&mut self, writer: &Writer) {
        (self.since, self.is_due) = (None, false);
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
        }
    }

    /// Whether a value keeps the limits.
    fn holds(&self) -> bool {
        self.value.is_finite()
            && self.low.is_none_or(|low| self.value >= low)
            && self.high.is_none_or(|high| self.value <= high)
    }
}
