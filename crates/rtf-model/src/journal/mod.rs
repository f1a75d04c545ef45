//! What makes a journal trustworthy: a check value on each line, and rules that
//! a stored stream of events satisfies as a whole. Pure data, as everything in
//! this crate; `rtf-report` reads and writes the file.

mod line;
mod stream;

use std::fmt;

pub use line::{LineCheck, LineChecker, LineSealer};
pub use stream::{Checked, StreamChecker};

/// A place in a journal that is damaged, or where something is missing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Damage {
    /// The line, from 1.
    pub line: u64,
    /// What is wrong with it.
    pub problem: String,
}

impl Damage {
    /// How many are kept of one journal; a file that is full of them has one story to tell.
    pub const KEPT: usize = 100;
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.problem)
    }
}

impl std::error::Error for Damage {}
