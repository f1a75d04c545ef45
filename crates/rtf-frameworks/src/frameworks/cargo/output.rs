//! The output of a test program that runs one test: `test NAME ... `, then everything that
//! the test prints, then `ok` and a summary.

use std::path::{Path, PathBuf};

use rtf_model::{ExitStatus, Location, MessageKind, Outcome};

use crate::case::CaseResult;
use crate::case_reporter::CaseReporter;
use crate::framework::{Garbage, ReportReader};
use crate::last_output::OutputStream;
use crate::utf8_pieces::Utf8Pieces;

/// How the summary begins. A test can print that, too: the last one counts.
const SUMMARIES: [&str; 2] = ["ok\n\ntest result: ", "FAILED\n\nfailures:\n"];

/// How much of standard error is kept for the reason of a failure.
const ERROR_BYTES: usize = 1024 * 1024;

/// What separates the name of the test from its output.
const SEPARATOR: &str = " ... ";

/// The longest text after the name of the test, with the separator: ` - should panic ... `.
const HEADER_BYTES: usize = 100;

/// A panic, as the standard library prints it.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Panic {
    thread: String,
    location: Location,
    text: String,
}

/// Reads the output of one process.
#[derive(Debug, Default)]
pub(super) struct Reader {
    case: String,
    test: String,
    workspace: PathBuf,
    /// Whether the output of the test has begun.
    has_begun: bool,
    /// Output that can belong to the summary.
    held: String,
    /// What arrives for `held`.
    pieces: Utf8Pieces,
    errors: String,
    /// What arrives for `errors`.
    error_pieces: Utf8Pieces,
    crash: Option<String>,
}

impl Reader {
    pub fn new(case: &str, test: &str, workspace: &Path) -> Self {
        Self {
            case: case.to_owned(),
            test: test.to_owned(),
            workspace: workspace.to_owned(),
            ..Self::default()
        }
    }

    /// Removes `running 1 test` and `test NAME ... `.
    fn skip_header(&mut self) {
        let header = format!("\nrunning 1 test\ntest {}", self.test);
        let is_possible = header.starts_with(&*self.held) || self.held.starts_with(&header);
        let longest = header.len() + HEADER_BYTES;
        let separator = self.held.get(header.len()..).and_then(|rest| rest.find(SEPARATOR));
        let end = separator.map(|start| header.len() + start + SEPARATOR.len());
        match end.filter(|end| is_possible && *end <= longest) {
            Some(end) => {
                self.held.drain(..end);
                self.has_begun = true;
            }
            None => self.has_begun = !is_possible || self.held.len() >= longest,
        }
    }

    /// Passes on output that cannot belong to the summary.
    fn pass_on(&mut self, cases: &mut CaseReporter<'_>) {
        let complete = SUMMARIES.iter().filter_map(|start| self.held.find(start)).min();
        let end = complete.unwrap_or_else(|| {
            let longest = SUMMARIES.iter().map(|start| overlap(&self.held, start)).max();
            self.held.len() - longest.unwrap_or(0)
        });
        cases.output(&self.held.as_bytes()[..end]);
        self.held.drain(..end);
    }

    /// Reports why the test failed.
    fn report_failure(&self, summary: &str, cases: &mut CaseReporter<'_>) {
        let note = note(summary, &self.test);
        let mut panics = panics(&self.errors, &self.workspace);
        let own = panics.iter().rposition(|panic| panic.thread == self.test);
        let last = own.or(panics.len().checked_sub(1)).map(|at| panics.remove(at));
        for panic in panics {
            let (text, location) = (panic.text, Some(panic.location));
            cases.message(Some(&self.case), MessageKind::Report, text, location);
        }
        let returned = self.errors.lines().rfind(|line| line.starts_with("Error: "));
        let (text, location) = match (last, &note) {
            (Some(panic), None) => (panic.text, Some(panic.location)),
            (Some(panic), Some(note)) => (format!("{note}\n{}", panic.text), Some(panic.location)),
            (None, Some(note)) => (note.clone(), note_location(note, &self.workspace)),
            (None, None) => (returned.unwrap_or("it failed without a message").to_owned(), None),
        };
        cases.message(Some(&self.case), MessageKind::Failure, text, location);
    }

    /// Reports the panics of a process that died.
    fn report_crash(&mut self, cases: &mut CaseReporter<'_>) {
        for panic in panics(&self.errors, &self.workspace) {
            let (text, location) = (panic.text, Some(panic.location));
            self.crash = Some(text.clone());
            cases.message(Some(&self.case), MessageKind::Error, text, location);
        }
    }
}

impl ReportReader for Reader {
    fn report(&mut self, bytes: &[u8], cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        self.pieces.append(bytes, &mut self.held);
        if !self.has_begun {
            self.skip_header();
        }
        if self.has_begun {
            self.pass_on(cases);
        }
        Ok(())
    }

