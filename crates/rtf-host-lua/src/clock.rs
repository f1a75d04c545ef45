//! The time for a plug-in: the simulator's, if its suite has a clock.

use std::path::PathBuf;
use std::time::Instant;

use rtf_model::parse_clock;
use rtf_model::protocol::CLOCK_VARIABLE;

#[derive(Debug)]
pub(crate) enum Clock {
    /// The wall clock, from this time on.
    Wall(Instant),
    /// A file with a simulator's time.
    Simulated(PathBuf),
}

impl Clock {
    /// The clock that the runner has chosen.
    pub(crate) fn new() -> Self {
        match std::env::var_os(CLOCK_VARIABLE) {
            Some(file) if !file.is_empty() => Self::Simulated(file.into()),
            _ => Self::Wall(Instant::now()),
        }
    }

    pub(crate) fn is_simulated(&self) -> bool {
        matches!(self, Self::Simulated(_))
    }

    /// Its time in seconds; `None` while the file is being written.
    pub(crate) fn seconds(&self) -> Option<f64> {
        match self {
            Self::Wall(start) => Some(start.elapsed().as_secs_f64()),
            Self::Simulated(file) => {
                let text = std::fs::read_to_string(file).ok()?;
                Some(parse_clock(&text)?.as_secs_f64())
            }
        }
    }
}
