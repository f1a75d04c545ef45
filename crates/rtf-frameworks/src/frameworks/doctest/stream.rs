//! Reads the XML report.

use rtf_model::{ExitStatus, Location, Message, MessageKind, Outcome};

use super::super::assertion::{self, RunningCases};
use super::super::expression::Expression;
use super::super::sections::Sections;
use crate::case::{CaseResult, ListedCase};
use crate::case_reporter::CaseReporter;
use crate::framework::{Garbage, ReportReader};
use crate::xml_report::XmlReport;
use crate::xml_stream::{Attributes, XmlEvent};

const ROOT: &str = "doctest";

/// The name of a test case without a name.
pub(super) const UNNAMED: &str = "(no name)";

/// The reader of one process.
#[derive(Debug, Default)]
pub(super) struct Reader {
    report: XmlReport,
    running: RunningCases,
    case: Option<RunningCase>,
    /// Whether the reported case is another one of the same name.
    is_ignored: bool,
    /// The open check or message.
    check: Expression,
    /// Whether the reported exception is a fatal signal.
    is_crash: bool,
}

/// The running test case.
#[derive(Debug, Default)]
struct RunningCase {
    sections: Sections,
    may_fail: bool,
    should_fail: bool,
    /// Failures outside of subcases, which may be expected: their number is reported at the end.
    held: Vec<Message>,
    has_failure: bool,
    is_success: bool,
    expected_failures: String,
    /// A fatal signal was reported: the process dies.
    has_died: bool,
}

/// The name of a test case.
pub(super) fn case_name(attributes: &Attributes) -> String {
    match attributes.get("name") {
        "" => UNNAMED.to_owned(),
        name => name.to_owned(),
    }
}

impl Reader {
    pub fn new(cases: &[ListedCase]) -> Self {
        Self { report: XmlReport::new(ROOT), running: RunningCases::new(cases), ..Self::default() }
    }

    fn start(&mut self, name: &str, attributes: &Attributes, cases: &mut CaseReporter<'_>) {
        let location = assertion::location(attributes, "filename");
        match name {
            // Other cases are listed as skipped.
            "TestCase" if attributes.get("skipped") != "true" => {
                self.start_case(attributes, location, cases);
            }
            "SubCase" => {
                if let Some(case) = self.living() {
                    case.sections.enter(attributes.get("name"), location, cases);
                }
            }
            "Expression" | "Message" => {
                self.check = Expression::begin(attributes, location, Vec::new());
            }
            "Exception" => self.is_crash = attributes.get("crash") == "true",
            "OverallResultsAsserts" => {
                if let Some(case) = &mut self.case {
                    case.is_success = attributes.get("test_case_success") == "true";
                    attributes.get("expected_failures").clone_into(&mut case.expected_failures);
                }
            }
            _ => {}
        }
    }

    fn end(&mut self, name: &str, text: &str, cases: &mut CaseReporter<'_>) {
        let text = text.trim();
        if self.check.take_text(name, text) {
            return;
        }
        match name {
            "TestCase" => self.end_case(cases),
            "SubCase" => {
                if let Some(case) = self.living() {
                    case.sections.leave(CaseResult::default(), cases);
                }
            }
            "Text" => text.clone_into(&mut self.check.original),
            "ExpectedException" => self.check.infos.push(format!("expected: {text}")),
            "ExpectedExceptionString" => {
                self.check.infos.push(format!("expected text: {text}"));
            }
            "Exception" => self.exception(text, cases),
            "Expression" => self.end_check(cases),
            "Message" => self.end_message(cases),
            _ => {}
        }
    }

    /// The running case, unless its process is dying: doctest then closes all elements.
    fn living(&mut self) -> Option<&mut RunningCase> {
        self.case.as_mut().filter(|case| !case.has_died)
    }

    fn start_case(
        &mut self,
        attributes: &Attributes,
        location: Option<Location>,
        cases: &mut CaseReporter<'_>,
    ) {
        let start = self.running.start(&case_name(attributes), location);
        self.is_ignored = start.is_none();
        let Some(start) = start else { return };
        let is_set = |name: &str| attributes.get(name) == "true";
        self.case = Some(RunningCase {
            sections: Sections::start_case(start, cases),
            may_fail: is_set("may_fail"),
            should_fail: is_set("should_fail"),
            ..RunningCase::default()
        });
        let description = attributes.get("description");
        if !description.is_empty() {
            cases.message(None, MessageKind::Report, format!("description: {description}"), None);
        }
    }

