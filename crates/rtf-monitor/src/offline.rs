//! Judges complete traces: the reference for the monitor.

use crate::formula::Formula;
use crate::judgement::Outcome;
use crate::monitor::{Monitor, MonitorError};

/// Judges a formula on complete traces, with all samples in memory. `traces` has the samples of
/// each signal of the formula, as times in seconds and values; `end` is the end of the trace, or
/// the last sample if that is later.
///
/// The outcome is that of a [`Monitor`] with the same samples, in any order of the signals.
///
/// # Errors
/// A constant has a unit that is not converted.
pub fn judge(
    formula: &Formula,
    traces: &[Vec<(f64, f64)>],
    end: f64,
) -> Result<Outcome, MonitorError> {
    let mut monitor = Monitor::whole(formula)?;
    let mut samples: Vec<_> = traces
        .iter()
        .enumerate()
        .flat_map(|(signal, samples)| samples.iter().map(move |sample| (signal, *sample)))
        .collect();
    samples.sort_by(|left, right| left.1.0.total_cmp(&right.1.0));
    for (signal, (time, value)) in samples {
        monitor.record(signal, time, value);
    }
    Ok(monitor.finish(end))
}
