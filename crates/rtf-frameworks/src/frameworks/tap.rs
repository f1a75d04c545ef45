//! TAP: any program that prints the Test Anything Protocol, versions 12 to 14.
//!
//! A test line arrives when its test has ended, so only subtests that a comment announces
//! are open while they run.

mod diagnostics;
mod line;
mod parser;
mod perl;

use std::collections::HashMap;

use rtf_model::{Comparison, ExitStatus, Location, Measurement, Message, MessageKind, Outcome};

use crate::case::{CaseResult, StartedCase};
use crate::case_reporter::CaseReporter;
use crate::framework::{Framework, Garbage, Launch, ReportChannel, ReportReader};
use crate::last_output::OutputStream;
use diagnostics::Diagnostics;
use line::Directive;
use parser::{ReportedPoint, TapEvent, TapParser};
use perl::PerlDiagnostics;

/// The longest line that is read, in bytes.
const LINE_BYTES: usize = 16 << 20;

/// The longest line that a message quotes, in characters.
const QUOTED_CHARS: usize = 200;

/// The part of a line of standard error that is kept: enough for [`QUOTED_CHARS`].
const ERROR_LINE_BYTES: usize = 4096;

#[derive(Clone, Copy, Debug)]
pub struct Tap;

impl Framework for Tap {
    fn channel(&self) -> ReportChannel {
        ReportChannel::Stdout
    }

    fn watches_output(&self, _launch: &Launch<'_>) -> bool {
        true
    }

    fn reader(&self, launch: &Launch<'_>) -> Box<dyn ReportReader> {
        let perl = perl::is_perl(&launch.test.file).then(PerlDiagnostics::default);
        Box::new(TapReader { perl, ..TapReader::default() })
    }

    fn accepts_exit(&self, _code: i32, _has_problem: bool) -> bool {
        // The reader checks it.
        true
    }
}

/// Reads the standard output of a program.
#[derive(Default)]
struct TapReader {
    parser: TapParser,
    line: Vec<u8>,
    perl: Option<PerlDiagnostics>,
    /// The open subtests, the innermost last.
    open: Vec<OpenSubtest>,
    /// How often a name occurred at the top level.
    names: HashMap<String, u32>,
    skip_reason: Option<String>,
    bail_out: Option<String>,
    has_problem: bool,
    has_ended: bool,
    first_line: Option<String>,
    /// The last line of standard error that is no comment.
    last_error: String,
    /// The part of a line of standard error that has arrived.
    error_line: Vec<u8>,
}

struct OpenSubtest {
    path: String,
    names: HashMap<String, u32>,
}

impl ReportReader for TapReader {
    fn report(&mut self, bytes: &[u8], cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        for piece in bytes.split_inclusive(|byte| *byte == b'\n') {
            self.line.extend(piece);
            if self.line.ends_with(b"\n") {
                self.read_line(cases);
            } else if self.line.len() > LINE_BYTES {
                return Err(Garbage("a line is longer than 16 MiB".to_owned()));
            }
        }
        Ok(())
    }

    fn output(&mut self, stream: OutputStream, bytes: &[u8], cases: &mut CaseReporter<'_>) {
        if stream == OutputStream::Stdout {
            return;
        }
        let mut lines = bytes.split(|byte| *byte == b'\n').peekable();
        while let Some(line) = lines.next() {
            let room = ERROR_LINE_BYTES.saturating_sub(self.error_line.len());
            self.error_line.extend_from_slice(&line[..line.len().min(room)]);
            if lines.peek().is_some() {
                self.end_error_line();
            }
        }
        if let Some(perl) = &mut self.perl {
            let events = perl.read(bytes);
            self.handle(events, cases);
        }
    }

    fn finish(&mut self, end: ExitStatus, cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        let was_killed = matches!(end, ExitStatus::Signal(_));
        if was_killed {
            // The last line may be incomplete.
            cases.output(&std::mem::take(&mut self.line));
        } else if !self.line.is_empty() {
            self.read_line(cases);
        }
        self.end_error_line();
        self.has_ended = true;
        let events = self.parser.finish(!was_killed);
        self.add(events, cases);
        if let Some(mut perl) = self.perl.take() {
            let events = perl.finish();
            self.handle(events, cases);
        }
        if let Some(reason) = &self.bail_out {
            let text = format!("the program bailed out: {reason}");
            cases.end_open(&CaseResult::new(Outcome::Error, text.clone()));
            cases.test_error(text);
        }
        if let ExitStatus::Code(code) = end {
            self.check_end(code, cases);
        }
        Ok(())
    }
}

