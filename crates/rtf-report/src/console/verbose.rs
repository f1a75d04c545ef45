//! Verbose console output: each message,
//! measurement and line of output, with the name of its source.

use std::collections::BTreeMap;

use rtf_model::{
    CaseFinished, CaseId, Event, EventKind, FixtureId, Output, Record, Source, Stream, TestId,
    Verdict,
};

use super::page::ConsoleLines;
use super::results;
use super::style::{DIM, GOOD, LOUD};
use crate::explain::{self, Tone};
use crate::{escape, words};

/// Longer lines are shown in pieces of this size.
const LONGEST_LINE: usize = 8 * 1024;

/// Shows everything; keeps incomplete lines until they end.
#[derive(Debug, Default)]
pub(super) struct Verbose {
    partial: BTreeMap<Key, String>,
}

/// The source of an output, and whether it is standard error.
type Key = (Source, bool);

impl Verbose {
    /// Shows the details of an event; `live` shows the rest.
    pub fn show(&mut self, page: &mut ConsoleLines, event: &Event, record: &Record) {
        match &event.kind {
            EventKind::TestStarted { test, .. } => {
                begin(page, record, Source::Test(*test), "start")
            }
            EventKind::FixtureStarting { fixture, attempt: 1 } => {
                begin(page, record, Source::Fixture(*fixture), "set up");
            }
            EventKind::FixtureStopping { fixture } => {
                begin(page, record, Source::Fixture(*fixture), "tear down");
            }
            EventKind::HookStarted { hook, .. } => {
                begin(page, record, Source::Hook(*hook), "start");
            }
            EventKind::TestPhase { test, phase } => {
                let name = name(record, Source::Test(*test));
                page.remark((DIM, phase.as_str()), &name);
            }
            EventKind::Message { source, message, .. } => {
                let mut lines = Vec::new();
                explain::message(message, &mut |tone, line| lines.push((tone, line.to_owned())));
                lines_of(page, &name_in_case(record, *source, message.case), &lines);
            }
            EventKind::CaseFinished(end) => case_finished(page, record, end),
            EventKind::Measured { test, fixture, measurement } => {
                let tone = if measurement.is_within_limits() { Tone::Plain } else { Tone::Bad };
                let lines = [(tone, explain::measurement(measurement))];
                let name = name_in_case(record, teller(*test, *fixture), measurement.case);
                lines_of(page, &name, &lines);
            }
            EventKind::Attached { test, fixture, attachment } => {
                let text = format!(
                    "attached {}: {}",
                    escape::line(&attachment.name),
                    words::attachment_place(attachment)
                );
                let name = name_in_case(record, teller(*test, *fixture), attachment.case);
                lines_of(page, &name, &[(Tone::Plain, text)]);
            }
            EventKind::FaultRemoved { test, name } => {
                let text = format!("removed the fault {}", escape::line(name));
                lines_of(page, &self::name(record, Source::Test(*test)), &[(Tone::Plain, text)]);
            }
            EventKind::Output(output) => self.output(page, output, record),
            EventKind::TestFinished(finished) => {
                sampled(page, record, finished.test);
                self.flush_suite(page, record, Source::Test(finished.test));
            }
            EventKind::FixtureStopped { fixture, .. } => {
                self.flush_suite(page, record, Source::Fixture(*fixture));
            }
            EventKind::HookFinished { hook, .. } => {
                self.flush_suite(page, record, Source::Hook(*hook));
            }
            EventKind::RunnerDied { .. } => self.flush(page, record),
            _ => {}
        }
    }

    /// Omits an event that only verbose output shows; returns its number of lines. `None`
    /// if the event is always shown.
    pub fn skip(&mut self, event: &Event) -> Option<u64> {
        let lines = |text: &str| text.lines().count() as u64;
        match &event.kind {
            EventKind::Message { message, .. } => Some(lines(&message.text).max(1)),
            EventKind::Measured { .. }
            | EventKind::Attached { .. }
            | EventKind::FaultRemoved { .. } => Some(1),
            EventKind::CaseFinished(end) if !end.verdict.is_problem() => {
                (!end.carried).then_some(1)
            }
            EventKind::Output(output) => {
                // The next piece would not continue this line.
                self.partial.remove(&key(output));
                Some(lines(&output.text))
            }
            _ => None,
        }
    }

