//! Console output during the run.

use rtf_model::{
    Episode, Event, EventKind, FaultInjected, FixtureId, LeakedProcess, Manifest, Message,
    MessageKind, Micros, Parameter, Record, Source, StopCause, SuiteId, SuitePrepared, TestId,
    Verdict,
};

use super::options::View;
use super::page::ConsoleLines;
use super::result_details::EXTENT;
use super::style::{self, BAD, BOLD, DIM, LOUD};
use super::{Verbosity, fixture_values, hooks, questions, results};
use crate::explain::{self, Tone};
use crate::{ReportError, cause, escape, logs, private_resources, words};

pub(super) fn show(page: &mut ConsoleLines, live: View<'_>, event: &Event) {
    let View { options, record } = live;
    let quiet = options.verbosity == Verbosity::Quiet;
    if record.events == 1 {
        damage(page, record);
    }
    match &event.kind {
        EventKind::RunStarted(run) if !quiet => chosen(page, &run.manifest),
        EventKind::Warning { .. } => live.warning(page),
        EventKind::SuiteWaiting { suite, lock, held_by } => {
            live.waiting(page, *suite, lock, held_by);
        }
        EventKind::SuiteStarted { suite } if !quiet => live.suite(page, *suite),
        EventKind::SuiteFinished { suite } if !quiet => live.suite_over(page, *suite),
        EventKind::SuitePrepared(prepared) if !quiet => live.prepared(page, prepared),
        EventKind::FixtureStarting { fixture, attempt } if *attempt > 1 => {
            let text = format!("{} (start {attempt})", live.fixture(*fixture));
            page.remark((LOUD, "restart"), &text);
        }
        EventKind::FixtureReady { fixture } if !quiet => live.ready(page, *fixture),
        EventKind::FixtureCollapsed { fixture, reason, log_tail } => {
            live.trouble(page, "COLLAPSED", *fixture, (reason, log_tail));
        }
        EventKind::FixtureStopped { fixture, problem: Some(problem), log_tail } => {
            live.stopped(page, *fixture, (problem, log_tail));
        }
        EventKind::FixtureBroken { fixture, reason } => live.broken(page, *fixture, reason),
        EventKind::FixtureReset { fixture, problem: Some(problem) } => {
            live.not_reset(page, *fixture, problem);
        }
        EventKind::EpisodeStarted(started) if !quiet => episode(page, &started.episode),
        EventKind::Message { source: Source::Fixture(fixture), message, .. } => {
            live.fixture_message(page, *fixture, message);
        }
        kind @ (EventKind::QuestionAsked(_) | EventKind::QuestionClosed(_)) if !quiet => {
            questions::show(page, live, kind);
        }
        EventKind::FaultInjected(fault) if !quiet => live.fault(page, fault, event.at),
        EventKind::TestSlow { test } => live.slow(page, *test, event.at),
        EventKind::TestStopping { test, cause, reason } => {
            live.stopping(page, *test, *cause, reason);
        }
        EventKind::ProcessesLeaked { source, processes } => live.left(page, *source, processes),
        EventKind::StackDumped { source: Source::Fixture(fixture), text } => {
            page.remark((LOUD, "stack"), &live.fixture(*fixture));
            explain::stack(text, EXTENT, &mut |tone, line| page.detail(tone, line));
        }
        EventKind::CaseFinished(end) => results::case_finished(page, live, end),
        EventKind::TestFinished(end) => results::test_finished(page, live, end),
        EventKind::TestSkipped { test, reason } if !quiet => live.skipped(page, *test, reason),
        EventKind::HookFinished { hook, .. } => hooks::finished(page, live, *hook),
        EventKind::RunnerDied { reason, leaked } => {
            page.remark((BAD, "RUNNER DIED"), &escape::line(reason));
            explain::left(leaked, &mut |tone, line| page.detail(tone, line));
        }
        EventKind::RunFinished { interrupted: Some(reason) } => {
            page.remark((LOUD, "INTERRUPTED"), &escape::line(reason));
        }
        _ => {}
    }
}

/// Shows which report is missing from now on, and why.
pub(super) fn reporter_failed(page: &mut ConsoleLines, error: &ReportError) {
    let what = format!("{} `{}`: {}", error.what, error.path.display(), error.source);
    page.remark((BAD, "NOT WRITTEN"), &escape::line(&what));
}

/// Shows damage of a past run's journal before its events.
fn damage(page: &mut ConsoleLines, record: &Record) {
    if record.is_damaged() {
        page.remark((BAD, "DAMAGED"), "the journal of this run; what follows is incomplete:");
    }
    for damage in &record.damages {
        page.detail(Tone::Bad, &escape::line(&damage.to_string()));
    }
}

