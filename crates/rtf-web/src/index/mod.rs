//! What is held in memory of a run: the fold over its journal, without what
//! tests reported and printed, and where in the journal that is to be found.
//!
//! The journal is read as far as it is written; [`Index::advance`] goes on from
//! there. This is the same for a run that goes on and for a past one.

mod lines;
mod parse;
mod places;

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use rtf_model::{EVENTS_VERSION, Event, EventKind, Record, RunState};
use rtf_report::journal::{self, Damage};

pub use lines::{Head, Line, Lines};
pub use places::Places;

/// How many damages are kept; a file that is full of them has one story to tell.
const DAMAGES_KEPT: usize = 100;

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
    path: PathBuf,
    file: File,
    record: Record,
    places: Places,
    damages: Vec<Damage>,
    /// Whole lines were read up to here.
    offset: u64,
    line: u64,
    next_seq: u64,
}

impl Index {
    /// Opens a journal; nothing is read yet.
    ///
    /// # Errors
    /// It cannot be opened.
    pub fn open(path: &Path) -> io::Result<Self> {
        Ok(Self {
            path: path.to_owned(),
            file: File::open(path)?,
            record: Record::lean(),
            places: Places::default(),
            damages: Vec::new(),
            offset: 0,
            line: 0,
            next_seq: 0,
        })
    }

    /// Reads what was written since.
    ///
    /// # Errors
    /// The journal cannot be read, or is of a newer version.
    pub fn advance(&mut self) -> io::Result<()> {
        if self.file.metadata()?.len() == self.offset {
            return Ok(());
        }
        let mut lines = Lines::between(self.file.try_clone()?, self.offset, u64::MAX)?;
        while let Some(line) = lines.next()? {
            self.line += 1;
            match parse::event(line.text) {
                Ok(event) => self.event(&event, &line)?,
                Err(error) => self.damage(format!("this is not an event: {error}")),
            }
            self.offset = line.end;
        }
        Ok(())
    }

    fn event(&mut self, event: &Event, line: &Line<'_>) -> io::Result<()> {
        if let EventKind::RunStarted(run) = &event.kind
            && run.version > EVENTS_VERSION
        {
            let found = format!("the journal is of version {}", run.version);
            let known = format!("this program reads up to version {EVENTS_VERSION}");
            return Err(io::Error::new(io::ErrorKind::InvalidData, format!("{found}, {known}")));
        }
        if event.seq != self.next_seq {
            let expected = self.next_seq;
            self.damage(format!("event {} stands where event {expected} should be", event.seq));
        }
        if event.seq < self.next_seq {
            return Ok(());
        }
        self.next_seq = event.seq.saturating_add(1);
        self.record.apply(event);
        self.places.take(event, line.start, line.end);
        Ok(())
    }

    fn damage(&mut self, problem: String) {
        if self.damages.len() < DAMAGES_KEPT {
            self.damages.push(Damage { line: self.line, problem });
        }
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

    /// What could not be read.
    #[must_use]
    pub fn damages(&self) -> &[Damage] {
        &self.damages
    }

    /// The journal's path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// How many bytes were read: all whole lines.
    #[must_use]
    pub fn offset(&self) -> u64 {
        self.offset
    }

    /// The number of the next event.
    #[must_use]
    pub fn next_seq(&self) -> u64 {
        self.next_seq
    }
}
