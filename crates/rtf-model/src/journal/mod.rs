//! The integrity of a journal: a check value on each line, and rules that
//! a stored event stream satisfies. Pure data, as everything in
//! this crate; `rtf-report` reads and writes the file.

mod line;
mod stream;

use std::fmt;

pub use line::{LineCheck, LineChecker, LineSealer};
pub use stream::{EventCheck, StreamChecker};

/// A damaged or missing line of a journal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Damage {
    /// The line, from 1.
    pub line: u64,
    /// The problem.
    pub problem: String,
}

impl Damage {
    /// Maximum number of entries that are kept per journal.
    pub const KEPT: usize = 100;
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.problem)
    }
}

impl std::error::Error for Damage {}
