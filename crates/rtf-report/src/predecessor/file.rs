//! `result.txt`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use rtf_model::{Event, Record};

use super::lines::{self, Line};
use super::summary;
use crate::journal::{self, JournalError};
use crate::{ReportError, Reporter, output_file};

const WHAT: &str = "the result file";

/// Writes all lines of a run into a file when it is over. They come from the
/// journal, so that however much a test says nothing of it is held in memory.
#[derive(Debug)]
pub struct ResultFile {
    path: PathBuf,
    journal: PathBuf,
    detail: bool,
}

impl ResultFile {
    /// Checks that the file can be written: call it before the run.
    ///
    /// # Errors
    /// It cannot.
    pub fn new(path: &Path, journal: &Path, detail: bool) -> Result<Self, ReportError> {
        output_file::probe(WHAT, path)?;
        Ok(Self { path: path.to_owned(), journal: journal.to_owned(), detail })
    }
}

impl Reporter for ResultFile {
    fn event(&mut self, _event: &Event, _record: &Record) -> Result<(), ReportError> {
        Ok(())
    }

    fn finish(&mut self, _record: &Record) -> Result<(), ReportError> {
        output_file::write(WHAT, &self.path, |out| write(out, &self.journal, self.detail))
    }
}

fn write(out: &mut dyn Write, journal: &Path, detail: bool) -> io::Result<()> {
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

fn unreadable(error: JournalError) -> io::Error {
    match error {
        JournalError::Read { source, .. } => source,
        error => io::Error::other(error),
    }
}

fn put_all(out: &mut dyn Write, lines: &[Line], detail: bool) -> io::Result<()> {
    for line in lines {
        writeln!(out, "{}{}", line.word.as_str(), line.text)?;
        if let Some(place) = line.place.as_ref().filter(|_| detail) {
            writeln!(out, "{place}\n")?;
        }
    }
    Ok(())
}
