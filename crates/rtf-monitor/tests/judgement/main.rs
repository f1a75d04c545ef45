//! Judgements: the choices of `spec/monitors.md`, violations, and the algebra.

#![expect(clippy::unwrap_used, reason = "that is where a test ends")]

mod algebra;
mod choices;
mod violations;

use rtf_monitor::{Formula, Monitor, Outcome, Verdict, Violation};

/// The samples of signals in the order in which they arrive.
type Samples<'a> = &'a [(&'a str, f64, f64)];

/// Judges a formula with a monitor.
fn run(text: &str, samples: Samples<'_>, end: f64) -> (Option<Violation>, Outcome) {
    let formula = Formula::parse(text).unwrap();
    let mut monitor = Monitor::new(&formula).unwrap();
    let mut violation = None;
    for (name, time, value) in samples {
        let signal = formula.signals().iter().position(|signal| signal.name == *name);
        // A formula need not use all signals.
        let Some(signal) = signal else { continue };
        if let Some(found) = monitor.sample(signal, *time, *value) {
            assert!(violation.is_none(), "{text}: reported twice");
            violation = Some(found);
        }
    }
    (violation, monitor.finish(end))
}

/// The verdict and the robustness.
fn outcome(text: &str, samples: Samples<'_>, end: f64) -> (Verdict, Option<f64>) {
    let (_, outcome) = run(text, samples, end);
    (outcome.verdict, outcome.robustness)
}