    fn output(&mut self, page: &mut ConsoleLines, output: &Output, record: &Record) {
        let partial = self.partial.entry(key(output)).or_default();
        if output.omitted_bytes > 0 {
            let bytes = words::count(output.omitted_bytes, "byte");
            partial.push_str(&format!("\n[… {bytes} left out …]\n"));
        }
        partial.push_str(&output.text);
        let complete = match partial.rfind('\n') {
            Some(end) => end + 1,
            None if partial.len() > LONGEST_LINE => partial.len(),
            None => return,
        };
        let rest = partial.split_off(complete);
        let text = std::mem::replace(partial, rest);
        print(page, &name(record, output.source), &text);
    }

    /// Shows the incomplete lines of a suite, except those of tests
    /// that are still running: the rest of these lines may follow.
    fn flush_suite(&mut self, page: &mut ConsoleLines, record: &Record, source: Source) {
        let suite = record.suite_of(source);
        let goes_on = |of: Source| matches!(of, Source::Test(_)) && of != source;
        let (now, later) = std::mem::take(&mut self.partial)
            .into_iter()
            .partition(|((of, _), _)| record.suite_of(*of) == suite && !goes_on(*of));
        self.partial = now;
        self.flush(page, record);
        self.partial = later;
    }

    /// Shows incomplete lines.
    pub fn flush(&mut self, page: &mut ConsoleLines, record: &Record) {
        for ((source, _), text) in std::mem::take(&mut self.partial) {
            print(page, &name(record, source), &text);
        }
    }
}

fn key(output: &Output) -> Key {
    (output.source, output.stream == Stream::Stderr)
}

fn name(record: &Record, source: Source) -> String {
    match source {
        Source::Test(id) => escape::line(&record.full_name(id)).into_owned(),
        Source::Fixture(id) => format!("fixture {}", escape::line(&record.fixture_name(id))),
        Source::Hook(id) => format!("hook {}", escape::line(&record.full_hook_name(id))),
    }
}

/// The name of a source, with the case in which it reports.
fn name_in_case(record: &Record, source: Source, case: Option<CaseId>) -> String {
    let name = name(record, source);
    let (Source::Test(test), Some(case)) = (source, case) else { return name };
    let attempt = record.tests.get(test.index()).and_then(|test| test.attempts.last());
    match attempt.and_then(|attempt| attempt.cases.get(case)) {
        Some(case) => format!("{name}/{}", escape::line(&case.path)),
        None => name,
    }
}

/// Shows a case that passed or skipped itself, in the attempt in which it ran; others are
/// always shown.
fn case_finished(page: &mut ConsoleLines, record: &Record, end: &CaseFinished) {
    let word = match end.verdict {
        _ if end.carried => return,
        Verdict::Passed => (GOOD, "passed"),
        Verdict::Skipped => (LOUD, "skipped"),
        _ => return,
    };
    let Some(test) = record.tests.get(end.test.index()) else { return };
    let case = test.attempts.last().and_then(|attempt| attempt.cases.get(end.case));
    if let Some(case) = case {
        results::case_line(page, record, test, (case, word));
    }
    if let Some(reason) = &end.reason {
        page.detail(Tone::Dim, &words::short_line(reason));
    }
}

fn begin(page: &mut ConsoleLines, record: &Record, source: Source, word: &str) {
    page.remark((DIM, word), &name(record, source));
}

fn lines_of(page: &mut ConsoleLines, name: &str, lines: &[(Tone, String)]) {
    for (tone, line) in lines {
        page.detail(*tone, &format!("{name}: {line}"));
    }
}

fn print(page: &mut ConsoleLines, name: &str, text: &str) {
    for line in text.lines() {
        page.detail(Tone::Dim, format!("{name} | {}", escape::block(line)).trim_end());
    }
}

/// Shows the signals of a test, one line each.
fn sampled(page: &mut ConsoleLines, record: &Record, test: TestId) {
    let attempt = record.tests.get(test.index()).and_then(|test| test.attempts.last());
    let lines = attempt.iter().flat_map(|attempt| &attempt.series).map(|series| {
        let tone = if series.outside == 0 { Tone::Plain } else { Tone::Bad };
        (tone, explain::series(series))
    });
    let lines: Vec<_> = lines.collect();
    lines_of(page, &name(record, Source::Test(test)), &lines);
}

/// The source of a detail of a test: the test, or a fixture.
fn teller(test: TestId, fixture: Option<FixtureId>) -> Source {
    fixture.map_or(Source::Test(test), Source::Fixture)
}
