//! The console output during the run, and the counts at its end.

use std::io::Write;

use anstyle::{AnsiColor, Style};
use rtf_model::{Event, EventKind, Output, Record};

use super::result_line::{ResultLine, Word};
use super::{lines, summary};
use crate::background_writer::BackgroundWriter;
use crate::stdout_stream::LineStream;
use crate::{ReportError, Reporter, escape};

/// How much is shown.
#[derive(Clone, Copy, Debug, Default)]
pub struct ResultListOptions {
    /// All messages, not only failures and errors.
    pub verbose: bool,
    /// The places of messages in their sources.
    pub detail: bool,
    /// The counts at the end.
    pub summary: bool,
}

/// Shows lines as they come.
pub struct ResultList {
    options: ResultListOptions,
    stream: LineStream,
    /// The writer behind `stream`, if it writes in the background.
    background: Option<BackgroundWriter>,
    /// Number of omitted lines that are not reported yet.
    left_out: usize,
    /// Whether a plug-in printed half of a line.
    within_line: bool,
}

impl ResultList {
    /// Writes to standard output, with colours if enabled.
    #[must_use]
    pub fn stdout(options: ResultListOptions) -> Self {
        Self::new(Box::new(anstream::AutoStream::auto(std::io::stdout())), options)
    }

    /// Writes through a background writer, for a run that must not wait.
    #[must_use]
    pub fn over(writer: &BackgroundWriter, options: ResultListOptions) -> Self {
        Self { background: Some(writer.clone()), ..Self::new(writer.for_colours(), options) }
    }

    /// Writes to `out`, with colour codes.
    #[must_use]
    pub fn new(out: Box<dyn Write + Send>, options: ResultListOptions) -> Self {
        let stream = LineStream::new("what happens", out);
        Self { options, stream, background: None, left_out: 0, within_line: false }
    }

    /// Whether detail is left out now, because too much waits to be written.
    fn leaves_out(&mut self, lines: usize) -> bool {
        let is_full = self.background.as_ref().is_some_and(BackgroundWriter::is_full);
        if is_full {
            self.left_out += lines;
        } else {
            self.report_left_out();
        }
        is_full
    }

    fn report_left_out(&mut self) {
        let lines = std::mem::take(&mut self.left_out);
        if lines > 0 {
            self.end_line();
            self.stream
                .push(&format!("[… {lines} lines left out: standard output is too slow …]\n"));
        }
    }

    fn line(&mut self, line: &ResultLine) {
        let shown = matches!(line.word, Word::Warn | Word::Fail | Word::Error);
        if !shown && !self.options.verbose || line.word == Word::Info && self.leaves_out(1) {
            return;
        }
        self.end_line();
        let style = style(line.word);
        if line.word == Word::Progress {
            self.stream.push(&format!("{style}{}{style:#}\n", line.text()));
        } else {
            self.stream.push(&format!("{style}{}{style:#}{}\n", line.word.as_str(), line.text()));
        }
        if let Some(place) = line.place.as_ref().filter(|_| self.options.detail) {
            self.stream.push(&format!("{place}\n\n"));
        }
    }

    fn progress(&mut self, text: &str) {
        self.line(&ResultLine::progress(text.to_owned()));
    }

    /// What the plug-ins print, as it comes.
    fn printed(&mut self, output: &Output) {
        if self.leaves_out(output.text.lines().count()) {
            return;
        }
        if output.omitted_bytes > 0 {
            self.end_line();
            self.stream.push(&format!("[… {} bytes left out …]\n", output.omitted_bytes));
        }
        self.stream.push(&escape::block(&output.text));
        self.within_line = !output.text.is_empty() && !output.text.ends_with('\n');
    }

    fn end_line(&mut self) {
        if std::mem::take(&mut self.within_line) {
            self.stream.push("\n");
        }
    }
}

impl Reporter for ResultList {
    fn event(&mut self, event: &Event, record: &Record) -> Result<(), ReportError> {
        match &event.kind {
            EventKind::RunStarted(_) => self.progress("Starting test runner."),
            EventKind::Output(output) => self.printed(output),
            _ => {}
        }
        for line in lines::of(event, record) {
            self.line(&line);
        }
        if matches!(event.kind, EventKind::RunFinished { .. }) {
            self.progress("Ending test runner.");
        }
        self.stream.flush_if_long()
    }

    fn idle(&mut self, _record: &Record) -> Result<(), ReportError> {
        self.stream.flush()
    }

    fn finish(&mut self, record: &Record) -> Result<(), ReportError> {
        for line in lines::left_open(record) {
            self.line(&line);
        }
        self.report_left_out();
        self.end_line();
        if self.options.summary {
            self.stream.push(&summary::of(record, "results"));
        }
        self.stream.finish()
    }
}

fn style(word: Word) -> Style {
    let color = match word {
        Word::Progress => AnsiColor::BrightBlue,
        Word::Info => AnsiColor::BrightGreen,
        Word::Warn => AnsiColor::BrightYellow,
        Word::Fail | Word::Error => AnsiColor::BrightRed,
    };
    color.on_default()
}