/// Shows how tests were selected, unless all tests run in their order.
fn chosen(page: &mut ConsoleLines, manifest: &Manifest) {
    let mut parts = Vec::new();
    if manifest.selected_from > 0 {
        parts.push(format!("from {}", words::count(manifest.selected_from.into(), "test")));
    }
    parts.extend(manifest.shard.iter().map(|shard| format!("--shard {shard}")));
    parts.extend(manifest.shuffle.iter().map(|seed| format!("--shuffle={seed}")));
    if !parts.is_empty() {
        page.remark((DIM, "selected"), &parts.join(", "));
    }
}

fn episode(page: &mut ConsoleLines, episode: &Episode) {
    let Episode { id, seed, parameters, .. } = episode;
    let value = |it: &Parameter| format!("{}={}", it.name, it.value);
    let values: Vec<_> = parameters.iter().map(value).collect();
    let text = format!("{id}, seed {seed}: {}", values.join(" "));
    page.remark((BOLD, "episode"), &escape::line(&text));
}

impl View<'_> {
    fn warning(&self, page: &mut ConsoleLines) {
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

    fn waiting(&self, page: &mut ConsoleLines, id: SuiteId, lock: &str, held_by: &str) {
        let suite = self.record.suites.get(id.index()).map_or("", |suite| &suite.plan.name);
        let text = format!("suite {suite} waits for `{lock}`, held by {held_by}");
        page.remark((LOUD, "waiting"), &escape::line(&text));
    }

    fn suite(&self, page: &mut ConsoleLines, id: SuiteId) {
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
        if self.record.runs_suites_in_parallel() {
            // What follows is not only this suite's: it is no heading.
            return page.remark((DIM, "begin"), &line);
        }
        page.line(&line);
    }

    /// The end of a suite, if suites run in parallel.
    fn suite_over(&self, page: &mut ConsoleLines, id: SuiteId) {
        let Some(suite) = self.record.suites.get(id.index()) else { return };
        if self.record.runs_suites_in_parallel() {
            let took = suite.started.zip(suite.finished).map(|(start, end)| end.since(start));
            let time = words::time(took.unwrap_or_default());
            page.entry((DIM, "end"), &time, &format!("suite {}", escape::line(&suite.plan.name)));
        }
    }

    /// The private resources of the suite, needed to find its processes.
    fn prepared(&self, page: &mut ConsoleLines, prepared: &SuitePrepared) {
        let all = self.options.verbosity == Verbosity::Verbose;
        let kept = prepared.variables.iter().any(|variable| variable.inherited);
        let suite = match self.record.suites.get(prepared.suite.index()) {
            Some(suite) if self.record.runs_suites_in_parallel() => {
                format!("suite {}", escape::line(&suite.plan.name))
            }
            _ => "the suite".to_owned(),
        };
        if all {
            page.remark((DIM, "prepared"), &format!("private resources of {suite}"));
            private_resources::show(prepared, &mut |tone, line| page.detail(tone, line));
        } else if prepared.network.is_some() {
            let text = format!("{suite} has a private network; to join it:");
            page.remark((DIM, "isolated"), &text);
            // The command is long, and seldom needed.
            let log = self.options.shown(&logs::suite_log(self.record, prepared.suite));
            let how = log.unwrap_or_else(|| escape::line(&prepared.join_command).into_owned());
            page.detail(Tone::Dim, &how);
        }
        if kept && !all {
            let whose =
                if self.record.runs_suites_in_parallel() { suite + ": " } else { String::new() };
            page.remark((LOUD, "inherited"), &(whose + &private_resources::kept(prepared)));
        }
    }

    fn fixture(&self, id: FixtureId) -> String {
        format!("fixture {}", escape::line(&self.record.fixture_name(id)))
    }

    fn test(&self, id: TestId) -> String {
        escape::line(&self.record.full_name(id)).into_owned()
    }

    fn ready(&self, page: &mut ConsoleLines, id: FixtureId) {
        let Some(fixture) = self.record.fixture(id) else { return };
        let took = fixture.started.zip(fixture.ready).map(|(start, ready)| ready.since(start));
        let time = words::time(took.unwrap_or_default());
        let mut text = self.fixture(id);
        if let Some(values) = fixture_values::on_one_line(&fixture.values) {
            text += &format!("  {}", style::paint(DIM, &values));
        }
        page.entry((style::GOOD, "ready"), &time, &text);
    }

    fn not_reset(&self, page: &mut ConsoleLines, id: FixtureId, problem: &str) {
        page.remark((LOUD, "not reset"), &self.fixture(id));
        page.detail(Tone::Bad, &escape::line(problem));
    }

    fn trouble(&self, page: &mut ConsoleLines, word: &str, id: FixtureId, what: (&str, &[String])) {
        let (reason, log_tail) = what;
        page.remark((BAD, word), &self.fixture(id));
        explain::block(Tone::Bad, reason, "", &mut |tone, line| page.detail(tone, line));
        self.last_lines(page, id, log_tail);
    }

    /// A broken fixture that has collapsed has already shown its reason.
    fn broken(&self, page: &mut ConsoleLines, id: FixtureId, reason: &str) {
        let told = self.record.fixture(id).and_then(|fixture| fixture.collapses.last());
        match told {
            Some((_, told)) if told == reason => {
                let text = format!("{} will not be restarted", self.fixture(id));
                page.remark((BAD, "BROKEN"), &text);
            }
            _ => self.trouble(page, "BROKEN", id, (reason, &[])),
        }
    }

    /// A broken fixture has already shown its reason; its last lines are new.
    fn stopped(
        &self,
        page: &mut ConsoleLines,
        id: FixtureId,
        (problem, log_tail): (&str, &[String]),
    ) {
        let broke = self.record.fixture(id).and_then(|fixture| fixture.broken.as_deref());
        if broke != Some(problem) {
            return self.trouble(page, "fixture", id, (problem, log_tail));
        }
        if !log_tail.is_empty() {
            page.remark((BAD, "fixture"), &self.fixture(id));
            self.last_lines(page, id, log_tail);
        }
    }

    fn last_lines(&self, page: &mut ConsoleLines, id: FixtureId, log_tail: &[String]) {
        let sink = &mut |tone, line: &str| page.detail(tone, line);
        if !log_tail.is_empty() {
            sink(Tone::Plain, "last lines:");
            explain::printed(log_tail.iter().map(String::as_str), sink);
            if let Some(log) = self.options.shown(&logs::log(self.record, Source::Fixture(id))) {
                sink(Tone::Dim, &format!("full log: {log}"));
            }
        }
    }

    fn fixture_message(&self, page: &mut ConsoleLines, id: FixtureId, message: &Message) {
        let fails = matches!(message.kind, MessageKind::Failure | MessageKind::Error);
        if fails && self.options.verbosity < Verbosity::Verbose {
            page.remark((BAD, "fixture"), &self.fixture(id));
            explain::message(message, &mut |tone, line| page.detail(tone, line));
        }
    }

    fn fault(&self, page: &mut ConsoleLines, fault: &FaultInjected, now: Micros) {
        let attempt = self.record.tests.get(fault.test.index()).and_then(|it| it.attempts.last());
        let time = attempt.map_or(String::new(), |it| words::time(now.since(it.started)));
        let (name, effect) = (escape::line(&fault.name), escape::line(&fault.effect));
        let text = format!("{}, {name}: {effect}", self.test(fault.test));
        page.entry((LOUD, "fault"), &time, &text);
    }

    fn slow(&self, page: &mut ConsoleLines, id: TestId, now: Micros) {
        let attempt = self.record.tests.get(id.index()).and_then(|test| test.attempts.last());
        let time = attempt.map_or(String::new(), |a| words::time(now.since(a.started)));
        page.entry((LOUD, "slow"), &time, &format!("{} is still running", self.test(id)));
    }

    fn stopping(&self, page: &mut ConsoleLines, id: TestId, cause: StopCause, reason: &str) {
        let cause = match cause {
            StopCause::Timeout => "time-out",
            StopCause::Collapse => "collapse",
            StopCause::Interrupt => "interrupt",
            StopCause::Protocol => "protocol",
            StopCause::Finding => "finding",
        };
        let reason = words::short_line(reason);
        page.remark((LOUD, "stopping"), &format!("{} ({cause}): {reason}", self.test(id)));
    }

    /// Leaked processes of a fixture. Those of tests and hooks are shown with their results.
    fn left(&self, page: &mut ConsoleLines, source: Source, processes: &[LeakedProcess]) {
        if let Source::Fixture(id) = source {
            page.remark((LOUD, "leaked"), &self.fixture(id));
            explain::left(processes, &mut |tone, line| page.detail(tone, line));
        }
    }

    fn skipped(&self, page: &mut ConsoleLines, id: TestId, reason: &str) {
        let verdict = (style::of_verdict(Verdict::Skipped), Verdict::Skipped.as_str());
        let reason = words::short_line(cause::short(self.record, reason));
        page.entry(verdict, "", &format!("{}: {reason}", self.test(id)));
    }
}
