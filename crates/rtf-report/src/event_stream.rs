//! The event stream on standard output: the journal's lines, as they come.

use std::io::Write;

use rtf_model::{Event, Record};

use crate::stream::Stream;
use crate::{ReportError, Reporter};

/// Writes each event as a line of JSON, exactly as the journal has it.
pub struct EventStream(Stream);

impl EventStream {
    /// Writes to `out`.
    #[must_use]
    pub fn new(out: Box<dyn Write + Send>) -> Self {
        Self(Stream::new("the events", out))
    }
}

/// Writes an event as a line.
///
/// # Errors
/// `out` cannot be written.
pub fn write(out: &mut dyn Write, event: &Event) -> std::io::Result<()> {
    serde_json::to_writer(&mut *out, event)?;
    out.write_all(b"\n")
}

impl Reporter for EventStream {
    fn event(&mut self, event: &Event, _record: &Record) -> Result<(), ReportError> {
        let written = write(&mut self.0.page, event);
        debug_assert!(written.is_ok(), "memory takes everything");
        self.0.flush_if_long()
    }

    fn idle(&mut self, _record: &Record) -> Result<(), ReportError> {
        self.0.flush()
    }

    fn finish(&mut self, _record: &Record) -> Result<(), ReportError> {
        self.0.flush()
    }
}
