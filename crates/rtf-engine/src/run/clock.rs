//! The clock that the tests of a suite follow: where it is, when to look at it,
//! and what it shows.

use std::path::{Path, PathBuf};
use std::time::Duration;

use rtf_model::parse_clock;
use rtf_model::protocol::{CLOCK_FILE_VARIABLE, CLOCK_VARIABLE};
use rtf_process::spawn_request::ProcessRole;

use rtf_plan::plan::SuitePlan;

/// How often it is looked at.
const EVERY: Duration = Duration::from_millis(10);

/// The clock of a suite; the wall clock if it has no file.
#[derive(Debug)]
pub struct Clock {
    file: Option<PathBuf>,
    /// When it is to be looked at, if somebody waits for it.
    next: Option<Duration>,
    /// Whether rtf itself was started by a test that follows another clock.
    inherited: bool,
}

impl Clock {
    /// The one of a suite; its file is in a folder of the run's.
    pub fn of(suite: &SuitePlan, folder: &Path) -> Self {
        let file = suite.clock.as_ref().map(|_| folder.join(format!("clock-{}", suite.id)));
        let inherited = std::env::var_os(CLOCK_VARIABLE).is_some();
        Self { file, next: None, inherited }
    }

    /// When to look at it, in the time of the run.
    pub fn next_look(&mut self, wanted: bool, now: Duration) -> Option<Duration> {
        self.next = wanted.then(|| self.next.unwrap_or(now));
        self.next
    }

    /// What it shows, if it is to be looked at by now.
    pub fn look(&mut self, now: Duration) -> Option<Duration> {
        self.next.take_if(|next| *next <= now)?;
        self.next = Some(now + EVERY);
        let text = std::fs::read_to_string(self.file.as_ref()?).ok()?;
        parse_clock(&text)
    }

    /// What a process is told of it. A hook has to come to its end whatever the
    /// clock does, and so has a fixture, but that may be the one that makes it go.
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
