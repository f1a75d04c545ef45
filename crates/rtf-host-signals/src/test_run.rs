//! A running test: its samples, and the monitors that judge it.

use std::sync::Arc;

use rtf_host::Session;
use rtf_model::protocol::{TestAttempt, TestReport};
use rtf_model::{Finding, FindingSeverity, Location, Samples, TestId, TestQuantity};

use crate::batches::Batches;
use crate::judge::{MonitorReport, ReportedTest, RunningMonitor};
use crate::recording::Recording;
use crate::settings::Settings;
use crate::source_time::{Origin, SampleTime, TestStart};

/// The smallest distance of two samples: times are in microseconds.
const RESOLUTION: f64 = 1e-6;

#[derive(Debug)]
pub(crate) struct TestRun {
    pub id: TestId,
    settings: Arc<Settings>,
    session: Session,
    start: TestStart,
    /// Its zero on the clock of each source.
    origins: Vec<Origin>,
    batches: Batches,
    monitors: Vec<RunningMonitor>,
    /// For each signal: the monitors that need it, and its index in their formulas.
    judges: Vec<Vec<(usize, usize)>>,
    /// The time of the last sample of each signal.
    last: Vec<Option<f64>>,
    has_time_error: bool,
    /// How much of each recording was played.
    played: Vec<usize>,
    /// When its set-up began.
    setup: f64,
    has_unit_error: bool,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct SignalSample {
    /// The index of its source.
    pub source: usize,
    /// The index of the signal.
    pub signal: usize,
    pub time: SampleTime,
    pub value: f64,
}

impl TestRun {
    pub fn new(
        test: &TestAttempt,
        start: TestStart,
        origins: Vec<Origin>,
        (settings, session): (&Arc<Settings>, &Session),
    ) -> Self {
        let monitors = RunningMonitor::of_test(settings, &test.name);
        let mut run = Self {
            id: test.id,
            start,
            origins,
            batches: Batches::new(test.id, &settings.signals),
            monitors: Vec::new(),
            judges: vec![Vec::new(); settings.signals.len()],
            last: vec![None; settings.signals.len()],
            has_time_error: false,
            played: vec![0; settings.recordings.len()],
            setup: 0.0,
            has_unit_error: false,
            settings: Arc::clone(settings),
            session: session.clone(),
        };
        monitors.into_iter().for_each(|monitor| run.add(monitor));
        run
    }

    fn add(&mut self, monitor: RunningMonitor) {
        for (in_formula, signal) in monitor.settings().signals.iter().enumerate() {
            self.judges[*signal].push((self.monitors.len(), in_formula));
        }
        self.monitors.push(monitor);
    }

    /// Takes a sample, unless it was taken before the test. A violation is reported first.
    pub fn sample(&mut self, sample: SignalSample) {
        if let Some(time) = self.judge(sample) {
            self.batches.add(sample.signal, time, sample.value, &self.session);
        }
    }

    /// Plays the recordings up to a time.
    pub fn play(&mut self, recordings: &[Recording], now: TestStart) {
        let elapsed = self.elapsed(now);
        let first_source = self.settings.programs.len() + self.settings.processes.len();
        for (index, recording) in recordings.iter().enumerate() {
            while let Some(recorded) = recording.sample(self.played[index], elapsed) {
                self.played[index] += 1;
                let written = Some(recorded.time);
                let time = SampleTime { written, arrival: now.instant };
                let (signal, value) = (recorded.signal, recorded.value);
                let source = first_source + index;
                self.sample(SignalSample { source, signal, time, value });
            }
        }
    }

    /// The time of the next sample of a recording after now, in seconds from now.
    pub fn next_recorded(&self, recordings: &[Recording], now: TestStart) -> Option<f64> {
        let next = recordings.iter().zip(&self.played);
        let next = next.filter_map(|(recording, played)| recording.sample(*played, f64::INFINITY));
        next.map(|sample| sample.time - self.elapsed(now)).reduce(f64::min)
    }

    fn elapsed(&self, now: TestStart) -> f64 {
        now.clock - self.start.clock
    }

