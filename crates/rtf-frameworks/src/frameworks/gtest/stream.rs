//! Reads the result stream, the marks in the output, and the properties of the JSON report.

use std::collections::{HashMap, HashSet, VecDeque};
use std::path::PathBuf;

use rtf_model::{ExitStatus, Location, MessageKind, Outcome};

use super::Report;
use crate::case::{CaseResult, ListedCase, StartedCase};
use crate::case_reporter::CaseReporter;
use crate::framework::{Garbage, ReportReader};
use crate::last_output::OutputStream;
use crate::utf8_pieces::Utf8Pieces;

const SKIPPED: &str = "[  SKIPPED ] ";
const FAILED: &str = "[  FAILED  ] ";
/// The first and the last line of a program.
const PROGRAM: &str = "[==========] ";
/// They have the same length.
const MARKS: [&str; 3] = [SKIPPED, FAILED, PROGRAM];

/// Text after a mark that is enough to contain the name of a test.
const NAME_BYTES: usize = 4096;

/// Fields of a test in the JSON report that are no properties.
const FIELDS: [&str; 8] =
    ["status", "result", "timestamp", "time", "classname", "failures", "skipped", "file"];

/// Lines of the stream that say nothing about a test.
const OTHER_EVENTS: [&str; 6] = [
    "TestProgramStart",
    "TestProgramEnd",
    "TestIterationStart",
    "TestIterationEnd",
    "TestCaseEnd",
    "TestSuiteEnd",
];

/// The reader of one process.
#[derive(Debug, Default)]
pub(super) struct Reader {
    report: PathBuf,
    /// Whether the report decides which tests were skipped, not the output.
    report_decides: bool,
    starts: HashMap<String, StartedCase>,
    /// The end of the stream that is not a whole line yet.
    line: Vec<u8>,
    /// Events that wait for the verdict of a test.
    queue: VecDeque<Event>,
    suite: String,
    running: Option<Running>,
    /// The end of standard output in which a mark may begin.
    output: String,
    /// What arrives for `output`.
    pieces: Utf8Pieces,
    /// How many programs are printing: a descendant prints its tests inside of this one.
    programs: usize,
    /// The last mark of each test: whether it was skipped.
    marks: HashMap<String, bool>,
    /// Those that a descendant seems to have printed.
    unsure_marks: HashMap<String, bool>,
    /// Tests that were reported as skipped.
    skipped: HashSet<String>,
}

#[derive(Debug)]
struct Running {
    name: String,
    /// Its results that are not reported yet: the reason of a skip, or failures.
    parts: Vec<Part>,
}

#[derive(Debug)]
struct Part {
    text: String,
    location: Option<Location>,
}

/// The text of `SUCCEED()`.
const SUCCEEDED: &str = "Succeeded";

/// A line of the stream.
#[derive(Debug)]
enum Event {
    SuiteStart(String),
    TestStart(String),
    Part(Part),
    TestEnd { passed: bool },
    Other,
}

/// What has been read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Known {
    /// The stream, but not yet what the program has printed before.
    Stream,
    /// Both.
    Output,
    /// Everything until the end of the program.
    All,
}

impl Reader {
    pub fn new(cases: &[ListedCase], report: PathBuf, report_decides: bool) -> Self {
        let starts = cases.iter().map(|case| (case.name.clone(), case.start())).collect();
        Self { report, report_decides, starts, ..Self::default() }
    }

    /// Carries out the queued events up to one whose verdict is unknown.
    fn advance(&mut self, known: Known, cases: &mut CaseReporter<'_>) {
        while !self.waits(known)
            && let Some(event) = self.queue.pop_front()
        {
            self.carry_out(event, cases);
        }
    }

    /// Whether the next event is the end of a test that has not passed, and its mark may still be
    /// missing.
    fn waits(&self, known: Known) -> bool {
        let (Some(Event::TestEnd { passed: false }), Some(running)) =
            (self.queue.front(), &self.running)
        else {
            return false;
        };
        match known {
            Known::Stream => true,
            // The program writes the mark before the next event.
            Known::Output => self.queue.len() == 1 || self.mark(&running.name).is_none(),
            Known::All => false,
        }
    }

    /// Whether a test was skipped, if that is known.
    fn mark(&self, test: &str) -> Option<bool> {
        self.marks.get(test).or_else(|| self.unsure_marks.get(test)).copied()
    }

