//! Standard output as a place for a stream of data.

use std::io::Write;
use std::path::Path;

use crate::ReportError;
use crate::disconnect::UntilDisconnect;

/// So much may wait before it is written, however busy the run is.
const PAGE: usize = 16 * 1024;

/// Collects lines and writes them together.
pub(crate) struct LineStream {
    what: &'static str,
    out: UntilDisconnect,
    /// What waits to be written.
    pub page: Vec<u8>,
}

impl LineStream {
    /// A stream to `out`; `what` names it in errors.
    pub fn new(what: &'static str, out: Box<dyn Write + Send>) -> Self {
        Self { what, out: UntilDisconnect::new(out), page: Vec::new() }
    }

    pub fn push(&mut self, text: &str) {
        self.page.extend_from_slice(text.as_bytes());
    }

    pub fn flush_if_long(&mut self) -> Result<(), ReportError> {
        if self.page.len() > PAGE { self.flush() } else { Ok(()) }
    }

    pub fn flush(&mut self) -> Result<(), ReportError> {
        if self.page.is_empty() {
            return Ok(());
        }
        let written = self.out.write_all(&self.page);
        self.page.clear();
        written.map_err(self.failed())
    }

    /// Writes what waits, and waits until it is written.
    pub fn finish(&mut self) -> Result<(), ReportError> {
        self.flush()?;
        let written = self.out.flush();
        written.map_err(self.failed())
    }

    fn failed(&self) -> impl FnOnce(std::io::Error) -> ReportError {
        ReportError::at(self.what, Path::new("standard output"))
    }
}
