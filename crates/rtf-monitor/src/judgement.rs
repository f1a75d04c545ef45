//! What a monitor reports.

use std::ops::Range;

/// Whether a formula holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    Holds,
    Violated,
    NotEnoughData,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalValue {
    /// The index of the signal in [`crate::Formula::signals`].
    pub signal: usize,
    /// The time in seconds, on the clock of the samples.
    pub time: f64,
    /// The value at this time, in the unit of the signal. Between samples it is interpolated. It
    /// is not finite if the sample is not.
    pub value: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    /// The time of the sample, in seconds, after which the formula could not hold any more.
    pub time: f64,
    /// An upper bound of the robustness at this moment: not above 0. It may be `-inf`.
    pub robustness: f64,
    /// When the formula is violated, in seconds: with `always` in front, the times at which its
    /// operand does not hold, as far as that is known at `time`; otherwise the times of the
    /// responsible comparison. The ends may be equal.
    pub interval: (f64, f64),
    /// The part of the formula, in bytes, that is responsible: a comparison or a signal.
    pub responsible: Range<usize>,
    /// The signals of this part and their values at the time where its margin is least.
    pub values: Vec<SignalValue>,
}

/// The judgement of a whole trace.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    pub verdict: Verdict,
    /// How far the signals are from the opposite verdict, in the units of the comparisons: above
    /// 0 if the formula holds, below if it is violated; 0 with either. `None` if it is not
    /// known. May be infinite.
    pub robustness: Option<f64>,
    /// The first violation, as [`crate::Monitor::sample`] or [`crate::Monitor::finish`] found it.
    pub violation: Option<Violation>,
    /// The signals without a sample.
    pub missing: Vec<usize>,
    /// How many samples were ignored because their time was not after that of the previous one of
    /// their signal, or not finite.
    pub ignored: u64,
}