    fn carry_out(&mut self, event: Event, cases: &mut CaseReporter<'_>) {
        match event {
            Event::SuiteStart(name) => self.suite = name,
            Event::TestStart(name) => {
                let name = format!("{}.{name}", self.suite);
                let start = self.starts.get(&name).cloned();
                let unknown = || StartedCase { name: name.clone(), ..StartedCase::default() };
                cases.start(start.unwrap_or_else(unknown));
                self.running = Some(Running { name, parts: Vec::new() });
            }
            Event::Part(part) => match &mut self.running {
                Some(running) => running.parts.push(part),
                // Of a suite's or the program's set-up or tear-down.
                None => report_failure(None, part, cases),
            },
            Event::TestEnd { passed } => self.end_test(passed, cases),
            Event::Other => {}
        }
    }

    fn end_test(&mut self, passed: bool, cases: &mut CaseReporter<'_>) {
        let Some(Running { name, parts }) = self.running.take() else { return };
        // A skipped test has not passed; one that has may have printed the mark itself.
        if !passed && self.mark(&name) == Some(true) {
            let reasons: Vec<&str> = parts.iter().map(|part| part.text.trim()).collect();
            let reason = reasons.join("\n");
            let reason = if reason.is_empty() { "skipped" } else { reason.trim() };
            cases.finish(&name, CaseResult::new(Outcome::Skipped, reason));
            self.skipped.insert(name);
            return;
        }
        // The report has the last one of several repetitions.
        self.skipped.remove(&name);
        // The stream also has the parts of `SUCCEED`, and failures that the test has removed.
        let is_failure = |part: &Part| !passed && !part.text.starts_with(SUCCEEDED);
        let has_failures = parts.iter().any(is_failure);
        for part in parts {
            if is_failure(&part) {
                report_failure(Some(&name), part, cases);
            } else {
                cases.message(Some(&name), MessageKind::Report, part.text, part.location);
            }
        }
        let result = match passed || has_failures {
            true => CaseResult::default(),
            false => CaseResult::new(Outcome::Failed, "it failed without a message"),
        };
        cases.finish(&name, result);
    }

    /// Takes from the report which tests were skipped.
    fn mark_skipped(&mut self, report: &Report) {
        for suite in &report.testsuites {
            for test in &suite.testsuite {
                let name = format!("{}.{}", suite.name, test.name);
                self.marks.insert(name, test.was_skipped());
            }
        }
    }

    /// Reports the properties, and compares the skipped tests: a test can print a mark itself.
    fn read_report(&self, report: &Report, cases: &mut CaseReporter<'_>) {
        for suite in &report.testsuites {
            for test in &suite.testsuite {
                let test_name = format!("{}.{}", suite.name, test.name);
                let was_skipped = test.was_skipped();
                if self.skipped.contains(&test_name) && !was_skipped {
                    let text =
                        format!("`{test_name}` was not skipped, as its output had suggested");
                    cases.test_error(text);
                }
                let properties =
                    test.rest.iter().filter(|(name, _)| !FIELDS.contains(&name.as_str()));
                for (name, value) in properties {
                    let value = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
                    cases.property(None, &format!("{test_name}: {name}"), &value);
                }
            }
        }
    }
}

impl ReportReader for Reader {
    fn report(&mut self, bytes: &[u8], cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        self.line.extend_from_slice(bytes);
        let Some(end) = self.line.iter().rposition(|byte| *byte == b'\n') else { return Ok(()) };
        let rest = self.line.split_off(end + 1);
        let lines = std::mem::replace(&mut self.line, rest);
        for line in lines.split(|byte| *byte == b'\n').filter(|line| !line.is_empty()) {
            self.queue.push_back(parse(&String::from_utf8_lossy(line))?);
        }
        self.advance(Known::Stream, cases);
        Ok(())
    }

    fn output(&mut self, stream: OutputStream, bytes: &[u8], _cases: &mut CaseReporter<'_>) {
        if stream == OutputStream::Stdout && !self.report_decides {
            self.pieces.append(bytes, &mut self.output);
            self.find_marks();
        }
    }

    fn settle(&mut self, cases: &mut CaseReporter<'_>) {
        if !self.report_decides {
            self.advance(Known::Output, cases);
        }
    }