impl TapReader {
    /// A line of standard error is complete.
    fn end_error_line(&mut self) {
        let bytes = std::mem::take(&mut self.error_line);
        let line = String::from_utf8_lossy(&bytes);
        if !line.trim().is_empty() && !line.trim_start().starts_with('#') {
            self.last_error = line.trim().chars().take(QUOTED_CHARS).collect();
        }
    }

    fn read_line(&mut self, cases: &mut CaseReporter<'_>) {
        let bytes = std::mem::take(&mut self.line);
        let text = String::from_utf8_lossy(&bytes);
        let text = text.trim_end_matches(['\n', '\r']);
        if self.first_line.is_none() && !text.trim().is_empty() {
            self.first_line = Some(text.chars().take(QUOTED_CHARS).collect());
        }
        let mut events = self.parser.line(text);
        if events.contains(&TapEvent::Output) {
            events.retain(|event| *event != TapEvent::Output);
            cases.output(&bytes);
        }
        self.add(events, cases);
    }

    fn add(&mut self, events: Vec<TapEvent>, cases: &mut CaseReporter<'_>) {
        let Some(perl) = &mut self.perl else { return self.handle(events, cases) };
        let events = events.into_iter().flat_map(|event| perl.add(event)).collect();
        self.handle(events, cases);
    }

    fn handle(&mut self, events: Vec<TapEvent>, cases: &mut CaseReporter<'_>) {
        for event in events {
            match event {
                TapEvent::Opened(name) => self.open(name, cases),
                TapEvent::Point(reported) => {
                    self.open(name_of(&reported), cases);
                    self.close(reported, false, cases);
                }
                TapEvent::Closed(reported) => self.close(reported, true, cases),
                TapEvent::Problem(mut text) => {
                    self.has_problem = true;
                    // Why the rest of the plan is missing.
                    if self.has_ended && !self.last_error.is_empty() {
                        text = format!("{text}: {}", self.last_error);
                    }
                    cases.message(None, MessageKind::Error, text, None);
                }
                TapEvent::SkippedAll(reason) => self.skip_reason = Some(reason),
                TapEvent::BailOut(reason) => self.bail_out = Some(reason),
                TapEvent::Output => {}
            }
        }
    }

    fn open(&mut self, name: String, cases: &mut CaseReporter<'_>) {
        let names = self.open.last_mut().map_or(&mut self.names, |open| &mut open.names);
        let count = names.entry(name.clone()).or_default();
        *count += 1;
        // Descriptions need not be unique.
        let name = if *count == 1 { name } else { format!("{name}#{count}") };
        let start = StartedCase { name: name.clone(), ..StartedCase::default() };
        let outer = self.open.last().map(|outer| outer.path.as_str());
        let path = outer.map_or(name.clone(), |outer| format!("{outer}/{name}"));
        cases.start_case(outer, start);
        self.open.push(OpenSubtest { path, names: HashMap::new() });
    }

