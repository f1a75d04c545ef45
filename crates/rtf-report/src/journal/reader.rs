//! Reads a journal, also one that is damaged.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};

use rtf_model::{Damage, EVENTS_VERSION, Event, LineCheck, LineChecker, Record};

use super::lines::{JournalLines, NewerVersion};
use crate::{ReportError, Reporter};

/// What was found in a journal.
#[derive(Debug)]
pub struct Stored {
    /// The fold over all events that could be read, and what is damaged.
    pub record: Record,
    /// Whether the last line is incomplete, as a killed runner leaves it. All
    /// that was written before it is there.
    pub torn: bool,
}

/// A journal cannot be read at all.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    #[error("cannot read the journal `{}`", path.display())]
    Read {
        path: PathBuf,
        #[source]
        source: io::Error,
    },
    /// No line of it is an event.
    #[error("`{}` is not a journal: {first}", path.display())]
    NotAJournal {
        path: PathBuf,
        /// What is wrong with its first line.
        first: Damage,
    },
    #[error(
        "the journal `{}` is of version {found}, this program reads up to version {EVENTS_VERSION}",
        path.display()
    )]
    Version { path: PathBuf, found: u32 },
    /// It is not what it was when it was read before.
    #[error("the journal `{}` has changed since it was read", path.display())]
    Changed { path: PathBuf },
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

/// Reads a journal from somewhere else than a file; `path` names it in errors.
///
/// # Errors
/// As for [`read`].
pub fn read_from(path: &Path, journal: impl BufRead) -> Result<Stored, JournalError> {
    Reading::new(path, |_, _, _| Ok(())).from(journal)
}

/// Reads a journal and gives its events to a reporter, as during the run. The
/// reporter is given a record that names all damage from the first event on.
///
/// # Errors
/// As for [`read`]; and the reporter's own.
pub fn replay(path: &Path, reporter: &mut dyn Reporter) -> Result<Stored, JournalError> {
    let damages = find_damage(path)?;
    let mut reading = Reading::new(path, |_, event, record| reporter.event(&event, record));
    reading.is_damage_known = !damages.is_empty();
    reading.stored.record.damages = damages;
    let stored = reading.all()?;
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
    mut visit: impl FnMut(&Event, &Record) -> Result<(), ReportError>,
) -> Result<Stored, JournalError> {
    Reading::new(path, |_, event, record| visit(&event, record)).all()
}

/// Reads a journal into a [lean](Record::lean) record and calls `visit` with each line that is
/// an event, without its end, and with the event. Holds one line at a time.
///
/// # Errors
/// As for [`read`].
pub fn read_events(
    path: &Path,
    mut visit: impl FnMut(&[u8], Event),
) -> Result<Stored, JournalError> {
    let visit = |line: &[u8], event, _: &Record| {
        visit(line, event);
        Ok(())
    };
    let mut reading = Reading::new(path, visit);
    reading.stored.record = Record::lean();
    reading.all()
}

/// Reads a journal and calls `visit` with each line that is an event, as it is
/// in the file, with its check value and without its end.
///
/// # Errors
/// As for [`read`]; and the first error of `visit`.
pub fn read_lines(
    path: &Path,
    mut visit: impl FnMut(&[u8]) -> Result<(), ReportError>,
) -> Result<Stored, JournalError> {
    Reading::new(path, |line, _, _| visit(line)).all()
}

/// Finds all damage of a journal without showing any of it.
///
/// # Errors
/// As for [`read`].
pub fn find_damage(path: &Path) -> Result<Vec<Damage>, JournalError> {
    // The check values alone tell whether there is any, in a fraction of the time.
    let is_intact = is_intact(path).map_err(|source| unreadable(path, source))?;
    if is_intact { Ok(Vec::new()) } else { Ok(read(path)?.record.damages) }
}

/// Whether each line has the check value that it should have.
fn is_intact(path: &Path) -> io::Result<bool> {
    let (mut file, mut line) = (open(path)?, Vec::new());
    let mut checker = LineChecker::default();
    while let Some(found) = next_line(&mut file, &mut line)? {
        match found {
            RawLine::Whole(line) if checker.check(line) == LineCheck::Intact => {}
            // Whether a torn line is damage depends on what stands before it.
            RawLine::Whole(_) | RawLine::Torn(_) => return Ok(false),
        }
    }
    Ok(true)
}

pub(super) fn open(path: &Path) -> io::Result<BufReader<File>> {
    Ok(BufReader::with_capacity(64 * 1024, File::open(path)?))
}

pub(super) enum RawLine<'a> {
    /// A line without its end.
    Whole(&'a [u8]),
    /// What stands after the last end of a line.
    Torn(&'a [u8]),
}

pub(super) fn next_line<'a>(
    file: &mut impl BufRead,
    text: &'a mut Vec<u8>,
) -> io::Result<Option<RawLine<'a>>> {
    text.clear();
    let read = file.read_until(b'\n', text)?;
    let line = || text.strip_suffix(b"\n").map_or(RawLine::Torn(text), RawLine::Whole);
    Ok((read > 0).then(line))
}

pub(super) fn unreadable(path: &Path, source: io::Error) -> JournalError {
    JournalError::Read { path: path.to_owned(), source }
}

struct Reading<'a, V> {
    path: &'a Path,
    visit: V,
    stored: Stored,
    lines: JournalLines,
    /// Whether the record has all damage already.
    is_damage_known: bool,
}

impl<'a, V: FnMut(&[u8], Event, &Record) -> Result<(), ReportError>> Reading<'a, V> {
    fn new(path: &'a Path, visit: V) -> Self {
        let stored = Stored { record: Record::default(), torn: false };
        Self { path, visit, stored, lines: JournalLines::default(), is_damage_known: false }
    }

    fn all(self) -> Result<Stored, JournalError> {
        let file = open(self.path).map_err(|source| unreadable(self.path, source))?;
        self.from(file)
    }

    fn from(mut self, mut journal: impl BufRead) -> Result<Stored, JournalError> {
        let (path, mut text) = (self.path, Vec::new());
        let failed = |source| unreadable(path, source);
        while let Some(line) = next_line(&mut journal, &mut text).map_err(failed)? {
            match line {
                RawLine::Whole(line) => self.line(line)?,
                // The only line of a journal whose runner was killed at once begins
                // as an event does; anything else is another file.
                RawLine::Torn(text) if self.lines.has_begun() || text.starts_with(b"{") => {
                    self.stored.torn = true;
                    if !self.is_damage_known {
                        self.lines.record_incomplete_line(&mut self.stored.record);
                    }
                }
                RawLine::Torn(text) => self.line(text)?,
            }
        }
        match (self.stored.record.events, self.stored.record.damages.first()) {
            (0, Some(first)) => {
                Err(JournalError::NotAJournal { path: self.path.to_owned(), first: first.clone() })
            }
            _ => Ok(self.stored),
        }
    }

    fn line(&mut self, line: &[u8]) -> Result<(), JournalError> {
        let record = &mut self.stored.record;
        let known = record.damages.len();
        let event = self.lines.read(line, record).map_err(|NewerVersion { found }| {
            JournalError::Version { path: self.path.to_owned(), found }
        })?;
        if self.is_damage_known {
            record.damages.truncate(known);
        }
        let Some(event) = event else { return Ok(()) };
        (self.visit)(line, event, record).map_err(JournalError::from)
    }
}
