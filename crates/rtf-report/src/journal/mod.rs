//! The journal of a run: `events.jsonl`, one event a line, written as it
//! happens. It is the truth from which every report can be made again, also
//! after the runner was killed.

mod event_line;
mod lines;
mod page;
mod presence;
mod reader;
mod section;
mod writer;

pub use event_line::{EventHeader, parse_event};
pub use lines::{JournalLines, NewerVersion};
pub use reader::{
    JournalError, Stored, find_damage, read, read_events, read_from, read_lines, read_with, replay,
};
pub use section::{LinePosition, Section};
pub use writer::Journal;

use std::fs::{File, TryLockError};

/// Whether a runner that lives writes this journal. A file system that has no
/// locks cannot tell; then one is believed to.
#[must_use]
pub fn is_written(journal: &File) -> bool {
    match journal.try_lock_shared() {
        Ok(()) => {
            // Closing the file would do it too, and the file may be kept open.
            drop(journal.unlock());
            false
        }
        Err(TryLockError::WouldBlock | TryLockError::Error(_)) => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_journal_is_written_for_as_long_as_its_writer_lives() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("events.jsonl");
        let writer = Journal::create(&path).unwrap();
        let reader = File::open(&path).unwrap();
        assert!(is_written(&reader));
        drop(writer);
        assert!(!is_written(&reader));
    }
}
