//! The journal of a run: `events.jsonl`, one event a line, written as it
//! happens. It is the truth from which every report can be made again, also
//! after the runner was killed.

mod reader;
mod writer;

pub use reader::{Damage, JournalError, Stored, read, read_with, replay};
pub use writer::Journal;
