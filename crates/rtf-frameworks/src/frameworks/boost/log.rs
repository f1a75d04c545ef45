//! Reads the XML log of a process that runs one case, and its XML report.

use std::path::PathBuf;

use rtf_model::{Comparison, ExitStatus, Location, Message, MessageKind, Outcome};

use super::super::assertion;
use crate::case::CaseResult;
use crate::case_reporter::CaseReporter;
use crate::framework::{Garbage, ReportReader};
use crate::xml_report::XmlReport;
use crate::xml_stream::{Attributes, XmlEvent};

const LOG: &str = "TestLog";
const REPORT: &str = "TestResult";

/// Texts with which exceptions begin that are signals.
const SIGNALS: [&str; 2] = ["signal:", "memory access violation"];

/// A message after a signal.
const ABORTED: &str = "Test is aborted";

/// The reader of one process.
#[derive(Debug, Default)]
pub(super) struct Reader {
    log: XmlReport,
    case: String,
    report: PathBuf,
    /// The suites and the case of the log in which it is; the first is the program itself.
    path: Vec<String>,
    /// The messages, which may be expected failures: the report contains the verdict.
    messages: Vec<Message>,
    /// Failures of global fixtures and of fixtures of suites around the case.
    fixture_failures: Vec<Message>,
    entry: Entry,
    /// Whether the case was run: the report calls it passed if a fixture failed before.
    has_run: bool,
    skipped: Option<String>,
    /// The signal that ended the case.
    signal: Option<String>,
}

/// An entry of the log whose element is open.
#[derive(Debug, Default)]
struct Entry {
    location: Option<Location>,
    frames: Vec<String>,
    checkpoint: Option<String>,
}

/// The verdict of the case in the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    Passed,
    Skipped,
    Other,
}

impl Reader {
    pub fn new(case: String, report: PathBuf) -> Self {
        Self { log: XmlReport::new(LOG), case, report, ..Self::default() }
    }

    fn start(&mut self, name: &str, attributes: &Attributes) {
        match name {
            "TestSuite" | "TestCase" => {
                self.path.push(attributes.get("name").to_owned());
                let is_skipped = attributes.get("skipped") == "yes";
                if is_skipped && (self.is_in_case() || self.is_around_case()) {
                    self.skipped = Some(attributes.get("reason").to_owned());
                }
                self.has_run |= self.is_in_case() && !is_skipped;
            }
            "Info" | "Message" | "Warning" | "Error" | "FatalError" | "Exception" => {
                let location = assertion::location(attributes, "file");
                // Line 0 stands for an unknown location.
                let location = location.filter(|location| location.line > 0);
                self.entry = Entry { location, ..Entry::default() };
            }
            "LastCheckpoint" if self.entry.location.is_none() => {
                self.entry.location = assertion::location(attributes, "file");
            }
            _ => {}
        }
    }

    fn end(&mut self, name: &str, text: &str) {
        let text = text.trim();
        let kind = match name {
            "TestSuite" | "TestCase" => {
                self.path.pop();
                return;
            }
            "Frame" => return self.entry.frames.push(text.to_owned()),
            "LastCheckpoint" => {
                self.entry.checkpoint = Some(text.to_owned()).filter(|text| !text.is_empty());
                return;
            }
            "Info" => MessageKind::Check,
            "Message" | "Warning" => MessageKind::Report,
            "Error" | "FatalError" => MessageKind::Failure,
            "Exception" => MessageKind::Error,
            _ => return,
        };
        let Entry { location, frames, checkpoint } = std::mem::take(&mut self.entry);
        let is_fixture = self.is_around_case();
        let is_other = !self.is_in_case() && !is_fixture;
        if is_other || (is_fixture && text == ABORTED) {
            // Of other cases, on which the case depends, or repeated for each suite.
            return;
        }
        if name == "Exception" && SIGNALS.iter().any(|signal| text.starts_with(signal)) {
            self.signal = Some(text.to_owned());
        }
        let checkpoint = checkpoint.map(|text| format!("last checkpoint: {text}"));
        let lines: Vec<String> = frames.into_iter().chain(checkpoint).collect();
        let text = assertion::with_lines(text.to_owned(), &lines);
        let mut message = assertion::message(kind, &text, location);
        message.comparison = comparison(&message.text);
        match kind {
            MessageKind::Failure | MessageKind::Error if is_fixture => {
                self.fixture_failures.push(message);
            }
            _ => self.messages.push(message),
        }
    }

