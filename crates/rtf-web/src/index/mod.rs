//! What is held in memory of a run: the fold over its journal, without what
//! tests reported and printed, and where in the journal that is to be found.
//!
//! The journal is read as far as it is written; [`Index::advance`] goes on from
//! there. This is the same for a run that goes on and for a past one.

mod attached;
mod lines;
mod parse;
mod places;

use std::fs::File;
use std::io;

use rtf_model::{Damage, Record, RunState};
use rtf_report::journal::{self, JournalLines};

pub use attached::{Attached, Description};
pub use lines::{Head, Lines};
pub use places::Places;

/// How far a run is, in the words of the API.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, utoipa::ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum State {
    /// It goes on.
    Running,
    /// It came to its end.
    Finished,
    /// It was ended early.
    Interrupted,
    /// The runner died; its guard closed the journal.
    Died,
    /// It has no end, and nobody writes any more.
    Incomplete,
    /// Its journal is long and still being read; ask again.
    Unread,
}

impl State {
    /// Whether nothing more will come.
    #[must_use]
    pub fn is_over(self) -> bool {
        !matches!(self, Self::Running | Self::Unread)
    }
}

/// What is held of one run.
#[derive(Debug)]
pub struct Index {
    file: File,
    record: Record,
    places: Places,
    lines: JournalLines,
    attached: Attached,
    /// Whole lines were read up to here.
    offset: u64,
}

impl Index {
    /// The index of a journal; nothing is read yet.
    #[must_use]
    pub fn new(file: File) -> Self {
        Self {
            file,
            record: Record::lean(),
            places: Places::default(),
            lines: JournalLines::default(),
            attached: Attached::default(),
            offset: 0,
        }
    }

    /// Reads what was written since.
    ///
    /// # Errors
    /// The journal cannot be read, or is of a newer version.
    pub fn advance(&mut self) -> io::Result<()> {
        let length = self.file.metadata()?.len();
        if length < self.offset {
            self.lines.shrunk(&mut self.record);
        }
        if length <= self.offset {
            return Ok(());
        }
        let mut lines = Lines::between(self.file.try_clone()?, self.offset, u64::MAX)?;
        while let Some(line) = lines.next()? {
            let taken = self.lines.take(line.text, parse::event, &mut self.record);
            let newer = |error| io::Error::new(io::ErrorKind::InvalidData, error);
            if let Some(event) = taken.map_err(newer)? {
                self.places.take(&event, line.start, line.end);
                self.attached.take(&event);
            }
            self.offset = line.end;
        }
        if self.offset < length {
            self.lines.torn(&mut self.record);
        }
        Ok(())
    }

    /// How far the run is.
    #[must_use]
    pub fn state(&self) -> State {
        match &self.record.state {
            RunState::Finished { interrupted: None } => State::Finished,
            RunState::Finished { interrupted: Some(_) } => State::Interrupted,
            RunState::Died { .. } => State::Died,
            RunState::Running if journal::is_written(&self.file) => State::Running,
            RunState::Running => State::Incomplete,
        }
    }

    /// The fold, without what tests reported.
    #[must_use]
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Where things are in the journal.
    #[must_use]
    pub fn places(&self) -> &Places {
        &self.places
    }

    /// What tests said about their attachments.
    #[must_use]
    pub fn attached(&self) -> &Attached {
        &self.attached
    }

    /// What could not be read.
    #[must_use]
    pub fn damages(&self) -> &[Damage] {
        &self.record.damages
    }

    /// How many bytes were read: all whole lines.
    #[must_use]
    pub fn offset(&self) -> u64 {
        self.offset
    }

    /// The number of the next event.
    #[must_use]
    pub fn next_seq(&self) -> u64 {
        self.lines.next_seq()
    }
}
