//! Shows a run on the console, and a summary at its end.
//!
//! The lines are the data of `rtf run` and go to standard output. The
//! progress bar goes to standard error, and only to a terminal. During a run,
//! a [`BackgroundWriter`] writes both; if it cannot keep up with the
//! messages, the console omits detail and shows how much.

mod case_summary;
mod details;
mod failed_tests;
mod fixture_values;
mod hooks;
mod live;
mod options;
mod page;
mod progress;
mod questions;
mod result_details;
mod results;
mod skips;
mod style;
mod summary;
mod verbose;

use std::io::Write;
use std::path::Path;
use std::time::Duration;

use rtf_model::{Event, EventKind, Micros, Record};

pub use details::drop_details;
pub use failed_tests::{is_recording, replay_test};
pub use options::{
    ConsoleOptions, ReplayCommand, RerunCommand, TestCommands, Verbosity, rerun_suite,
};
pub use questions::{AskedHere, Operator, prompt, question_text};

use crate::background_writer::BackgroundWriter;
use crate::disconnect::UntilDisconnect;
use crate::progress_bar::{Bar, BarState};
use crate::{ReportError, Reporter, words};
use options::View;
use page::ConsoleLines;
use progress::Progress;
use questions::QuestionPrompt;
use verbose::Verbose;

/// Lines are written when this number of bytes is pending …
const PAGE: usize = 16 * 1024;

/// … or after this time.
const PATIENCE: Duration = Duration::from_millis(200);

pub struct Console {
    options: ConsoleOptions,
    out: UntilDisconnect,
    /// The writer behind `out`, if it writes in the background.
    background: Option<BackgroundWriter>,
    bar: Bar,
    page: ConsoleLines,
    written: Micros,
    progress: Progress,
    verbose: Verbose,
    prompt: QuestionPrompt,
    /// Number of omitted lines that are not reported yet.
    left_out: u64,
}

impl Console {
    /// Writes to standard output, with colours if enabled
    /// (`NO_COLOR`, `CLICOLOR`, a terminal or not).
    #[must_use]
    pub fn stdout(options: ConsoleOptions) -> Self {
        Self::new(Box::new(anstream::AutoStream::auto(std::io::stdout())), options)
    }

    /// Writes through a background writer, for a run that must not wait.
    #[must_use]
    pub fn over(writer: &BackgroundWriter, options: ConsoleOptions) -> Self {
        Self { background: Some(writer.clone()), ..Self::new(writer.for_colours(), options) }
    }

    /// Writes to `out`, with colour codes.
    #[must_use]
    pub fn new(out: Box<dyn Write + Send>, options: ConsoleOptions) -> Self {
        let progress = if options.progress { Progress::on_terminal() } else { Progress::hidden() };
        let page = match options.everything() {
            Some(everything) => ConsoleLines::limited(everything),
            None => ConsoleLines::default(),
        };
        Self {
            options,
            out: UntilDisconnect::new(out),
            background: None,
            bar: Bar::hidden(),
            page,
            written: Micros::default(),
            progress,
            verbose: Verbose::default(),
            prompt: QuestionPrompt::default(),
            left_out: 0,
        }
    }

    /// Lets an operator answer questions of tests at this terminal.
    #[must_use]
    pub fn with_operator(self, operator: Operator) -> Self {
        Self { prompt: QuestionPrompt::new(operator), ..self }
    }

    /// Shows which question can be answered, and passes it to the person.
    fn update_question(&mut self, event: &Event, record: &Record) -> Result<(), ReportError> {
        let Self { prompt, page, options, .. } = self;
        let Some(text) = prompt.update(page, View { options, record }, &event.kind) else {
            return Ok(());
        };
        self.flush(event.at)?;
        let bar = self.progress.set_prompt(text);
        // Input for an earlier question is discarded before this one is visible.
        self.prompt.pass();
        self.show_bar(&bar);
        Ok(())
    }

    fn flush(&mut self, at: Micros) -> Result<(), ReportError> {
        self.written = at;
        self.page.end_entry();
        if self.page.text.is_empty() {
            return Ok(());
        }
        let Self { out, page, bar, background, .. } = self;
        let written = bar.around(|| {
            out.write_all(page.text.as_bytes())?;
            // A background writer is flushed only at the end.
            if background.is_none() { out.flush() } else { Ok(()) }
        });
        self.page.text.clear();
        written.map_err(failed)
    }

    fn show_bar(&mut self, state: &BarState) {
        match &self.background {
            Some(writer) => writer.show(state.clone()),
            None => self.bar.show(state),
        }
    }

    /// Shows an event in full detail, unless too much output is pending.
    fn show_verbose(&mut self, event: &Event, record: &Record) {
        if self.background.as_ref().is_some_and(BackgroundWriter::is_full)
            && let Some(lines) = self.verbose.skip(event)
        {
            self.left_out += lines;
            return;
        }
        self.report_left_out();
        self.verbose.show(&mut self.page, event, record);
    }

    fn report_left_out(&mut self) {
        let lines = std::mem::take(&mut self.left_out);
        if lines > 0 {
            let text = format!("{} (standard output is too slow)", words::count(lines, "line"));
            self.page.remark((style::LOUD, "left out"), &text);
        }
    }
}

impl Reporter for Console {
    fn event(&mut self, event: &Event, record: &Record) -> Result<(), ReportError> {
        if self.options.verbosity == Verbosity::Verbose {
            self.show_verbose(event, record);
        }
        live::show(&mut self.page, View { options: &self.options, record }, event);
        let bar = self.progress.event(event, record);
        bar.iter().for_each(|state| self.show_bar(state));
        if matches!(event.kind, EventKind::QuestionAsked(_) | EventKind::QuestionClosed(_)) {
            self.update_question(event, record)?;
        }
        let is_late = event.at.since(self.written) > PATIENCE;
        if is_late || self.page.text.len() > PAGE { self.flush(event.at) } else { Ok(()) }
    }

    fn idle(&mut self, record: &Record) -> Result<(), ReportError> {
        self.flush(record.last_at)
    }

    fn reporter_failed(&mut self, error: &ReportError) {
        live::reporter_failed(&mut self.page, error);
    }

    fn finish(&mut self, record: &Record) -> Result<(), ReportError> {
        self.prompt.end();
        let bar = self.progress.end();
        bar.iter().for_each(|state| self.show_bar(state));
        self.report_left_out();
        self.verbose.flush(&mut self.page, record);
        summary::show(&mut self.page, View { options: &self.options, record });
        self.flush(record.last_at)?;
        let written = self.out.flush();
        written.map_err(failed)
    }
}

fn failed(error: std::io::Error) -> ReportError {
    ReportError::at("what happens", Path::new("standard output"))(error)
}
