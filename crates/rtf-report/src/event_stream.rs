//! The event stream on standard output: the journal's lines, as they come.

use std::io::Write;

use rtf_model::{Event, LineSealer, Record};

use crate::stdout_stream::LineStream;
use crate::{ReportError, Reporter};

/// Writes each event as a line of JSON, exactly as the journal has it.
pub struct EventStream {
    stream: LineStream,
    sealer: LineSealer,
}

impl EventStream {
    #[must_use]
    pub fn new(out: Box<dyn Write + Send>) -> Self {
        Self { stream: LineStream::new("the events", out), sealer: LineSealer::default() }
    }
}

impl Reporter for EventStream {
    fn event(&mut self, event: &Event, _record: &Record) -> Result<(), ReportError> {
        let page = &mut self.stream.page;
        let start = page.len();
        let written = serde_json::to_writer(&mut *page, event);
        debug_assert!(written.is_ok(), "memory takes everything");
        self.sealer.seal(page, start);
        self.stream.flush_if_long()
    }

    fn idle(&mut self, _record: &Record) -> Result<(), ReportError> {
        self.stream.flush()
    }

    fn finish(&mut self, _record: &Record) -> Result<(), ReportError> {
        self.stream.finish()
    }
}
