//! Reads a journal, also one that is damaged.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};

use rtf_model::{EVENTS_VERSION, Event, EventKind, Record};

use crate::{ReportError, Reporter};

/// How many damages are kept; a file that is full of them has one story to tell.
const DAMAGES_KEPT: usize = 100;

/// What was found in a journal.
#[derive(Debug)]
pub struct Stored {
    /// The fold over all events that could be read.
    pub record: Record,
    /// Whether the last line is incomplete, as a killed runner leaves it. All
    /// that was written before it is there.
    pub torn: bool,
    /// What is wrong elsewhere in the file, up to 100 places.
    pub damages: Vec<Damage>,
}

/// A place of a journal that cannot be read, or where something is missing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {problem}")]
pub struct Damage {
    /// The line, from 1.
    pub line: u64,
    /// What is wrong with it.
    pub problem: String,
}

/// A journal cannot be read at all.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The file cannot be opened or read.
    #[error("cannot read the journal `{}`", path.display())]
    Read {
        /// Which.
        path: PathBuf,
        /// Why.
        #[source]
        source: io::Error,
    },
    /// No line of it is an event.
    #[error("`{}` is not a journal: {first}", path.display())]
    NotAJournal {
        /// Which.
        path: PathBuf,
        /// What is wrong with its first line.
        first: Damage,
    },
    /// It was written by a newer runner.
    #[error(
        "the journal `{}` is of version {found}, this program reads up to version {EVENTS_VERSION}",
        path.display()
    )]
    Version {
        /// Which.
        path: PathBuf,
        /// Its version.
        found: u32,
    },
    /// A report made from it could not be written.
    #[error(transparent)]
    Report(#[from] ReportError),
}

/// Reads a journal into a record.
///
/// # Errors
/// The file cannot be read or is no journal. Damage is no error: what can be
/// read is.
pub fn read(path: &Path) -> Result<Stored, JournalError> {
    read_with(path, |_, _| Ok(()))
}

/// Reads a journal and gives its events to a reporter, as during the run.
///
/// # Errors
/// As for [`read`]; and the reporter's own.
pub fn replay(path: &Path, reporter: &mut dyn Reporter) -> Result<Stored, JournalError> {
    let stored = read_with(path, |event, record| reporter.event(event, record))?;
    reporter.finish(&stored.record)?;
    Ok(stored)
}

/// Reads a journal and calls `visit` for each event, after the record has
/// taken it in. Holds one line at a time.
///
/// # Errors
/// As for [`read`]; and the first error of `visit`.
pub fn read_with(
    path: &Path,
    visit: impl FnMut(&Event, &Record) -> Result<(), ReportError>,
) -> Result<Stored, JournalError> {
    let file = File::open(path).map_err(|source| unreadable(path, source))?;
    let stored = Stored { record: Record::default(), torn: false, damages: Vec::new() };
    let mut reading = Reading { path, visit, stored, line: 0, expected: 0, first: None };
    reading.all(BufReader::with_capacity(64 * 1024, file))?;
    match (reading.stored.record.events, reading.first) {
        (0, Some(first)) => Err(JournalError::NotAJournal { path: path.to_owned(), first }),
        _ => Ok(reading.stored),
    }
}

fn unreadable(path: &Path, source: io::Error) -> JournalError {
    JournalError::Read { path: path.to_owned(), source }
}

struct Reading<'a, V> {
    path: &'a Path,
    visit: V,
    stored: Stored,
    line: u64,
    /// The number that the next event should have.
    expected: u64,
    first: Option<Damage>,
}

impl<V: FnMut(&Event, &Record) -> Result<(), ReportError>> Reading<'_, V> {
    fn all(&mut self, mut file: impl BufRead) -> Result<(), JournalError> {
        let mut line = Vec::new();
        loop {
            line.clear();
            let read = file.read_until(b'\n', &mut line);
            if read.map_err(|source| unreadable(self.path, source))? == 0 {
                return Ok(());
            }
            self.line += 1;
            self.take(&line)?;
        }
    }

    fn take(&mut self, line: &[u8]) -> Result<(), JournalError> {
        match serde_json::from_slice::<Event>(line) {
            Ok(event) => self.event(&event),
            // The only line of a journal whose runner was killed at once begins
            // as an event does; anything else is another file.
            Err(_) if !line.ends_with(b"\n") && (self.line > 1 || line.starts_with(b"{")) => {
                self.stored.torn = true;
                Ok(())
            }
            Err(error) => {
                self.damage(format!("this is not an event: {error}"));
                Ok(())
            }
        }
    }

    fn event(&mut self, event: &Event) -> Result<(), JournalError> {
        if let EventKind::RunStarted(run) = &event.kind
            && run.version > EVENTS_VERSION
        {
            return Err(JournalError::Version { path: self.path.to_owned(), found: run.version });
        }
        if event.seq != self.expected {
            let expected = self.expected;
            self.damage(format!("event {} stands where event {expected} should be", event.seq));
        }
        if event.seq < self.expected {
            return Ok(());
        }
        self.expected = event.seq.saturating_add(1);
        self.stored.record.apply(event);
        (self.visit)(event, &self.stored.record).map_err(JournalError::from)
    }

    fn damage(&mut self, problem: String) {
        let damage = Damage { line: self.line, problem };
        if self.first.is_none() {
            self.first = Some(damage.clone());
        }
        if self.stored.damages.len() < DAMAGES_KEPT {
            self.stored.damages.push(damage);
        }
    }
}
