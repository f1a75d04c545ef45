//! Reads the XML report.

use rtf_model::{ExitStatus, Location, Measurement, MessageKind, Outcome};

use super::super::assertion::{self, RunningCases};
use super::super::expression::Expression;
use super::super::sections::Sections;
use super::{ALL_SKIPPED, tags};
use crate::case::{CaseResult, ListedCase};
use crate::case_reporter::CaseReporter;
use crate::framework::{Garbage, ReportReader};
use crate::xml_report::XmlReport;
use crate::xml_stream::{Attributes, XmlEvent};

const ROOT: &str = "Catch2TestRun";

/// The reader of one process.
#[derive(Debug, Default)]
pub(super) struct Reader {
    report: XmlReport,
    running: RunningCases,
    case: Option<RunningCase>,
    /// Whether the reported case is another one of the same name.
    is_ignored: bool,
    /// The open check, or the location and the messages of another element.
    check: Expression,
    benchmark: String,
    unskipped: usize,
}

/// The running test case.
#[derive(Debug, Default)]
struct RunningCase {
    sections: Sections,
    may_fail: bool,
    should_fail: bool,
    has_failure: bool,
    /// The reason of a skip outside of sections.
    skipped: Option<String>,
    /// The reason of a skip in the present section.
    section_skipped: Option<String>,
    /// Whether a section was skipped, and whether another was not.
    skipped_sections: usize,
    other_sections: usize,
    is_success: bool,
    /// A fatal signal was reported: the process dies.
    has_died: bool,
}

impl Reader {
    pub fn new(cases: &[ListedCase]) -> Self {
        Self { report: XmlReport::new(ROOT), running: RunningCases::new(cases), ..Self::default() }
    }

