//! The monitors of a running test.

use std::sync::Arc;

use rtf_host::Session;
use rtf_model::{
    Finding, FindingSeverity, Measurement, Message, MessageKind, SignalConfig, SignalInterval,
    TestId, format_rounded,
};
use rtf_monitor::{Monitor, Outcome, Verdict, Violation};

use crate::settings::{MonitorSettings, Settings};

/// A monitor that judges a test.
#[derive(Debug)]
pub(crate) struct RunningMonitor {
    settings: Arc<MonitorSettings>,
    monitor: Monitor,
    has_reported: bool,
}

impl RunningMonitor {
    /// The monitors that judge a test.
    pub fn of_test(settings: &Settings, test: &str) -> Vec<Self> {
        let judging = settings.monitors.iter().filter(|monitor| monitor.judges(test));
        judging.filter_map(|settings| Self::new(Arc::clone(settings))).collect()
    }

    /// A monitor that judges the samples from now on.
    pub fn new(settings: Arc<MonitorSettings>) -> Option<Self> {
        // The units of all formulas are converted.
        let monitor = Monitor::new(&settings.formula).ok()?;
        Some(Self { settings, monitor, has_reported: false })
    }

    pub fn settings(&self) -> &MonitorSettings {
        &self.settings
    }

    /// Takes a sample of the signal with this index in the formula; returns a violation once.
    pub fn sample(&mut self, signal: usize, time: f64, value: f64) -> Option<Violation> {
        let violation = self.monitor.sample(signal, time, value)?;
        (!std::mem::replace(&mut self.has_reported, true)).then_some(violation)
    }

    /// Ends the test at this time, and reports its result. The end of a test that was stopped
    /// violates nothing.
    pub fn finish(mut self, end: f64, was_stopped: bool, test: &ReportedTest<'_>) {
        let report = MonitorReport { test, monitor: &self.settings };
        let outcome = self.monitor.finish(end);
        if !self.has_reported && !was_stopped {
            match (&outcome.violation, outcome.verdict) {
                (Some(violation), Verdict::Violated) => report.violation(violation),
                (_, Verdict::NotEnoughData) => report.not_judged(&outcome),
                _ => {}
            }
        }
        if let Some(robustness) = outcome.robustness.filter(|value| value.is_finite()) {
            let is_reported = self.has_reported || !was_stopped;
            // A violation whose robustness is 0 is outside no limit.
            let is_judged = outcome.verdict != Verdict::Violated || is_reported && robustness < 0.0;
            report.robustness(robustness, is_judged);
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct ReportedTest<'a> {
    pub session: &'a Session,
    pub id: TestId,
    pub signals: &'a [SignalConfig],
}

/// Reports the results of a monitor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MonitorReport<'a> {
    pub test: &'a ReportedTest<'a>,
    pub monitor: &'a MonitorSettings,
}

impl MonitorReport<'_> {
    pub fn violation(&self, violation: &Violation) {
        let (start, end) = violation.interval;
        let signals = violation.values.iter().filter_map(|value| self.signal(value.signal));
        let signals = signals.map(|signal| signal.name.clone()).collect();
        let is_finite = start.is_finite() && end.is_finite();
        self.test.session.finding(Finding {
            test: self.test.id,
            severity: self.monitor.severity,
            text: self.describe(violation),
            location: self.monitor.location.clone(),
            interval: is_finite
                .then(|| Box::new(SignalInterval { since: None, start, end, signals })),
        });
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
            self.monitor.name,
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
        if let Some(origin) = &self.monitor.origin {
            text += &format!(" (limit at {origin})");
        }
        text
    }

    fn value(&self, value: &rtf_monitor::SignalValue) -> String {
        let signal = self.signal(value.signal);
        let (name, unit) = signal.map_or(("", ""), |signal| (&signal.name, &signal.unit));
        let measured = Measurement {
            value: Some(value.value).filter(|value| value.is_finite()),
            unit: unit.to_owned(),
            ..Measurement::default()
        };
        format!("{name} = {}", measured.for_display().0)
    }

    /// The signal with this index in the formula.
    fn signal(&self, in_formula: usize) -> Option<&SignalConfig> {
        self.monitor.signals.get(in_formula).map(|index| &self.test.signals[*index])
    }

    fn not_judged(&self, outcome: &Outcome) {
        let name = &self.monitor.name;
        let missing = outcome.missing.iter().filter_map(|index| self.monitor.signals.get(*index));
        let missing: Vec<_> =
            missing.map(|index| format!("`{}`", self.test.signals[*index].name)).collect();
        if !missing.is_empty() {
            let missing = missing.join(", ");
            return self.test.session.finding(Finding {
                test: self.test.id,
                severity: FindingSeverity::Error,
                text: format!("monitor `{name}` was not judged: no sample of {missing}"),
                location: self.monitor.location.clone(),
                interval: None,
            });
        }
        let text = format!("monitor `{name}` was not judged: the test was too short for it");
        let location = self.monitor.location.clone();
        self.test.session.message(Message::new(MessageKind::Report, text, location));
    }

    /// Reports the robustness; it must not be negative, unless the test was not judged.
    fn robustness(&self, robustness: f64, is_judged: bool) {
        self.test.session.report_judged(Measurement {
            name: format!("monitor/{}", self.monitor.name),
            value: Some(robustness),
            low: is_judged.then_some(0.0),
            location: self.monitor.location.clone(),
            ..Measurement::default()
        });
    }
}
