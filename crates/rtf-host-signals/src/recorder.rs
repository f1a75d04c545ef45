//! Distributes samples to the running tests.

use std::sync::Arc;
use std::time::Instant;

use rtf_host::{Session, SuiteClock};
use rtf_model::protocol::TestAttempt;
use rtf_model::{SignalTime, TestId};

use crate::settings::Settings;
use crate::source_time::{Origin, SampleTime, TestStart};
use crate::test_run::{SignalSample, TestRun};

/// The running tests. Sources are numbered: first the programs, then the measured fixtures.
#[derive(Debug)]
pub(crate) struct Recorder {
    settings: Arc<Settings>,
    session: Session,
    clock: SuiteClock,
    tests: Vec<TestRun>,
    /// The time of the last sample of each source.
    last: Vec<Option<SampleTime>>,
}

impl Recorder {
    pub fn new(settings: Arc<Settings>, session: Session) -> Self {
        let sources = settings.programs.len() + settings.processes.len();
        let clock = SuiteClock::new(settings.has_clock);
        Self { settings, session, clock, tests: Vec::new(), last: vec![None; sources] }
    }

    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    pub fn clock(&self) -> &SuiteClock {
        &self.clock
    }

    /// Takes a sample.
    pub fn sample(&mut self, sample: SignalSample) {
        self.last[sample.source] = Some(sample.time);
        for test in &mut self.tests {
            test.sample(sample, &self.settings, &self.session);
        }
    }

    /// A test is about to start.
    ///
    /// # Errors
    /// The suite's clock shows no time.
    pub fn start(&mut self, test: &TestAttempt) -> Result<(), String> {
        let start = self.now()?;
        let origin = |(source, last): (usize, &Option<SampleTime>)| {
            let program = self.settings.programs.get(source);
            let time = program.map_or(SignalTime::Clock, |program| program.time);
            Origin::at_start(time, start, *last)
        };
        let origins = self.last.iter().enumerate().map(origin).collect();
        self.tests.retain(|other| other.id != test.id);
        self.tests.push(TestRun::new(test, start, origins, &self.settings));
        Ok(())
    }

    /// The process of a test has ended.
    ///
    /// # Errors
    /// The suite's clock shows no time.
    pub fn finish(&mut self, test: TestId, was_stopped: bool) -> Result<(), String> {
        let now = self.now()?;
        let ended = self.tests.extract_if(.., |running| running.id == test);
        ended.for_each(|test| test.finish((now, was_stopped), &self.settings, &self.session));
        Ok(())
    }

    /// Sends the samples that were taken.
    pub fn send(&mut self) {
        self.tests.iter_mut().for_each(|test| test.send(&self.session));
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