    fn close(&mut self, reported: ReportedPoint, is_subtest: bool, cases: &mut CaseReporter<'_>) {
        let Some(OpenSubtest { path, .. }) = self.open.pop() else { return };
        let ReportedPoint { point, yaml, comments, .. } = reported;
        let found = match yaml.is_empty() {
            false => Diagnostics::from_yaml(&yaml),
            true => Diagnostics::from_comments(&comments),
        };
        if let Some(duration) = found.duration {
            cases.measure(Some(&path), milliseconds(duration));
        }
        let skipped = |reason: &str| CaseResult::new(Outcome::Skipped, reason);
        let (kind, result) = match (point.ok, point.directive) {
            (_, Some(Directive::Skip(reason))) => {
                (MessageKind::Report, skipped(if reason.is_empty() { "skipped" } else { &reason }))
            }
            (false, Some(Directive::Todo(reason))) => (
                MessageKind::Report,
                skipped(format!("expected failure: {reason}").trim_end_matches([' ', ':'])),
            ),
            (true, Some(Directive::Todo(reason))) => {
                let text = format!("the test passed although it is marked TODO: {reason}");
                let text = text.trim_end_matches([' ', ':']);
                cases.message(Some(&path), MessageKind::Report, text, None);
                (MessageKind::Report, CaseResult::default())
            }
            (true, None) => (MessageKind::Report, CaseResult::default()),
            // The reason of a subtest is that of a test in it.
            (false, None) if is_subtest && found.message.is_none() => {
                let result = CaseResult::new(Outcome::Failed, "the subtest failed");
                (MessageKind::Report, result)
            }
            (false, None) => (MessageKind::Failure, CaseResult::default()),
        };
        report(found, kind, &path, cases);
        cases.finish(&path, result);
    }

    fn check_end(&self, code: i32, cases: &mut CaseReporter<'_>) {
        let error = |text: String| match self.last_error.as_str() {
            "" => text,
            line => format!("{text}: {line}"),
        };
        if !self.parser.has_tap() {
            let first = match &self.first_line {
                Some(line) => format!("; its first line is `{line}`"),
                None => String::new(),
            };
            cases.test_error(error(format!(
                "the program printed no TAP and ended with exit code {code}{first}"
            )));
        } else if let (Some(reason), 0, 0) = (&self.skip_reason, code, cases.finished()) {
            cases.skip_test(if reason.is_empty() { "the plan is 1..0" } else { reason });
        } else if code != 0 && !cases.has_problem() && !self.has_problem && self.bail_out.is_none()
        {
            cases.test_error(error(format!(
                "the program ended with exit code {code} although no test line is `not ok`"
            )));
        }
    }
}

fn name_of(reported: &ReportedPoint) -> String {
    let ReportedPoint { point, position, .. } = reported;
    match point.description.as_str() {
        "" => format!("test {}", point.number.unwrap_or(*position)),
        description => description.to_owned(),
    }
}

/// Reports diagnostics: the problem of a failed test, or a report.
fn report(found: Diagnostics, kind: MessageKind, path: &str, cases: &mut CaseReporter<'_>) {
    let Diagnostics { message, expected, actual, location, other, .. } = found;
    let location = location.map(|(file, line)| Location { file, line });
    let is_failure = kind == MessageKind::Failure;
    let comparison = comparison(expected.as_deref(), actual.as_deref());
    let mut lines: Vec<String> = message.into_iter().collect();
    let labelled = [("expected", expected), ("actual", actual)];
    let labelled = labelled.into_iter().filter_map(|(label, text)| Some((label, text?)));
    lines.extend(labelled.map(|(label, text)| entry(label, &text)));
    if lines.is_empty() && is_failure {
        lines.push("not ok".to_owned());
    }
    if !lines.is_empty() {
        let text = lines.join("\n");
        let comparison = comparison.filter(|_| is_failure);
        let message = Message { comparison, ..Message::new(kind, text, location) };
        cases.full_message(Some(path), message);
    }
    for (key, text) in other {
        cases.message(Some(path), MessageKind::Report, entry(&key, &text), None);
    }
}

fn entry(label: &str, text: &str) -> String {
    let separator = if text.contains('\n') { "\n" } else { " " };
    format!("{label}:{separator}{text}")
}

/// A comparison of two numbers.
fn comparison(expected: Option<&str>, actual: Option<&str>) -> Option<Comparison> {
    let number = |text: &str| text.trim().trim_matches('\'').parse::<f64>().ok();
    let (expected, got) = (number(expected?)?, number(actual?)?);
    let finite = |number: f64| vec![Some(number).filter(|number| number.is_finite())];
    let (expected, got) = (finite(expected), finite(got));
    Some(Comparison { expected, got, tolerance: 0.0, worst: None })
}

fn milliseconds(value: f64) -> Measurement {
    Measurement {
        name: "duration".to_owned(),
        value: Some(value),
        unit: "ms".to_owned(),
        ..Measurement::default()
    }
}
