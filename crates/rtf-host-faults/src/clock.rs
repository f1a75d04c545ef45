//! The clock of faults: the simulated time of the suite, or real time, which does not jump.

use std::time::{Duration, Instant};

use rtf_host::SuiteClock;

/// How often a simulated clock is read.
const READ_INTERVAL: Duration = Duration::from_millis(2);

#[derive(Debug)]
pub(crate) struct FaultClock {
    simulated: Option<SuiteClock>,
    origin: Instant,
}

impl FaultClock {
    pub fn new(is_simulated: bool) -> Self {
        let simulated = is_simulated.then(|| SuiteClock::new(true));
        Self { simulated, origin: Instant::now() }
    }

    /// Its time in seconds; `None` while a simulated clock is being written.
    pub fn now(&self) -> Option<f64> {
        match &self.simulated {
            Some(clock) => clock.now(),
            None => Some(self.origin.elapsed().as_secs_f64()),
        }
    }

    /// How long to wait until its time may have advanced so far.
    pub fn wait_for(&self, seconds: f64) -> Duration {
        match &self.simulated {
            Some(_) => READ_INTERVAL,
            None => Duration::try_from_secs_f64(seconds.max(0.0)).unwrap_or(Duration::MAX),
        }
    }
}
