//! What is told while the run goes on.

use rtf_model::{
    Event, EventKind, FixtureId, LeftProcess, Message, MessageKind, Micros, Record, Source,
    StopCause, SuiteId, TestFinished, TestId, Verdict,
};

use super::page::Page;
use super::style::{self, BAD, BOLD, DIM, LOUD};
use super::{ConsoleOptions, Verbosity, hooks};
use crate::explain::{self, Extent, Tone};
use crate::{escape, logs, words};

/// How much of a failed test is told at once; the reports have all of it.
pub(super) const EXTENT: Extent = Extent { items: 10, stack_lines: 40 };

/// How many lines of a failed test's output are told at once.
const OUTPUT_LINES: usize = 20;

/// Tells of one event.
pub(super) fn show(page: &mut Page, options: &ConsoleOptions, event: &Event, record: &Record) {
    let live = Live { options, record };
    let quiet = options.verbosity == Verbosity::Quiet;
    match &event.kind {
        EventKind::Warning { .. } => live.warning(page),
        EventKind::SuiteStarted { suite } if !quiet => live.suite(page, *suite),
        EventKind::FixtureStarting { fixture, attempt } if *attempt > 1 => {
            page.remark(
                (LOUD, "restart"),
                &format!("{} (start {attempt})", live.fixture(*fixture)),
            );
        }
        EventKind::FixtureReady { fixture } if !quiet => live.ready(page, *fixture),
        EventKind::FixtureCollapsed { fixture, reason, log_tail } => {
            live.trouble(page, "COLLAPSED", *fixture, (reason, log_tail));
        }
        EventKind::FixtureStopped { fixture, problem: Some(problem), log_tail } => {
            live.trouble(page, "fixture", *fixture, (problem, log_tail));
        }
        EventKind::FixtureBroken { fixture, reason } => {
            live.trouble(page, "BROKEN", *fixture, (reason, &[]));
        }
        EventKind::Message { source: Source::Fixture(fixture), message } => {
            live.fixture_message(page, *fixture, message);
        }
        EventKind::TestSlow { test } => live.slow(page, *test, event.at),
        EventKind::TestStopping { test, cause, reason } => {
            live.stopping(page, *test, *cause, reason);
        }
        EventKind::ProcessesLeft { source, processes } => live.left(page, *source, processes),
        EventKind::StackDumped { source: Source::Fixture(fixture), text } => {
            page.remark((LOUD, "stack"), &live.fixture(*fixture));
            explain::stack(text, EXTENT, &mut |tone, line| page.detail(tone, line));
        }
        EventKind::TestFinished(finished) => live.finished(page, finished),
        EventKind::TestSkipped { test, reason } if !quiet => live.skipped(page, *test, reason),
        EventKind::HookFinished { hook, .. } => hooks::finished(page, options, record, *hook),
        EventKind::RunnerDied { reason, left } => {
            page.remark((BAD, "RUNNER DIED"), &escape::line(reason));
            explain::left(left, &mut |tone, line| page.detail(tone, line));
        }
        EventKind::RunFinished { interrupted: Some(reason) } => {
            page.remark((LOUD, "INTERRUPTED"), &escape::line(reason));
        }
        _ => {}
    }
}

struct Live<'a> {
    options: &'a ConsoleOptions,
    record: &'a Record,
}