    fn end_case(&mut self, cases: &mut CaseReporter<'_>) {
        if self.living().is_none() {
            return;
        }
        let Some(mut case) = self.case.take() else { return };
        let failures = case.held.len();
        case.report_held(cases);
        let result = if case.is_success || case.has_failure {
            CaseResult::default()
        } else {
            let expected = &case.expected_failures;
            let reason = match (case.should_fail, expected.is_empty()) {
                (true, _) => "it passed, although it is decorated with `should_fail`".to_owned(),
                (false, false) => format!("{failures} of {expected} expected failures occurred"),
                (false, true) => {
                    "it failed without a message, for example because of its `timeout`".to_owned()
                }
            };
            CaseResult::new(Outcome::Failed, reason)
        };
        case.sections.finish_case(result, cases);
    }

    fn end_check(&mut self, cases: &mut CaseReporter<'_>) {
        let check = std::mem::take(&mut self.check);
        let is_warning = check.kind.starts_with("WARN");
        let mut message = check.message();
        if is_warning && message.kind != MessageKind::Check {
            message.kind = MessageKind::Report;
        }
        self.report_message(message, cases);
    }

    /// `MESSAGE`, `FAIL` or `FAIL_CHECK`.
    fn end_message(&mut self, cases: &mut CaseReporter<'_>) {
        let Expression { kind, location, original, infos, .. } = std::mem::take(&mut self.check);
        let message_kind = match kind.as_str() {
            "WARNING" => MessageKind::Report,
            _ => MessageKind::Failure,
        };
        let text = assertion::with_lines(original, &infos);
        self.report_message(assertion::message(message_kind, &text, location), cases);
    }

    /// An exception that no check caught, or a fatal signal.
    fn exception(&mut self, text: &str, cases: &mut CaseReporter<'_>) {
        let is_crash = std::mem::take(&mut self.is_crash);
        let text = match (is_crash, text) {
            (true, text) => text.to_owned(),
            (false, "") => "exception of an unknown type".to_owned(),
            (false, text) => format!("exception: {text}"),
        };
        self.report_message(assertion::message(MessageKind::Error, &text, None), cases);
        if let Some(case) = &mut self.case {
            case.has_died |= is_crash;
        }
    }

    /// Reports a message. Failures of a case that may or should fail do not change its verdict.
    fn report_message(&mut self, mut message: Message, cases: &mut CaseReporter<'_>) {
        if self.is_ignored {
            return;
        }
        let Some(case) = self.living() else {
            return cases.full_message(None, message);
        };
        if !matches!(message.kind, MessageKind::Failure | MessageKind::Error) {
            return cases.full_message(Some(case.sections.path()), message);
        }
        if case.may_fail || case.should_fail {
            assertion::tolerate(&mut message);
        } else if case.sections.is_inside() {
            case.has_failure = true;
        } else {
            case.held.push(message);
            return;
        }
        cases.full_message(Some(case.sections.path()), message);
    }
}

impl RunningCase {
    /// Reports the held failures: tolerated ones if the case is a success nevertheless, or
    /// if it has fewer failures than expected.
    fn report_held(&mut self, cases: &mut CaseReporter<'_>) {
        for mut message in std::mem::take(&mut self.held) {
            if self.is_success {
                assertion::tolerate(&mut message);
            } else {
                self.has_failure |= self.expected_failures.is_empty();
                if !self.expected_failures.is_empty() {
                    message.kind = MessageKind::Report;
                }
            }
            cases.full_message(Some(self.sections.path()), message);
        }
    }
}

impl ReportReader for Reader {
    fn report(&mut self, bytes: &[u8], cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        let (events, result) = self.report.feed(bytes);
        for event in events {
            match event {
                XmlEvent::Start { name, attributes } => self.start(&name, &attributes, cases),
                XmlEvent::End { name, text } => self.end(&name, &text, cases),
            }
        }
        result
    }

    fn finish(&mut self, end: ExitStatus, cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        if let Some(case) = &mut self.case {
            case.sections.close_left(cases);
            case.is_success = false;
            case.expected_failures.clear();
            case.report_held(cases);
        } else if self.report.is_incomplete() && matches!(end, ExitStatus::Code(_)) {
            cases.test_error("the report of the program is incomplete".to_owned());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
