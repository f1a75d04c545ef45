//! The monitors of a running test.

use rtf_host::Session;
use rtf_model::{
    Finding, FindingSeverity, Measurement, Message, MessageKind, SignalConfig, TestId,
    format_rounded,
};
use rtf_monitor::{Monitor, Outcome, Verdict, Violation};

use crate::settings::{MonitorSettings, Settings};

/// A monitor that judges a test.
#[derive(Debug)]
pub(crate) struct RunningMonitor {
    /// Its index in the settings.
    index: usize,
    monitor: Monitor,
    has_reported: bool,
}

impl RunningMonitor {
    /// The monitors that judge a test.
    pub fn of_test(settings: &Settings, test: &str) -> Vec<Self> {
        let all = settings.monitors.iter().enumerate();
        let judging = all.filter(|(_, monitor)| monitor.config.judges(test));
        // The units of all formulas are converted.
        let running = judging.filter_map(|(index, settings)| {
            let monitor = Monitor::new(&settings.formula).ok()?;
            Some(Self { index, monitor, has_reported: false })
        });
        running.collect()
    }

    /// The index of the monitor in the settings.
    pub fn index(&self) -> usize {
        self.index
    }

    /// Takes a sample of the signal with this index in the formula; returns a violation once.
    pub fn sample(&mut self, signal: usize, time: f64, value: f64) -> Option<Violation> {
        let violation = self.monitor.sample(signal, time, value)?;
        (!std::mem::replace(&mut self.has_reported, true)).then_some(violation)
    }

    /// Ends the test at this time, and reports its result. The end of a test that was stopped
    /// violates nothing.
    pub fn finish(mut self, end: f64, was_stopped: bool, report: &MonitorReport<'_>) {
        let outcome = self.monitor.finish(end);
        if !self.has_reported && !was_stopped {
            match (&outcome.violation, outcome.verdict) {
                (Some(violation), Verdict::Violated) => report.violation(violation),
                (_, Verdict::NotEnoughData) => report.not_judged(&outcome),
                _ => {}
            }
        }
        // A measurement that is not finite would be a failure.
        if let Some(robustness) = outcome.robustness.filter(|value| value.is_finite()) {
            report.robustness(robustness);
        }
    }
}

/// Reports the results of a monitor.
pub(crate) struct MonitorReport<'a> {
    pub session: &'a Session,
    pub test: TestId,
    pub monitor: &'a MonitorSettings,
    pub signals: &'a [SignalConfig],
}

impl MonitorReport<'_> {
    pub fn violation(&self, violation: &Violation) {
        self.finding(self.monitor.config.severity, self.describe(violation));
    }

    fn finding(&self, severity: FindingSeverity, text: String) {
        let location = Some(self.monitor.config.location.clone());
        self.session.finding(Finding { test: self.test, severity, text, location });
    }

    /// "monitor `no overshoot`: `q <= 1.05` does not hold at 0.42 s: q = 1.08 rad (robustness
    /// -0.03); its formula is `always(q <= 1.05)`".
    fn describe(&self, violation: &Violation) -> String {
        let formula = self.monitor.formula.text();
        let part = formula.get(violation.responsible.clone()).unwrap_or(formula);
        let values: Vec<_> = violation.values.iter().map(|value| self.value(value)).collect();
        let at = violation.values.first().map_or(violation.time, |value| value.time);
        let mut text = format!(
            "monitor `{}`: `{part}` does not hold at {} s",
            self.monitor.config.name,
            format_rounded(at)
        );
        if !values.is_empty() {
            text += &format!(": {}", values.join(", "));
        }
        if violation.robustness.is_finite() {
            text += &format!(" (robustness {})", format_rounded(violation.robustness));
        }
        if part != formula {
            text += &format!("; its formula is `{formula}`");
        }
        if let Some(origin) = &self.monitor.config.origin {
            text += &format!(" (limit at {origin})");
        }
        text
    }

    fn value(&self, value: &rtf_monitor::SignalValue) -> String {
        let signal = self.monitor.signals.get(value.signal).map(|index| &self.signals[*index]);
        let (name, unit) = signal.map_or(("", ""), |signal| (&signal.name, &signal.unit));
        let measured = Measurement {
            name: String::new(),
            value: Some(value.value).filter(|value| value.is_finite()),
            unit: unit.to_owned(),
            low: None,
            high: None,
            learned: false,
            location: None,
            case: None,
        };
        format!("{name} = {}", measured.for_display().0)
    }

    fn not_judged(&self, outcome: &Outcome) {
        let name = &self.monitor.config.name;
        let missing = outcome.missing.iter().filter_map(|index| self.monitor.signals.get(*index));
        let missing: Vec<_> =
            missing.map(|index| format!("`{}`", self.signals[*index].name)).collect();
        if !missing.is_empty() {
            let missing = missing.join(", ");
            let text = format!("monitor `{name}` was not judged: no sample of {missing}");
            return self.finding(FindingSeverity::Error, text);
        }
        let text = format!("monitor `{name}` was not judged: the test was too short for it");
        let location = Some(self.monitor.config.location.clone());
        let (kind, comparison) = (MessageKind::Report, None);
        let message = Message { kind, text, location, comparison, critical: false, case: None };
        self.session.message(message);
    }

    fn robustness(&self, robustness: f64) {
        self.session.measure(Measurement {
            name: format!("monitor/{}", self.monitor.config.name),
            value: Some(robustness),
            unit: String::new(),
            low: None,
            high: None,
            learned: false,
            location: Some(self.monitor.config.location.clone()),
            case: None,
        });
    }
}
