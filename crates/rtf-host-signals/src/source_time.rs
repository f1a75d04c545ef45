//! Converts the times of a source to those of a test.

use std::time::Instant;

use rtf_model::SignalTime;

/// The time of a sample as its source reports it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SampleTime {
    /// As written; `None` if lines have no time.
    pub written: Option<f64>,
    pub arrival: Instant,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct TestStart {
    pub instant: Instant,
    /// The time of the suite's clock.
    pub clock: f64,
}

/// The zero of a test on the clock of a source.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Origin(Option<f64>);

impl Origin {
    /// The origin, if it is known when the test starts. `last` is the last sample before.
    pub fn at_start(time: SignalTime, start: TestStart, last: Option<SampleTime>) -> Self {
        Self(match time {
            SignalTime::Clock => Some(start.clock),
            SignalTime::Arrival => Some(0.0),
            SignalTime::Own => last.and_then(|last| {
                let elapsed = start.instant.saturating_duration_since(last.arrival);
                Some(last.written? + elapsed.as_secs_f64())
            }),
        })
    }

    #[cfg(test)]
    pub fn zero(self) -> Option<f64> {
        self.0
    }

    /// The time of a sample in the test, in seconds, to the microsecond. Negative before its
    /// start.
    pub fn time_of(&mut self, sample: SampleTime, start: TestStart) -> f64 {
        let since_start = match sample.arrival.checked_duration_since(start.instant) {
            Some(after) => after.as_secs_f64(),
            None => -start.instant.duration_since(sample.arrival).as_secs_f64(),
        };
        let seconds = match sample.written {
            None => since_start,
            Some(written) => written - *self.0.get_or_insert(written - since_start),
        };
        (seconds * 1e6).round() / 1e6
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn times_are_relative_to_the_start_of_the_test() {
        let zero = Instant::now();
        let at = |ms| zero + Duration::from_millis(ms);
        let start = TestStart { instant: at(1000), clock: 500.0 };
        let sample = |written, ms| SampleTime { written, arrival: at(ms) };
        let last = Some(sample(Some(7.0), 900));
        for (time, written, expected) in [
            (SignalTime::Clock, Some(500.25), 0.25),
            (SignalTime::Clock, Some(499.0), -1.0),
            (SignalTime::Arrival, None, 0.25),
            (SignalTime::Own, Some(7.35), 0.25),
        ] {
            let mut origin = Origin::at_start(time, start, last);
            assert_eq!(origin.time_of(sample(written, 1250), start), expected, "{time:?}");
        }
        // Without an earlier sample, the first one in the test determines the origin.
        let mut origin = Origin::at_start(SignalTime::Own, start, None);
        assert_eq!(origin.time_of(sample(Some(3.0), 1100), start), 0.1);
        assert_eq!(origin.time_of(sample(Some(3.5), 1900), start), 0.6);
    }
}