    /// Handles what the test itself reports.
    pub fn reported(&mut self, report: TestReport, now: TestStart) {
        match report {
            TestReport::SetupStarted {} => self.setup = self.elapsed(now),
            TestReport::Sampled(samples) => {
                let points = samples.points.iter().map(|(time, value)| (self.setup + time, *value));
                let points: Vec<_> = points.collect();
                self.take(&samples, TestQuantity::Sample, &points);
            }
            TestReport::Measured(measured) => {
                let points = [(self.elapsed(now), measured.value)];
                let samples = Samples {
                    name: measured.name,
                    unit: measured.unit,
                    location: measured.location,
                    ..Samples::default()
                };
                self.take(&samples, TestQuantity::Measurement, &points);
            }
            TestReport::Monitor(declared) => {
                let location = declared.location.clone();
                let is_known = |other: &RunningMonitor| other.settings().name == declared.name;
                let monitor = if self.monitors.iter().any(is_known) {
                    Err(format!("another monitor of this test is named `{}`", declared.name))
                } else {
                    self.settings.monitor(declared)
                };
                match monitor.map(|monitor| RunningMonitor::new(Arc::new(monitor))) {
                    Ok(monitor) => monitor.into_iter().for_each(|monitor| self.add(monitor)),
                    Err(text) => self.report_error(text, location),
                }
            }
        }
    }

    /// Judges what the test reports under the name of a signal; it is part of its results already.
    fn take(&mut self, reported: &Samples, quantity: TestQuantity, points: &[(f64, Option<f64>)]) {
        let settings = Arc::clone(&self.settings);
        let is_meant = |(signal, of): &&(usize, TestQuantity)| {
            *of == quantity && settings.signals[*signal].name == reported.name
        };
        let Some((signal, _)) = settings.of_tests.iter().find(is_meant) else { return };
        let unit = &settings.signals[*signal].unit;
        if reported.unit != *unit {
            if !std::mem::replace(&mut self.has_unit_error, true) {
                let text = format!(
                    "the test reports `{}` in {}, but its unit in the suite is {}",
                    reported.name,
                    quoted_unit(&reported.unit),
                    quoted_unit(unit)
                );
                self.report_error(text, reported.location.clone());
            }
            return;
        }
        let (source, signal) = (settings.test_source(), *signal);
        for (time, value) in points {
            let time = SampleTime { written: Some(*time), arrival: self.start.instant };
            let value = value.unwrap_or(f64::NAN);
            self.judge(SignalSample { source, signal, time, value });
        }
    }

    fn report_error(&self, text: String, location: Option<Location>) {
        let severity = FindingSeverity::Error;
        let finding = Finding { test: self.id, severity, text, location, interval: None };
        self.session.finding(finding);
    }

    /// Passes a sample to the monitors. Returns its time, unless it is ignored.
    fn judge(&mut self, sample: SignalSample) -> Option<f64> {
        let mut time = self.origins[sample.source].time_of(sample.time, self.start);
        if time < 0.0 {
            return None;
        }
        if let Some(last) = self.last[sample.signal].filter(|last| *last >= time) {
            if sample.time.written.is_none() {
                // Lines that arrive together.
                time = last + RESOLUTION;
            } else if last > time {
                self.report_earlier_time(sample.signal, last, time);
                return None;
            } else {
                return None;
            }
        }
        let signals = &self.settings.signals;
        let test = ReportedTest { session: &self.session, id: self.id, signals };
        for (monitor, in_formula) in &self.judges[sample.signal] {
            let monitor = &mut self.monitors[*monitor];
            if let Some(violation) = monitor.sample(*in_formula, time, sample.value) {
                MonitorReport { test: &test, monitor: monitor.settings() }.violation(&violation);
            }
        }
        self.last[sample.signal] = Some(time);
        Some(time)
    }

    /// Reports the first time that is before an earlier one.
    fn report_earlier_time(&mut self, signal: usize, last: f64, time: f64) {
        if std::mem::replace(&mut self.has_time_error, true) {
            return;
        }
        let name = &self.settings.signals[signal].name;
        let text = format!("the time of signal `{name}` went back from {last} s to {time} s");
        self.report_error(text, None);
    }

    /// Its zero on the clock of a source.
    #[cfg(test)]
    pub fn zero_of(&self, source: usize) -> Option<f64> {
        self.origins[source].zero()
    }

    pub fn send(&mut self) {
        self.batches.send(&self.session);
    }

    /// The test's process has ended.
    pub fn finish(mut self, now: TestStart, was_stopped: bool) {
        self.send();
        let last = self.last.iter().flatten().copied().fold(0.0, f64::max);
        let end = (now.clock - self.start.clock).max(last);
        let signals = &self.settings.signals;
        let test = ReportedTest { session: &self.session, id: self.id, signals };
        self.monitors.into_iter().for_each(|monitor| monitor.finish(end, was_stopped, &test));
    }
}

fn quoted_unit(unit: &str) -> String {
    if unit.is_empty() { "no unit".to_owned() } else { format!("`{unit}`") }
}
