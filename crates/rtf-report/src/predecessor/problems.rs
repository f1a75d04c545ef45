//! Lines about everything that is not green and that no plug-in reported: the reasons of
//! verdicts, fixtures, hooks, the run itself.

use rtf_model::{
    CaseId, EventKind, FixtureId, FixtureRecord, HookId, Record, Significance, Source, SuiteId,
    TestFinished, Verdict,
};

use super::result_line::{ResultLine, Word};
use crate::{explain, known_failure};

/// The runner, where a line is about nothing else.
pub(super) const RUNNER: &str = "runner";

/// The name that stands before a message.
pub(super) fn name(record: &Record, source: Source) -> String {
    let name = match source {
        Source::Test(id) => record.tests.get(id.index()).map(|test| &test.plan.name),
        Source::Fixture(id) => record.fixture(id).map(|fixture| &fixture.plan.name),
        Source::Hook(id) => record.hooks.get(id.index()).map(|hook| &hook.plan.name),
    };
    name.map_or("?", String::as_str).to_owned()
}

/// Why an attempt did not pass, unless the test said so itself.
pub(super) fn of_attempt(record: &Record, finished: &TestFinished) -> Option<ResultLine> {
    let test = record.tests.get(finished.test.index())?;
    let attempt = test.attempts.last()?;
    if finished.verdict.is_green() {
        let red_reason = test.verdict().and_then(|_| known_failure::red_reason(record, test))?;
        return Some(ResultLine::about(Word::Fail, &test.plan.name, &red_reason));
    }
    let reason = finished.reason.as_deref().unwrap_or(finished.verdict.as_str());
    // The reason of a problem in a case begins with the name of the case.
    let is_said = |text: &str, case: Option<CaseId>| match reason.strip_suffix(text) {
        Some(start) => start.is_empty() || case.is_some() && case == finished.decided_by,
        None => false,
    };
    let said = attempt.failures().any(|message| is_said(&message.text, message.case))
        || attempt.violations().any(|m| m.problem().is_some_and(|text| is_said(&text, m.case)));
    if said {
        return None;
    }
    let about = name(record, Source::Test(finished.test));
    if let Some(line) = of_known(record, finished, (&about, reason)) {
        return Some(line);
    }
    Some(match finished.verdict {
        Verdict::Failed => ResultLine::about(Word::Fail, &about, reason),
        Verdict::Error => ResultLine::about(Word::Error, &about, reason),
        verdict => ResultLine::about(Word::Error, &about, &format!("{verdict}: {reason}")),
    })
}

/// A result that 2.x had no word for: a known failure, or a test that skipped itself.
fn of_known(
    record: &Record,
    finished: &TestFinished,
    (about, reason): (&str, &str),
) -> Option<ResultLine> {
    let test = record.tests.get(finished.test.index())?;
    let expected = test.plan.expected.as_deref();
    let significance = expected.map(|expected| expected.significance(finished.verdict));
    let stopped = test.attempts.last().is_some_and(|attempt| attempt.stopped);
    match (significance, finished.verdict) {
        (Some(Significance::Expected | Significance::Quarantined), _) => {
            Some(ResultLine::about(Word::Warn, about, &format!("known failure: {reason}")))
        }
        (_, Verdict::Skipped) if !stopped && !record.skips_fail(test) => {
            Some(ResultLine::about(Word::Info, about, &format!("reports: skipped: {reason}")))
        }
        _ => None,
    }
}

/// The lines of an event of the bench.
pub(super) fn of_bench(record: &Record, kind: &EventKind) -> Vec<ResultLine> {
    let line = match kind {
        EventKind::FixtureStarting { fixture, attempt } if *attempt > 1 => {
            of_fixture(record, *fixture, |_| {
                Some((Word::Info, "reports: restarting fixture setup".to_owned()))
            })
        }
        EventKind::FixtureCollapsed { fixture, reason, .. } => {
            of_fixture(record, *fixture, |fixture| {
                let text = format!("Fixture collapsed: {}: {reason}", fixture.plan.name);
                let suite = record.suites.get(fixture.plan.suite.index());
                let tolerated = suite.is_some_and(|suite| suite.plan.tolerates_collapse);
                Some((if tolerated { Word::Warn } else { Word::Error }, text))
            })
        }
        EventKind::FixtureStopped { fixture, problem: Some(problem), .. } => {
            of_fixture(record, *fixture, |fixture| stopped(fixture, problem))
        }
        EventKind::FixtureBroken { fixture, reason } => {
            of_fixture(record, *fixture, |fixture| Some((Word::Error, broken(fixture, reason))))
        }
        EventKind::HookFinished { hook, problem } => of_hook(record, *hook, problem.as_deref()),
        EventKind::ProcessesLeaked { source, processes } => {
            let about = name(record, *source);
            return processes
                .iter()
                .map(|process| {
                    let text = format!("left behind and killed: {}", explain::process(process));
                    ResultLine::about(Word::Warn, &about, &text)
                })
                .collect();
        }
        EventKind::RunnerDied { reason, .. } => {
            Some(ResultLine::about(Word::Error, RUNNER, &format!("the runner died: {reason}")))
        }
        EventKind::RunFinished { interrupted: Some(reason) } => Some(ResultLine::about(
            Word::Error,
            RUNNER,
            &format!("the run was interrupted: {reason}"),
        )),
        _ => None,
    };
    line.into_iter().collect()
}

fn of_fixture(
    record: &Record,
    id: FixtureId,
    tell: impl Fn(&FixtureRecord) -> Option<(Word, String)>,
) -> Option<ResultLine> {
    let fixture = record.fixture(id)?;
    let (word, text) = tell(fixture)?;
    Some(ResultLine::about(word, &suite_name(record, fixture.plan.suite), &text))
}

/// A failed tear-down. A failed set-up is reported when the fixture is broken.
fn stopped(fixture: &FixtureRecord, problem: &str) -> Option<(Word, String)> {
    fixture.ready?;
    Some((Word::Error, format!("tearDown() failed!: {}: {problem}", fixture.plan.name)))
}

fn broken(fixture: &FixtureRecord, reason: &str) -> String {
    let name = &fixture.plan.name;
    match fixture.collapses.len() {
        0 => format!("setup() failed!: {name}: {reason}"),
        _ => format!("Fixture collapsed: {name}: it will not be restarted: {reason}"),
    }
}

fn of_hook(record: &Record, id: HookId, problem: Option<&str>) -> Option<ResultLine> {
    let hook = record.hooks.get(id.index())?;
    let run = hook.runs.last()?;
    let (name, on) = (&hook.plan.name, run.trigger);
    let (word, text) = match problem {
        Some(problem) => (Word::Error, format!("hook {name} on {on} failed: {problem}")),
        None => (Word::Info, format!("reports: hook {name} on {on} is done")),
    };
    Some(ResultLine::about(word, &suite_name(record, hook.plan.suite), &text))
}

fn suite_name(record: &Record, id: SuiteId) -> String {
    record.suites.get(id.index()).map_or("?", |suite| &suite.plan.name).to_owned()
}