    fn start(&mut self, name: &str, attributes: &Attributes, cases: &mut CaseReporter<'_>) {
        let location = assertion::location(attributes, "filename");
        match name {
            "TestCase" => self.start_case(attributes, location, cases),
            "Section" => {
                if let Some(case) = self.living() {
                    case.sections.enter(attributes.get("name"), location, cases);
                }
            }
            "Expression" => {
                let infos = std::mem::take(&mut self.check.infos);
                self.check = Expression::begin(attributes, location, infos);
            }
            "Failure" | "Warning" | "Skip" | "Exception" | "FatalErrorCondition" => {
                self.check.location = location;
            }
            "BenchmarkResults" => attributes.get("name").clone_into(&mut self.benchmark),
            "mean" => self.measure("", attributes, cases),
            "standardDeviation" => self.measure(" standard deviation", attributes, cases),
            "failed" => {
                let text = format!("{}: {}", self.benchmark, attributes.get("message"));
                self.report(MessageKind::Failure, &text, cases);
            }
            "OverallResult" => {
                if let Some(case) = &mut self.case {
                    case.is_success = attributes.get("success") == "true";
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
            "Section" => self.end_section(cases),
            "Warning" => self.report(MessageKind::Report, text, cases),
            "Exception" => self.report(MessageKind::Error, &format!("exception: {text}"), cases),
            "FatalErrorCondition" => {
                self.report(MessageKind::Error, text, cases);
                self.case.iter_mut().for_each(|case| case.has_died = true);
            }
            "Expression" => self.end_check(cases),
            "Failure" => {
                let text = if text.is_empty() { "FAIL()" } else { text };
                self.report(MessageKind::Failure, text, cases);
            }
            "Skip" => self.skip(text),
            "StdOut" => cases.output(&output(text)),
            "StdErr" => cases.error_output(&output(text)),
            _ => {}
        }
    }

    /// The running case, unless its process is dying: Catch2 then closes all elements.
    fn living(&mut self) -> Option<&mut RunningCase> {
        self.case.as_mut().filter(|case| !case.has_died)
    }

    fn start_case(
        &mut self,
        attributes: &Attributes,
        location: Option<Location>,
        cases: &mut CaseReporter<'_>,
    ) {
        let tags = tags(attributes.get("tags"));
        let start = self.running.start(attributes.get("name"), location);
        self.is_ignored = start.is_none();
        let Some(mut start) = start else { return };
        let has_tag = |tag: &str| tags.iter().any(|known| known == tag);
        let (may_fail, should_fail) = (has_tag("!mayfail"), has_tag("!shouldfail"));
        start.tags = tags;
        self.check = Expression::default();
        self.case = Some(RunningCase {
            sections: Sections::start_case(start, cases),
            may_fail,
            should_fail,
            ..RunningCase::default()
        });
    }

    fn end_section(&mut self, cases: &mut CaseReporter<'_>) {
        let Some(case) = self.living() else { return };
        let (result, count) = match case.section_skipped.take() {
            Some(reason) => (CaseResult::new(Outcome::Skipped, reason), &mut case.skipped_sections),
            None => (CaseResult::default(), &mut case.other_sections),
        };
        *count += usize::from(case.sections.leave(result, cases));
    }

    fn end_case(&mut self, cases: &mut CaseReporter<'_>) {
        if self.living().is_none() {
            return;
        }
        let Some(mut case) = self.case.take() else { return };
        let only_skips = case.skipped_sections > 0 && case.other_sections == 0;
        if only_skips && case.skipped.is_none() {
            case.skipped = Some("all its sections were skipped".to_owned());
        }
        let result = match (case.is_success, case.skipped) {
            (false, _) if case.has_failure => CaseResult::default(),
            (false, _) if case.should_fail => {
                CaseResult::new(Outcome::Failed, "it passed, although it is tagged `[!shouldfail]`")
            }
            (false, _) => CaseResult::new(Outcome::Failed, "it failed without a message"),
            (true, Some(reason)) => CaseResult::new(Outcome::Skipped, reason),
            (true, None) => CaseResult::default(),
        };
        self.unskipped += usize::from(result.outcome != Some(Outcome::Skipped));
        case.sections.finish_case(result, cases);
    }

    fn skip(&mut self, text: &str) {
        let reason = if text.is_empty() { "skipped" } else { text };
        let reason =
            assertion::with_lines(reason.to_owned(), &std::mem::take(&mut self.check.infos));
        let Some(case) = self.living() else { return };
        match case.sections.is_inside() {
            true => case.section_skipped = Some(reason),
            false => case.skipped = Some(reason),
        }
    }

    fn end_check(&mut self, cases: &mut CaseReporter<'_>) {
        let check = std::mem::take(&mut self.check);
        // A fatal signal is reported by its own element.
        if self.living().is_some() {
            self.report_message(check.message(), cases);
        }
    }

    fn report(&mut self, kind: MessageKind, text: &str, cases: &mut CaseReporter<'_>) {
        let infos = std::mem::take(&mut self.check.infos);
        let text = assertion::with_lines(text.to_owned(), &infos);
        let message = assertion::message(kind, &text, self.check.location.take());
        self.report_message(message, cases);
    }

    /// Reports a message. Failures of a case that may or should fail do not change its verdict.
    fn report_message(&mut self, mut message: rtf_model::Message, cases: &mut CaseReporter<'_>) {
        if self.is_ignored {
            return;
        }
        let Some(case) = &mut self.case else {
            return cases.full_message(None, message);
        };
        if matches!(message.kind, MessageKind::Failure | MessageKind::Error) {
            if case.may_fail || case.should_fail {
                assertion::tolerate(&mut message);
            } else {
                case.has_failure = true;
            }
        }
        cases.full_message(Some(case.sections.path()), message);
    }

    /// Reports a time of a benchmark, in nanoseconds.
    fn measure(&self, suffix: &str, attributes: &Attributes, cases: &mut CaseReporter<'_>) {
        let Some(case) = &self.case else { return };
        let name = format!("{}{suffix}", self.benchmark);
        let (value, unit) = (attributes.get("value").parse().ok(), "ns".to_owned());
        let measurement = Measurement { name, value, unit, ..Measurement::default() };
        cases.measure(Some(case.sections.path()), measurement);
    }
}

impl ReportReader for Reader {
    // As in the readers of doctest and Boost.Test: a trait for the three would be longer.
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
        } else if let ExitStatus::Code(code) = end {
            if self.report.is_incomplete() {
                cases.test_error("the report of the program is incomplete".to_owned());
            }
            if code == ALL_SKIPPED && self.unskipped > 0 && !cases.has_problem() {
                let text = format!("the program ended with {end} although no case has a problem");
                cases.test_error(text);
            }
        }
        Ok(())
    }
}

/// Kept output, which is a part of the program's output.
fn output(text: &str) -> Vec<u8> {
    [text.as_bytes(), b"\n"].concat()
}

#[cfg(test)]
mod tests;