    fn finish(&mut self, end: ExitStatus, cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        let text = std::fs::read(&self.report).unwrap_or_default();
        let report = serde_json::from_slice::<Report>(&text).ok();
        if let Some(report) = &report {
            self.mark_skipped(report);
        }
        // After a crash, a test without a mark has failed.
        self.advance(Known::All, cases);
        if let Some(Running { name, parts }) = self.running.take() {
            // The failures of a test that did not end.
            parts.into_iter().for_each(|part| report_failure(Some(&name), part, cases));
        }
        if let (Some(report), ExitStatus::Code(_)) = (&report, end) {
            self.read_report(report, cases);
        }
        Ok(())
    }
}

impl Reader {
    /// Finds the marks of skipped and failed tests in the output. That of a test arrives after its
    /// end. Descendants may run the same tests, and print their marks before.
    fn find_marks(&mut self) {
        let output = std::mem::take(&mut self.output);
        let mut rest = output.as_str();
        while let Some(at) = MARKS.iter().filter_map(|mark| rest.find(mark)).min() {
            let (mark, text) = (&rest[at..][..SKIPPED.len()], &rest[at + SKIPPED.len()..]);
            // After a colour.
            let text = text.strip_prefix("\u{1b}[m").unwrap_or(text);
            let ends: &[char] = if mark == PROGRAM { &['\n'] } else { &['\n', ' ', ','] };
            let Some(end) = text.find(ends) else {
                let kept = if text.len() > NAME_BYTES { "" } else { &rest[at..] };
                self.output = kept.to_owned();
                return;
            };
            if mark == PROGRAM {
                self.count_program(&text[..end]);
            } else {
                self.add_mark(&text[..end], mark == SKIPPED);
            }
            rest = &text[end..];
        }
        // A mark may be cut.
        let mut start = rest.len().saturating_sub(SKIPPED.len());
        while !rest.is_char_boundary(start) {
            start += 1;
        }
        self.output = rest[start..].to_owned();
    }

    /// A program begins or ends. A process that was forked may end inside of this program, too.
    fn count_program(&mut self, text: &str) {
        if text.starts_with("Running ") {
            self.programs += 1;
        } else if text.contains(" ran.") {
            self.programs = self.programs.saturating_sub(1).max(1);
        }
    }

    /// The last mark counts: those before are from processes that were forked from this one.
    fn add_mark(&mut self, test: &str, is_skip: bool) {
        let marks = if self.programs <= 1 { &mut self.marks } else { &mut self.unsure_marks };
        marks.insert(test.to_owned(), is_skip);
    }
}

/// Parses a line of the stream.
fn parse(line: &str) -> Result<Event, Garbage> {
    let fields: HashMap<&str, String> = line
        .split('&')
        .filter_map(|field| field.split_once('='))
        .map(|(name, value)| (name, decode(value)))
        .collect();
    let field = |name: &str| fields.get(name).cloned().unwrap_or_default();
    let event = field("event");
    Ok(match event.as_str() {
        "TestCaseStart" | "TestSuiteStart" => Event::SuiteStart(field("name")),
        "TestStart" => Event::TestStart(field("name")),
        "TestPartResult" => {
            let line = field("line").parse().unwrap_or(0);
            let file =
                Some(field("file")).filter(|file| !file.is_empty() && file != "unknown file");
            let location = file.map(|file| Location { file, line });
            Event::Part(Part { text: field("message"), location })
        }
        "TestEnd" => Event::TestEnd { passed: field("passed") == "1" },
        other if OTHER_EVENTS.contains(&other) => Event::Other,
        "" if line.starts_with("gtest_streaming_protocol_version=") => Event::Other,
        _ => {
            let start: String = line.chars().take(200).collect();
            return Err(Garbage(format!("`{start}` is no line of GoogleTest's result stream")));
        }
    })
}

/// Decodes `%3D`.
fn decode(text: &str) -> String {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&byte, after)) = rest.split_first() {
        let code = after.get(..2).and_then(|code| std::str::from_utf8(code).ok());
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()) {
            Some(decoded) if byte == b'%' => {
                bytes.push(decoded);
                rest = &after[2..];
            }
            _ => {
                bytes.push(byte);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Reports a failure; an exception is an error.
fn report_failure(case: Option<&str>, part: Part, cases: &mut CaseReporter<'_>) {
    let is_exception = part.location.is_none()
        && (part.text.starts_with("C++ exception")
            || part.text.starts_with("Unknown C++ exception"));
    let kind = if is_exception { MessageKind::Error } else { MessageKind::Failure };
    cases.message(case, kind, part.text.trim_end(), part.location);
}