    fn output(&mut self, stream: OutputStream, bytes: &[u8], _cases: &mut CaseReporter<'_>) {
        if stream == OutputStream::Stderr && self.errors.len() < ERROR_BYTES {
            self.error_pieces.append(bytes, &mut self.errors);
        }
    }

    fn finish(&mut self, end: ExitStatus, cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        self.pieces.finish(&mut self.held);
        self.error_pieces.finish(&mut self.errors);
        let start = SUMMARIES.iter().filter_map(|start| self.held.rfind(start)).max();
        let summary = self.held.split_off(start.unwrap_or(self.held.len()));
        cases.output(self.held.as_bytes());
        let has = |text: &str| summary.contains(text);
        if end == ExitStatus::Code(0) && has("test result: ok. 1 passed;") {
            cases.finish(&self.case, CaseResult::default());
        } else if end == ExitStatus::Code(101) && has("test result: FAILED. ") {
            self.report_failure(&summary, cases);
            cases.finish(&self.case, CaseResult::new(Outcome::Failed, "it failed"));
        } else {
            // Without a result, the process ended in the test.
            self.report_crash(cases);
        }
        Ok(())
    }

    fn crash_reason(&self) -> Option<String> {
        self.crash.clone()
    }
}

/// The length of the longest end of `text` that `start` begins with.
fn overlap(text: &str, start: &str) -> usize {
    (0..start.len()).rev().find(|length| text.ends_with(&start[..*length])).unwrap_or(0)
}

/// Text about the test in the summary: a test did not panic as expected.
fn note(summary: &str, test: &str) -> Option<String> {
    let (_, rest) = summary.split_once(&format!("---- {test} stdout ----\n"))?;
    let (note, _) = rest.split_once("\n\nfailures:\n")?;
    let note = note.trim();
    Some(note.strip_prefix("note: ").unwrap_or(note).to_owned())
}

/// `… at tests/arm.rs:12:4`.
fn note_location(note: &str, workspace: &Path) -> Option<Location> {
    let place = note.lines().next()?.rsplit_once(" at ")?.1;
    location(place, workspace)
}

/// The panics in standard error: `thread 'NAME' (ID) panicked at FILE:LINE:COLUMN:`, and
/// their texts in the next lines.
fn panics(errors: &str, workspace: &Path) -> Vec<Panic> {
    let mut panics = Vec::new();
    let mut lines = errors.lines().peekable();
    while let Some(line) = lines.next() {
        let Some((thread, location)) = panic_start(line, workspace) else { continue };
        let mut text = Vec::new();
        while let Some(line) = lines.next_if(|line| !is_end(line)) {
            text.push(line);
        }
        let text = text.join("\n").trim().to_owned();
        panics.push(Panic { thread, location, text });
    }
    panics
}

fn panic_start(line: &str, workspace: &Path) -> Option<(String, Location)> {
    let (thread, place) = line.strip_prefix("thread '")?.split_once(" panicked at ")?;
    let (thread, _) = thread.rsplit_once('\'')?;
    Some((thread.to_owned(), location(place.strip_suffix(':')?, workspace)?))
}

fn is_end(line: &str) -> bool {
    line == "stack backtrace:"
        || line.starts_with("note: run with `RUST_BACKTRACE")
        || (line.starts_with("thread '") && line.contains(" panicked at "))
}

fn location(place: &str, workspace: &Path) -> Option<Location> {
    let (place, _column) = place.rsplit_once(':')?;
    let (file, line) = place.rsplit_once(':')?;
    let absolute = workspace.join(file);
    let file =
        if absolute.is_file() { absolute.to_string_lossy().into_owned() } else { file.to_owned() };
    Some(Location { file, line: line.parse().ok()? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_has_its_thread_place_and_text() {
        let errors = "printed\nthread 'arm::fails' (12) panicked at tests/arm.rs:10:5:\nthe elbow\nis off\nstack backtrace:\n   0: x\nthread '<unnamed>' panicked at src/lib.rs:3:1:\nlost\nnote: run with `RUST_BACKTRACE=1`\n";
        let panic = |thread: &str, file: &str, line, text: &str| Panic {
            thread: thread.to_owned(),
            location: Location { file: file.to_owned(), line },
            text: text.to_owned(),
        };
        let expected = [
            panic("arm::fails", "tests/arm.rs", 10, "the elbow\nis off"),
            panic("<unnamed>", "src/lib.rs", 3, "lost"),
        ];
        assert_eq!(panics(errors, Path::new("/no/such/workspace")), expected);
    }

    #[test]
    fn an_overlap_is_the_longest_possible_start() {
        assert_eq!(overlap("looks ok\n", SUMMARIES[0]), 3);
        assert_eq!(overlap("looks good", SUMMARIES[0]), 0);
    }
}
