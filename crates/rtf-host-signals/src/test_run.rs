//! A running test: its samples, and the monitors that judge it.

use rtf_host::Session;
use rtf_model::protocol::TestAttempt;
use rtf_model::{Finding, FindingSeverity, TestId};

use crate::batches::Batches;
use crate::judge::{MonitorReport, RunningMonitor};
use crate::settings::Settings;
use crate::source_time::{Origin, SampleTime, TestStart};

/// The smallest distance of two samples: times are in microseconds.
const RESOLUTION: f64 = 1e-6;

/// A running test.
#[derive(Debug)]
pub(crate) struct TestRun {
    pub id: TestId,
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
}

/// A sample of a signal.
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
        settings: &Settings,
    ) -> Self {
        let monitors = RunningMonitor::of_test(settings, &test.name);
        let mut judges = vec![Vec::new(); settings.signals.len()];
        for (index, monitor) in monitors.iter().enumerate() {
            for (in_formula, signal) in
                settings.monitors[monitor.index()].signals.iter().enumerate()
            {
                judges[*signal].push((index, in_formula));
            }
        }
        Self {
            id: test.id,
            start,
            origins,
            batches: Batches::new(test.id, &settings.signals),
            monitors,
            judges,
            last: vec![None; settings.signals.len()],
            has_time_error: false,
        }
    }

    /// Takes a sample, unless it was taken before the test. A violation is reported first.
    pub fn sample(&mut self, sample: SignalSample, settings: &Settings, session: &Session) {
        let mut time = self.origins[sample.source].time_of(sample.time, self.start);
        if time < 0.0 {
            return;
        }
        if let Some(last) = self.last[sample.signal].filter(|last| *last >= time) {
            if sample.time.written.is_none() {
                // Lines that arrive together.
                time = last + RESOLUTION;
            } else if last > time {
                return self.report_earlier_time((sample.signal, last, time), settings, session);
            } else {
                return;
            }
        }
        for (monitor, in_formula) in &self.judges[sample.signal] {
            let monitor = &mut self.monitors[*monitor];
            if let Some(violation) = monitor.sample(*in_formula, time, sample.value) {
                let monitor = &settings.monitors[monitor.index()];
                let signals = &settings.signals;
                MonitorReport { session, test: self.id, monitor, signals }.violation(&violation);
            }
        }
        self.last[sample.signal] = Some(time);
        self.batches.add(sample.signal, time, sample.value, session);
    }

    /// Reports the first time that is before an earlier one.
    fn report_earlier_time(
        &mut self,
        (signal, last, time): (usize, f64, f64),
        settings: &Settings,
        session: &Session,
    ) {
        if std::mem::replace(&mut self.has_time_error, true) {
            return;
        }
        let name = &settings.signals[signal].name;
        let text = format!("the time of signal `{name}` went back from {last} s to {time} s");
        let (severity, location) = (FindingSeverity::Error, None);
        session.finding(Finding { test: self.id, severity, text, location });
    }

    /// Its zero on the clock of a source.
    #[cfg(test)]
    pub fn zero_of(&self, source: usize) -> Option<f64> {
        self.origins[source].zero()
    }

    /// Sends the samples that were taken.
    pub fn send(&mut self, session: &Session) {
        self.batches.send(session);
    }

    /// The test's process has ended.
    pub fn finish(
        mut self,
        (now, was_stopped): (TestStart, bool),
        settings: &Settings,
        session: &Session,
    ) {
        self.send(session);
        let last = self.last.iter().flatten().copied().fold(0.0, f64::max);
        let end = (now.clock - self.start.clock).max(last);
        for monitor in self.monitors {
            let settings_of = &settings.monitors[monitor.index()];
            let signals = &settings.signals;
            let report = MonitorReport { session, test: self.id, monitor: settings_of, signals };
            monitor.finish(end, was_stopped, &report);
        }
    }
}
