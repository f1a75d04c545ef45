//! From an event to the lines that tell it.

use rtf_model::{
    Event, EventKind, Measurement, Message, MessageKind, Record, Source, SuiteId, TestId,
};

use super::result_line::{ResultLine, Word};
use super::{problems, summary};
use crate::escape;

/// The lines of one event; the record has taken it in already.
pub(super) fn of(event: &Event, record: &Record) -> Vec<ResultLine> {
    match &event.kind {
        EventKind::SuiteStarted { suite } => suite_line(record, *suite, "started..."),
        EventKind::SuiteFinished { suite } => {
            let passed = summary::suite_passed(record, *suite);
            suite_line(record, *suite, if passed { "passed!" } else { "failed!" })
        }
        EventKind::TestStarted { test, repetition: 1, attempt: 1 } => {
            vec![test_line(record, *test, "started...")]
        }
        EventKind::Message { source, message, .. } => {
            vec![of_message(&problems::name(record, *source), message)]
        }
        EventKind::Measured { test, measurement, .. } => {
            vec![of_measurement(&problems::name(record, Source::Test(*test)), measurement)]
        }
        EventKind::TestFinished(finished) => {
            let mut lines: Vec<_> = problems::of_attempt(record, finished).into_iter().collect();
            lines.extend(last_word(record, finished.test));
            lines
        }
        EventKind::TestSkipped { test, reason } => {
            let name = problems::name(record, Source::Test(*test));
            let skipped = ResultLine::about(Word::Error, &name, &format!("skipped: {reason}"));
            std::iter::once(skipped).chain(last_word(record, *test)).collect()
        }
        EventKind::TestRepeated { test, .. } => last_word(record, *test).into_iter().collect(),
        kind => problems::of_bench(record, kind),
    }
}

/// The end of a test, once its last word is spoken.
fn last_word(record: &Record, test: TestId) -> Option<ResultLine> {
    record.verdict(test)?;
    let passed = record.tests.get(test.index()).is_some_and(|test| record.is_test_green(test));
    Some(test_line(record, test, if passed { "passed!" } else { "failed!" }))
}

/// The lines after the last event: tests that an incomplete run left open.
pub(super) fn left_open(record: &Record) -> Vec<ResultLine> {
    let mut lines = Vec::new();
    if record.tests.is_empty() {
        lines.push(ResultLine::about(Word::Error, problems::RUNNER, "there are no tests"));
    }
    for test in record.tests.iter().filter(|test| test.verdict().is_none()) {
        let why = if test.attempts.is_empty() {
            "skipped: the run ended before the test started"
        } else {
            "interrupted: the run ended before the test did"
        };
        lines.push(ResultLine::about(Word::Error, &test.plan.name, why));
        lines.push(test_line(record, test.plan.test, "failed!"));
    }
    lines
}

fn suite_line(record: &Record, id: SuiteId, what: &str) -> Vec<ResultLine> {
    // Plug-ins of the command line were in no suite.
    let suite = record.suites.get(id.index()).filter(|suite| summary::is_suite(suite));
    let name = |suite: &rtf_model::SuiteRecord| escape::line(&suite.plan.name).into_owned();
    let line =
        suite.map(|suite| ResultLine::progress(format!("Test suite {} {what}", name(suite))));
    line.into_iter().collect()
}

fn test_line(record: &Record, id: TestId, what: &str) -> ResultLine {
    let name = problems::name(record, Source::Test(id));
    ResultLine::progress(format!("Test case {} {what}", escape::line(&name)))
}

fn of_message(about: &str, message: &Message) -> ResultLine {
    let (word, verb) = match message.kind {
        MessageKind::Report => (Word::Info, "reports: "),
        MessageKind::Check => (Word::Info, "checks: "),
        MessageKind::Failure => (Word::Fail, "checks: "),
        MessageKind::Error => (Word::Error, ""),
    };
    let line = ResultLine::about(word, about, &format!("{verb}{}", message.text));
    line.at(message.location.as_ref().map(place))
}

fn of_measurement(about: &str, measurement: &Measurement) -> ResultLine {
    let (word, text) = match measurement.problem() {
        Some(problem) => (Word::Fail, problem),
        None => (Word::Info, format!("{} = {}", measurement.name, measurement.value_with_unit())),
    };
    let line = ResultLine::about(word, about, &format!("measures: {text}"));
    line.at(measurement.location.as_ref().map(place))
}

/// `test.cpp at 12.`
fn place(location: &rtf_model::Location) -> String {
    let file = escape::line(&location.file);
    if location.line == 0 { format!("{file}.") } else { format!("{file} at {}.", location.line) }
}