    /// The path of the present suite or case.
    fn present(&self) -> String {
        self.path.get(1..).unwrap_or_default().join("/")
    }

    fn is_in_case(&self) -> bool {
        self.present() == self.case
    }

    /// Whether it is in a suite around the case, or in the program itself.
    fn is_around_case(&self) -> bool {
        let present = self.present();
        present.is_empty() || self.case.starts_with(&format!("{present}/"))
    }

    /// The verdict in the report; `None` if there is no complete report.
    fn verdict(&self) -> Option<Verdict> {
        let text = std::fs::read(&self.report).ok()?;
        let events = XmlReport::parse(REPORT, &text)?;
        let mut path: Vec<&str> = Vec::new();
        let mut verdict = None;
        for event in &events {
            match event {
                XmlEvent::Start { name, attributes } if is_unit(name) => {
                    path.push(attributes.get("name"));
                    if path.get(1..).unwrap_or_default().join("/") == self.case {
                        verdict = Some(match attributes.get("result") {
                            "passed" => Verdict::Passed,
                            "skipped" => Verdict::Skipped,
                            _ => Verdict::Other,
                        });
                    }
                }
                XmlEvent::End { name, .. } if is_unit(name) => {
                    path.pop();
                }
                _ => {}
            }
        }
        verdict
    }

    fn result(&self, verdict: Verdict, has_failure: bool) -> CaseResult {
        if let Some(signal) = &self.signal {
            return CaseResult::new(Outcome::Crashed, signal);
        }
        match verdict {
            _ if has_failure => CaseResult::default(),
            Verdict::Passed if self.has_run => CaseResult::default(),
            Verdict::Passed => CaseResult::new(Outcome::Error, "the case was not run"),
            Verdict::Skipped => {
                let reason = self.skipped.as_deref().filter(|reason| !reason.is_empty());
                CaseResult::new(Outcome::Skipped, reason.unwrap_or("skipped"))
            }
            Verdict::Other => CaseResult::new(Outcome::Failed, "it failed without a message"),
        }
    }
}

impl ReportReader for Reader {
    fn report(&mut self, bytes: &[u8], _cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        let (events, result) = self.log.feed(bytes);
        for event in events {
            match event {
                XmlEvent::Start { name, attributes } => self.start(&name, &attributes),
                XmlEvent::End { name, text } => self.end(&name, &text),
            }
        }
        result
    }

    fn finish(&mut self, end: ExitStatus, cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        let verdict = self.verdict().filter(|_| self.log.is_complete());
        let mut has_failure = !self.fixture_failures.is_empty();
        for message in std::mem::take(&mut self.fixture_failures) {
            cases.full_message(Some(&self.case), message);
        }
        for mut message in std::mem::take(&mut self.messages) {
            if matches!(message.kind, MessageKind::Failure | MessageKind::Error) {
                match verdict {
                    Some(Verdict::Passed) => assertion::tolerate(&mut message),
                    _ => has_failure = true,
                }
            }
            cases.full_message(Some(&self.case), message);
        }
        // Without a verdict, the program ended in the case.
        let Some(verdict) = verdict else { return Ok(()) };
        let result = self.result(verdict, has_failure);
        let is_bad = has_failure || self.signal.is_some();
        cases.finish(&self.case, result);
        // A skipped case may depend on one that failed.
        if let ExitStatus::Code(code) = end
            && code != 0
            && !is_bad
            && verdict == Verdict::Passed
        {
            let case = &self.case;
            cases.test_error(format!("the program ended with {end} although `{case}` passed"));
        }
        Ok(())
    }
}

fn is_unit(name: &str) -> bool {
    matches!(name, "TestSuite" | "TestCase")
}

/// The numbers of `check position == 42 has failed [41 != 42]`.
fn comparison(text: &str) -> Option<Comparison> {
    let (check, numbers) = text.lines().next()?.split_once(" has failed [")?;
    let (got, expected) = numbers.strip_suffix(']')?.split_once(" != ")?;
    check.contains(" == ").then(|| assertion::comparison(&format!("{got} == {expected}"))).flatten()
}

#[cfg(test)]
mod tests;
