//! The samples of a test that are not sent yet: one message for many samples.

use rtf_host::Session;
use rtf_model::{Samples, SignalConfig, TestId};

/// A signal with so many samples is sent.
const BATCH_SAMPLES: usize = 256;

/// The samples of a test that are not sent yet.
#[derive(Debug)]
pub(crate) struct Batches {
    test: TestId,
    signals: Vec<Samples>,
}

impl Batches {
    pub fn new(test: TestId, signals: &[SignalConfig]) -> Self {
        let batch = |signal: &SignalConfig| Samples {
            name: signal.name.clone(),
            unit: signal.unit.clone(),
            ..Samples::default()
        };
        Self { test, signals: signals.iter().map(batch).collect() }
    }

    pub fn add(&mut self, signal: usize, time: f64, value: f64, session: &Session) {
        let batch = &mut self.signals[signal];
        batch.points.push((time, Some(value).filter(|value| value.is_finite())));
        if batch.points.len() >= BATCH_SAMPLES {
            Self::send_one(self.test, batch, session);
        }
    }

    /// Sends all samples.
    pub fn send(&mut self, session: &Session) {
        for batch in self.signals.iter_mut().filter(|batch| !batch.points.is_empty()) {
            Self::send_one(self.test, batch, session);
        }
    }

    fn send_one(test: TestId, batch: &mut Samples, session: &Session) {
        let points = std::mem::take(&mut batch.points);
        session.observed(test, Samples { points, ..batch.clone() });
    }
}