impl Live<'_> {
    fn warning(&self, page: &mut Page) {
        let Some(warning) = self.record.warnings.last() else { return };
        let place = warning.labels.first().map(|label| {
            format!("{}:{}:{}: ", escape::line(&label.file), label.line, label.column)
        });
        let message = escape::line(&warning.message);
        page.remark((LOUD, "warning"), &format!("{}{message}", place.unwrap_or_default()));
        for note in &warning.notes {
            page.detail(Tone::Dim, &format!("note: {}", escape::line(note)));
        }
        if let Some(hint) = &warning.hint {
            page.detail(Tone::Plain, &format!("hint: {}", escape::line(hint)));
        }
    }

    fn suite(&self, page: &mut Page, id: SuiteId) {
        let Some(suite) = self.record.suites.get(id.index()) else { return };
        let mut parts = vec![words::count(suite.tests.len() as u64, "test")];
        if !suite.fixtures.is_empty() {
            parts.push(words::count(suite.fixtures.len() as u64, "fixture"));
        }
        let name = style::paint(BOLD, &format!("suite {}", escape::line(&suite.plan.name)));
        let mut line = format!("{name}  {}", parts.join(", "));
        if !suite.plan.file.is_empty() {
            line += &format!("  {}", style::paint(DIM, &escape::line(&suite.plan.file)));
        }
        page.line(&line);
    }

    fn fixture(&self, id: FixtureId) -> String {
        let name = self.record.fixture(id).map_or("?", |fixture| &fixture.plan.name);
        format!("fixture {}", escape::line(name))
    }

    fn test(&self, id: TestId) -> String {
        escape::line(&self.record.full_name(id)).into_owned()
    }

    fn ready(&self, page: &mut Page, id: FixtureId) {
        let Some(fixture) = self.record.fixture(id) else { return };
        let took = fixture.started.zip(fixture.ready).map(|(start, ready)| ready.since(start));
        let time = words::time(took.unwrap_or_default());
        page.entry((style::GOOD, "ready"), &time, &self.fixture(id));
    }

    fn trouble(&self, page: &mut Page, word: &str, id: FixtureId, what: (&str, &[String])) {
        let (reason, log_tail) = what;
        page.remark((BAD, word), &self.fixture(id));
        let sink = &mut |tone, line: &str| page.detail(tone, line);
        explain::block(Tone::Bad, reason, "", sink);
        if !log_tail.is_empty() {
            sink(Tone::Plain, "its last lines:");
            explain::printed(log_tail.iter().map(String::as_str), sink);
            if let Some(log) = self.log(Source::Fixture(id)) {
                sink(Tone::Dim, &format!("all of them: {log}"));
            }
        }
    }

    fn fixture_message(&self, page: &mut Page, id: FixtureId, message: &Message) {
        let fails = matches!(message.kind, MessageKind::Failure | MessageKind::Error);
        if fails && self.options.verbosity < Verbosity::Verbose {
            page.remark((BAD, "fixture"), &self.fixture(id));
            explain::message(message, &mut |tone, line| page.detail(tone, line));
        }
    }

    fn slow(&self, page: &mut Page, id: TestId, now: Micros) {
        let attempt = self.record.tests.get(id.index()).and_then(|test| test.attempts.last());
        let time = attempt.map_or(String::new(), |a| words::time(now.since(a.started)));
        page.entry((LOUD, "slow"), &time, &format!("{} is still running", self.test(id)));
    }

    fn stopping(&self, page: &mut Page, id: TestId, cause: StopCause, reason: &str) {
        let cause = match cause {
            StopCause::Timeout => "time-out",
            StopCause::Collapse => "collapse",
            StopCause::Interrupt => "interrupt",
            StopCause::Protocol => "protocol",
        };
        let reason = escape::line(reason);
        page.remark((LOUD, "stopping"), &format!("{} ({cause}): {reason}", self.test(id)));
    }

    /// What a test or a hook left behind is told with its end.
    fn left(&self, page: &mut Page, source: Source, processes: &[LeftProcess]) {
        if let Source::Fixture(id) = source {
            page.remark((LOUD, "left"), &self.fixture(id));
            explain::left(processes, &mut |tone, line| page.detail(tone, line));
        }
    }

    fn finished(&self, page: &mut Page, finished: &TestFinished) {
        let Some(test) = self.record.tests.get(finished.test.index()) else { return };
        let Some(attempt) = test.attempts.last() else { return };
        let mut name = self.test(finished.test);
        if test.plan.repetitions > 1 {
            name += &format!(" ({} of {})", attempt.repetition, test.plan.repetitions);
        }
        if attempt.attempt > 1 {
            name += &format!(", attempt {}", attempt.attempt);
        }
        if finished.rerun {
            name += ", will be run again";
        }
        let green = finished.verdict.is_green();
        if !green || self.options.verbosity > Verbosity::Quiet {
            let verdict = (style::of_verdict(finished.verdict), finished.verdict.as_str());
            page.entry(verdict, &words::time(attempt.duration().unwrap_or_default()), &name);
        }
        if green {
            return leaked(page, &name, &attempt.left);
        }
        let sink = &mut |tone, line: &str| page.detail(tone, line);
        explain::explain(attempt, EXTENT, sink);
        explain::left(&attempt.left, sink);
        if !attempt.output.is_empty() && self.options.verbosity < Verbosity::Verbose {
            output(&attempt.output, self.log(Source::Test(finished.test)), sink);
        }
    }

    fn log(&self, source: Source) -> Option<String> {
        self.options.shown(&logs::log(self.record, source))
    }

    fn skipped(&self, page: &mut Page, id: TestId, reason: &str) {
        let verdict = (style::of_verdict(Verdict::Skipped), Verdict::Skipped.as_str());
        page.entry(verdict, "", &format!("{}: {}", self.test(id), escape::line(reason)));
    }
}

/// Tells what somebody left behind whose work was done nevertheless.
pub(super) fn leaked(page: &mut Page, name: &str, processes: &[LeftProcess]) {
    if !processes.is_empty() {
        page.remark((LOUD, "leaked"), name);
        explain::left(processes, &mut |tone, line| page.detail(tone, line));
    }
}

/// Tells the last lines of what somebody printed, and in which log the others are.
pub(super) fn output(text: &str, log: Option<String>, sink: explain::Sink<'_>) {
    let (lines, total) = words::tail(text, OUTPUT_LINES);
    let heading = match total {
        0..=OUTPUT_LINES => "it printed:".to_owned(),
        _ => format!("the last {OUTPUT_LINES} of {total} lines that it printed:"),
    };
    sink(Tone::Plain, &heading);
    explain::printed(lines, sink);
    if let Some(log) = log.filter(|_| total > OUTPUT_LINES) {
        sink(Tone::Dim, &format!("all of them: {log}"));
    }
}
