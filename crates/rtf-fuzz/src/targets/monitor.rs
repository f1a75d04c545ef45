//! Formulas over signals. A zero byte separates the formula from samples of three bytes: the signal,
//! the time since the previous sample in steps of 10 ms, and the value.

use rtf_monitor::{Formula, Monitor, Outcome, judge};

/// Robustness this close to 0 may have either verdict.
const NEAR_ZERO: f64 = 1e-9;

/// The signals of a formula lie in its text; a monitor reports a violation once, and its
/// verdict is that of the whole trace.
pub fn check(data: &[u8]) {
    let end = data.iter().position(|byte| *byte == 0).unwrap_or(data.len());
    let Ok(text) = std::str::from_utf8(&data[..end]) else { return };
    let Ok(formula) = Formula::parse(text) else { return };
    for signal in formula.signals() {
        assert!(text.get(signal.range.clone()).is_some(), "{signal:?} in {text:?}");
    }
    let formula = formula.check_units(&|_| None).unwrap_or(formula);
    let Ok(mut monitor) = Monitor::new(&formula) else { return };
    let mut traces = vec![Vec::new(); formula.signals().len()];
    let (mut time, mut violations) = (0.0, 0);
    for sample in data.get(end + 1..).unwrap_or_default().as_chunks::<3>().0 {
        let [signal, step, value] = *sample;
        let Some(signal) = usize::from(signal).checked_rem(traces.len()) else { break };
        time += f64::from(step) * 0.01;
        let value = f64::from(value.cast_signed()) / 8.0;
        traces[signal].push((time, value));
        if let Some(violation) = monitor.sample(signal, time, value) {
            violations += 1;
            assert!(violation.robustness <= 0.0, "{text}: {violation:?}");
            assert!(violation.interval.0 <= violation.interval.1, "{text}: {violation:?}");
            assert!(text.get(violation.responsible.clone()).is_some(), "{text}: {violation:?}");
        }
    }
    assert!(violations <= 1, "{text}: {violations} violations");
    let online = monitor.finish(time);
    let whole = judge(&formula, &traces, time).expect("the units are those of the monitor");
    assert!(!online.robustness.is_some_and(f64::is_nan), "{text}: {online:?}");
    assert!(
        is_near_zero(&online) || online.verdict == whole.verdict,
        "{text}: {online:?} {whole:?}"
    );
}

fn is_near_zero(outcome: &Outcome) -> bool {
    outcome.robustness.is_some_and(|robustness| robustness.abs() < NEAR_ZERO)
}
