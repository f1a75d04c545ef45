//! Tells people what happens while a run goes on, and at its end what came of it.
//!
//! The lines go to standard output: they are what `rtf run` is asked for. The
//! progress bar goes to standard error, and only to a terminal.

mod hooks;
mod live;
mod options;
mod page;
mod progress;
mod style;
mod summary;
mod verbose;

use std::io::{ErrorKind, Write};
use std::path::Path;
use std::time::Duration;

use rtf_model::{Event, Micros, Record};

pub use options::{ConsoleOptions, Rerun, Verbosity, rerun_suite};

use crate::{ReportError, Reporter};
use page::Page;
use progress::Progress;
use verbose::Verbose;

/// Lines are written at the latest when so many bytes wait …
const PAGE: usize = 16 * 1024;

/// … or when so much time has passed, however busy the run is.
const PATIENCE: Duration = Duration::from_millis(200);

/// Tells people what happens.
pub struct Console {
    options: ConsoleOptions,
    out: Box<dyn Write + Send>,
    page: Page,
    written: Micros,
    progress: Progress,
    verbose: Verbose,
}

impl Console {
    /// Writes to standard output, with colours where that is wanted
    /// (`NO_COLOR`, `CLICOLOR`, a terminal or not).
    #[must_use]
    pub fn stdout(options: ConsoleOptions) -> Self {
        Self::new(Box::new(anstream::AutoStream::auto(std::io::stdout())), options)
    }

    /// Writes to `out`, with colour codes: wrap it to be rid of them.
    #[must_use]
    pub fn new(out: Box<dyn Write + Send>, options: ConsoleOptions) -> Self {
        let progress = if options.progress { Progress::on_terminal() } else { Progress::hidden() };
        Self {
            options,
            out,
            page: Page::default(),
            written: Micros::default(),
            progress,
            verbose: Verbose::default(),
        }
    }

    fn flush(&mut self, at: Micros) -> Result<(), ReportError> {
        self.written = at;
        if self.page.len() == 0 {
            return Ok(());
        }
        let Self { out, page, progress, .. } = self;
        let written = progress.around(|| out.write_all(page.as_bytes()).and_then(|()| out.flush()));
        self.page.clear();
        if written.as_ref().is_err_and(|error| error.kind() == ErrorKind::BrokenPipe) {
            // Whoever read along (`head`, a pager) has seen enough: the run goes
            // on, and its exit code stays about the tests.
            self.out = Box::new(std::io::sink());
            return Ok(());
        }
        written.map_err(ReportError::at("what happens", Path::new("standard output")))
    }
}

impl Reporter for Console {
    fn event(&mut self, event: &Event, record: &Record) -> Result<(), ReportError> {
        if self.options.verbosity == Verbosity::Verbose {
            self.verbose.show(&mut self.page, event, record);
        }
        live::show(&mut self.page, &self.options, event, record);
        self.progress.event(event, record);
        let is_late = event.at.since(self.written) > PATIENCE;
        if is_late || self.page.len() > PAGE { self.flush(event.at) } else { Ok(()) }
    }

    fn idle(&mut self, record: &Record) -> Result<(), ReportError> {
        self.flush(record.last_at)
    }

    fn finish(&mut self, record: &Record) -> Result<(), ReportError> {
        self.progress.end();
        self.verbose.flush(&mut self.page, record);
        summary::show(&mut self.page, &self.options, record);
        self.flush(record.last_at)
    }
}
