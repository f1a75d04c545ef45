//! The clock of a suite: simulated, or the time of day.

use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};

use rtf_model::parse_clock;
use rtf_model::protocol::CLOCK_FILE_VARIABLE;

#[derive(Debug)]
pub struct SuiteClock {
    /// The file with the simulated time.
    file: Option<PathBuf>,
}

impl SuiteClock {
    /// The simulated time, or that of the day.
    #[must_use]
    pub fn new(is_simulated: bool) -> Self {
        let file = std::env::var_os(CLOCK_FILE_VARIABLE).filter(|_| is_simulated);
        Self { file: file.map(PathBuf::from) }
    }

    pub fn is_simulated(&self) -> bool {
        self.file.is_some()
    }

    /// Its time in seconds; `None` while the file is being written.
    #[must_use]
    pub fn now(&self) -> Option<f64> {
        let Some(file) = &self.file else {
            return Some(SystemTime::now().duration_since(UNIX_EPOCH).ok()?.as_secs_f64());
        };
        let text = std::fs::read_to_string(file).ok()?;
        Some(parse_clock(&text)?.as_secs_f64())
    }

    /// How its times are described to a user.
    #[must_use]
    pub fn description(&self) -> &'static str {
        match self.file {
            Some(_) => "seconds of the suite's clock",
            None => "seconds since 1970 UTC",
        }
    }
}
