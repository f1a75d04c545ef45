//! `result.txt`.

use std::io::{self, Write};
use std::path::Path;

use rtf_model::Record;

use super::result_line::ResultLine;
use super::{lines, summary};
use crate::journal::{self, JournalError};
use crate::{ReportError, ReportFile};

/// Writes all lines of a run into a file at the end of the run. They come from the journal,
/// so that the output of a test is never held in memory.
///
/// # Errors
/// The file cannot be written.
pub fn file(path: &Path, journal: &Path, detail: bool) -> Result<ReportFile, ReportError> {
    let journal = journal.to_owned();
    let write = move |out: &mut dyn Write, _: &Record| self::write(out, &journal, detail);
    ReportFile::new("the result file", path, Box::new(write))
}

/// Writes the result file of a run from its journal.
///
/// # Errors
/// The journal cannot be read, or `out` cannot be written.
pub fn write(out: &mut dyn Write, journal: &Path, detail: bool) -> io::Result<()> {
    let mut problem = None;
    for damage in &journal::find_damage(journal).map_err(unreadable)? {
        writeln!(out, "the journal of this run is damaged: {damage}")?;
    }
    let stored = journal::read_with(journal, |event, record| {
        if problem.is_none() {
            problem = put_all(out, &lines::of(event, record), detail).err();
        }
        Ok(())
    });
    if let Some(problem) = problem {
        return Err(problem);
    }
    let record = stored.map_err(unreadable)?.record;
    put_all(out, &lines::left_open(&record), detail)?;
    out.write_all(summary::of(&record, "summary").as_bytes())
}

pub(super) fn unreadable(error: JournalError) -> io::Error {
    match error {
        JournalError::Read { source, .. } => source,
        error => io::Error::other(error),
    }
}

fn put_all(out: &mut dyn Write, lines: &[ResultLine], detail: bool) -> io::Result<()> {
    for line in lines {
        writeln!(out, "{}{}", line.word.as_str(), line.text())?;
        if let Some(place) = line.place.as_ref().filter(|_| detail) {
            writeln!(out, "{place}\n")?;
        }
    }
    Ok(())
}
