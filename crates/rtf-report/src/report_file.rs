//! Reports that are generated from the record at the end of the run.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use rtf_model::Record;

use crate::{ReportError, Reporter, is_disconnect, output_file};

pub type WriteReport = Box<dyn Fn(&mut dyn Write, &Record) -> io::Result<()> + Send>;

pub type PrintAnnotations = Box<dyn Fn(&Record) -> io::Result<()> + Send>;

/// Prints annotations on standard error at the end of the run.
pub struct AnnotationReporter(pub PrintAnnotations);

impl Reporter for AnnotationReporter {
    fn finish(&mut self, record: &Record) -> Result<(), ReportError> {
        match (self.0)(record) {
            Err(error) if is_disconnect(&error) => Ok(()),
            told => told.map_err(ReportError::at("annotations", Path::new("standard error"))),
        }
    }
}

/// Prints on standard error what another reporter could not write, as soon as
/// that happens: for runs whose standard output is data.
#[derive(Debug)]
pub struct FailureNotice;

impl Reporter for FailureNotice {
    fn reporter_failed(&mut self, error: &ReportError) {
        // The same is said at the end, and by the exit code.
        drop(writeln!(io::stderr(), "error: {error}: {}", error.source));
    }
}

/// Writes a file at the end of the run.
pub struct ReportFile {
    what: &'static str,
    path: PathBuf,
    write: WriteReport,
}

impl ReportFile {
    /// Checks that the file can be written: call it before the run. `what`
    /// names the report in errors.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn new(what: &'static str, path: &Path, write: WriteReport) -> Result<Self, ReportError> {
        output_file::probe(what, path)?;
        Ok(Self { what, path: path.to_owned(), write })
    }
}

impl Reporter for ReportFile {
    fn finish(&mut self, record: &Record) -> Result<(), ReportError> {
        output_file::write(self.what, &self.path, |out| (self.write)(out, record))
    }
}
