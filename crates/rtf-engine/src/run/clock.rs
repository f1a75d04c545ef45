//! The clock that the tests of a suite follow: its file, when to poll it, and its time.

use std::path::{Path, PathBuf};
use std::time::Duration;

use rtf_model::parse_clock;
use rtf_model::protocol::{CLOCK_FILE_VARIABLE, CLOCK_VARIABLE};
use rtf_process::spawn_request::ProcessRole;

use rtf_plan::plan::SuitePlan;

const POLL_INTERVAL: Duration = Duration::from_millis(10);

/// The clock of a suite; the wall clock if it has no file.
#[derive(Debug)]
pub struct SuiteClock {
    file: Option<PathBuf>,
    /// The time of the next poll, while a test follows the clock.
    next_poll: Option<Duration>,
    /// Whether a test that follows another clock has started rtf.
    inherited: bool,
}

impl SuiteClock {
    /// Creates the clock of a suite, with a file in this directory.
    pub fn new(suite: &SuitePlan, dir: &Path) -> Self {
        let file = suite.clock.as_ref().map(|_| dir.join(format!("clock-{}", suite.id)));
        let inherited = std::env::var_os(CLOCK_VARIABLE).is_some();
        Self { file, next_poll: None, inherited }
    }

    /// Returns when to poll it, in the time of the run.
    pub fn next_poll(&mut self, wanted: bool, now: Duration) -> Option<Duration> {
        self.next_poll = wanted.then(|| self.next_poll.unwrap_or(now));
        self.next_poll
    }

    /// Returns its time, if a poll is due.
    pub fn poll(&mut self, now: Duration) -> Option<Duration> {
        self.next_poll.take_if(|due| *due <= now)?;
        self.next_poll = Some(now + POLL_INTERVAL);
        let text = std::fs::read_to_string(self.file.as_ref()?).ok()?;
        parse_clock(&text)
    }

    /// Returns the variables for a process. Hooks and fixtures must not depend on the clock, but
    /// a fixture may be the one that drives it.
    pub fn variables(&self, role: ProcessRole) -> Vec<(String, String)> {
        let file = self.file.as_ref().map(|file| file.to_string_lossy().into_owned());
        let mut variables = Vec::new();
        if role == ProcessRole::Fixture {
            variables.extend(file.clone().map(|file| (CLOCK_FILE_VARIABLE, file)));
        }
        match file.filter(|_| role == ProcessRole::Test) {
            Some(file) => variables.push((CLOCK_VARIABLE, file)),
            None if self.inherited => variables.push((CLOCK_VARIABLE, String::new())),
            None => {}
        }
        variables.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }
}
