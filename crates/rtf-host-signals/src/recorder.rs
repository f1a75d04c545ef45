//! Distributes samples to the running tests.

use std::sync::Arc;
use std::time::{Duration, Instant};

use rtf_host::{Session, SuiteClock};
use rtf_model::protocol::{TestAttempt, TestReport};
use rtf_model::{SignalTime, TestId};

use crate::recording::Recording;
use crate::settings::Settings;
use crate::source_time::{Origin, SampleTime, TestStart};
use crate::test_run::{SignalSample, TestRun};

/// The running tests. Sources are numbered: the programs, the measured fixtures, the recordings,
/// and what a test itself reports.
#[derive(Debug)]
pub(crate) struct Recorder {
    settings: Arc<Settings>,
    session: Session,
    clock: SuiteClock,
    tests: Vec<TestRun>,
    recordings: Vec<Recording>,
    /// The time of the last sample of each source.
    last: Vec<Option<SampleTime>>,
}

impl Recorder {
    pub fn new(settings: Arc<Settings>, recordings: Vec<Recording>, session: Session) -> Self {
        let sources = settings.test_source() + 1;
        let clock = SuiteClock::new(settings.has_clock);
        let (tests, last) = (Vec::new(), vec![None; sources]);
        Self { settings, session, clock, tests, recordings, last }
    }

    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    pub fn clock(&self) -> &SuiteClock {
        &self.clock
    }

    pub fn sample(&mut self, sample: SignalSample) {
        self.last[sample.source] = Some(sample.time);
        for test in &mut self.tests {
            test.sample(sample);
        }
    }

    /// A test is about to start.
    ///
    /// # Errors
    /// The suite's clock shows no time.
    pub fn start(&mut self, test: &TestAttempt) -> Result<(), String> {
        let start = self.now()?;
        let origin = |(source, last): (usize, &Option<SampleTime>)| {
            let live = self.settings.programs.len() + self.settings.processes.len();
            let time = match self.settings.programs.get(source) {
                Some(program) => program.time,
                None if source < live => SignalTime::Clock,
                // Their times are those of the test.
                None => SignalTime::Arrival,
            };
            Origin::at_start(time, start, *last)
        };
        let origins = self.last.iter().enumerate().map(origin).collect();
        self.tests.retain(|other| other.id != test.id);
        self.tests.push(TestRun::new(test, start, origins, (&self.settings, &self.session)));
        Ok(())
    }

    /// The process of a test has ended.
    ///
    /// # Errors
    /// The suite's clock shows no time.
    pub fn finish(&mut self, test: TestId, was_stopped: bool) -> Result<(), String> {
        let now = self.now()?;
        let ended = self.tests.extract_if(.., |running| running.id == test);
        for mut test in ended {
            test.play(&self.recordings, now);
            test.finish(now, was_stopped);
        }
        Ok(())
    }

    /// A running test has reported something.
    pub fn reported(&mut self, test: TestId, report: TestReport) {
        // It follows the answer to the start of the test, which needed the clock.
        let Ok(now) = self.now() else { return };
        if let Some(test) = self.tests.iter_mut().find(|running| running.id == test) {
            test.reported(report, now);
        }
    }

    /// Plays the recordings for the running tests; returns when the next sample is due.
    pub fn play(&mut self) -> Option<Duration> {
        let now = self.now().ok()?;
        for test in &mut self.tests {
            test.play(&self.recordings, now);
        }
        let next = self.tests.iter().filter_map(|test| test.next_recorded(&self.recordings, now));
        Duration::try_from_secs_f64(next.reduce(f64::min)?).ok()
    }

    pub fn send(&mut self) {
        self.tests.iter_mut().for_each(TestRun::send);
    }

    fn now(&self) -> Result<TestStart, String> {
        // The file is replaced while it is read, if at all.
        let clock = self.clock.now().or_else(|| self.clock.now());
        let clock = clock.ok_or("the suite's clock shows no time")?;
        Ok(TestStart { instant: Instant::now(), clock })
    }
}

#[cfg(test)]
mod tests;
