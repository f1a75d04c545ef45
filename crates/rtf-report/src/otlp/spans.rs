//! The spans of a run: suites, starts of fixtures, attempts of tests, cases.

use std::collections::HashMap;

use rtf_model::{
    AttemptRecord, CaseId, CaseRecord, FixtureRecord, Message, MessageKind, Micros, Record,
    RunStarted, SuiteRecord, TestRecord, Verdict,
};
use serde_json::Value;

use super::attributes::{self, Attributes, result_status};
use super::trace::{Span, Status, Trace};
use crate::{outcome, words};

pub fn of(record: &Record, run: &RunStarted) -> Vec<Value> {
    let mut trace = Trace::new(run);
    let status = if record.is_green() { Status::Ok } else { Status::Error(outcome::word(record)) };
    let root = trace.add(Span {
        name: "rtf run".to_owned(),
        parent: None,
        start: Micros(0),
        end: record.last_at,
        attributes: attributes::of_run(run).flag("rtf.green", record.is_green()),
        status,
        events: Vec::new(),
    });
    for suite in &record.suites {
        add_suite(&mut trace, record, suite, root);
    }
    trace.spans
}

fn add_suite(trace: &mut Trace, record: &Record, suite: &SuiteRecord, root: u64) {
    let Some(start) = suite.started else { return };
    let problems = record.suite_problems(suite.plan.suite);
    let tests = || suite.tests.iter().filter_map(|id| record.tests.get(id.index()));
    let red = tests().filter(|test| !record.is_test_green(test)).count();
    let status = match problems.into_iter().next() {
        Some(problem) => Status::Error(problem),
        None if red > 0 => {
            Status::Error(format!("{} did not pass", words::count(red as u64, "test")))
        }
        None => Status::Ok,
    };
    let parent = trace.add(Span {
        name: suite.plan.name.clone(),
        parent: Some(root),
        start,
        end: suite.finished.unwrap_or(record.last_at),
        attributes: Attributes::default()
            .text("test.suite.name", &suite.plan.name)
            .text("rtf.suite.file", &suite.plan.file)
            .text("rtf.requires", &suite.plan.requires.join(" ")),
        status,
        events: Vec::new(),
    });
    for fixture in suite.fixtures.iter().filter_map(|id| record.fixtures.get(id.index())) {
        add_fixture(trace, record, fixture, parent);
    }
    for test in tests() {
        for attempt in &test.attempts {
            add_attempt(trace, record, (test, attempt), parent);
        }
    }
}

fn add_fixture(trace: &mut Trace, record: &Record, fixture: &FixtureRecord, parent: u64) {
    for (number, life) in (1..).zip(&fixture.lives) {
        let mut events = Vec::new();
        if let Some(ready) = life.ready {
            events.push((ready, "ready", Attributes::default()));
        }
        if let Some((at, reason)) = &life.collapsed {
            let attributes = Attributes::default().text("rtf.reason", reason);
            events.push((*at, "collapsed", attributes));
        }
        let collapse = life.collapsed.as_ref().map(|(_, reason)| reason);
        let status = match collapse.or(life.problem.as_ref()) {
            Some(reason) => Status::Error(reason.clone()),
            None => Status::Ok,
        };
        trace.add(Span {
            name: format!("fixture {}", fixture.plan.name),
            parent: Some(parent),
            start: life.starting,
            end: life.stopped.unwrap_or(record.last_at),
            attributes: Attributes::default()
                .text("rtf.fixture", &fixture.plan.name)
                .text("rtf.plugin_type", &fixture.plan.plugin_type)
                .whole("rtf.start", number),
            status,
            events,
        });
    }
}

fn add_attempt(
    trace: &mut Trace,
    record: &Record,
    (test, attempt): (&TestRecord, &AttemptRecord),
    parent: u64,
) {
    let end = attempt.finished.as_ref().map_or(record.last_at, |(at, _)| *at);
    let verdict = attempt.verdict().unwrap_or(Verdict::Interrupted);
    let reason = attempt.finished.as_ref().and_then(|(_, finished)| finished.reason.as_deref());
    let mut attributes = Attributes::default()
        .text("test.case.name", &test.plan.name)
        .text("test.case.result.status", result_status(verdict))
        .text("rtf.verdict", verdict.as_str())
        .text("rtf.plugin_type", &test.plan.plugin_type)
        .text("rtf.tags", &test.plan.tags.join(" "))
        .whole("rtf.repetition", attempt.repetition.into())
        .whole("rtf.attempt", attempt.attempt.into());
    if test.plan.expected.is_some() {
        attributes = attributes.flag("rtf.known_failure", true);
    }
    let number = trace.add(Span {
        name: test.plan.name.clone(),
        parent: Some(parent),
        start: attempt.started,
        end,
        attributes,
        status: status(verdict, reason),
        events: events(attempt, end),
    });
    let mut spans = HashMap::<CaseId, u64>::new();
    for case in attempt.cases.kept() {
        let parent = case.start.parent.and_then(|parent| spans.get(&parent).copied());
        let added = add_case(trace, case, parent.unwrap_or(number), end);
        spans.insert(case.start.case, added);
    }
}

fn add_case(trace: &mut Trace, case: &CaseRecord, parent: u64, end: Micros) -> u64 {
    let verdict = case.verdict().unwrap_or(Verdict::Interrupted);
    let mut attributes = Attributes::default()
        .text("test.case.name", &case.path)
        .text("test.case.result.status", result_status(verdict))
        .text("rtf.verdict", verdict.as_str());
    if case.is_superseded || case.start.earlier_attempts > 0 {
        attributes = attributes.whole("rtf.attempt", (case.start.earlier_attempts + 1).into());
    }
    for parameter in &case.start.parameters {
        attributes =
            attributes.text(&format!("rtf.parameter.{}", parameter.name), &parameter.value);
    }
    trace.add(Span {
        name: case.start.name.clone(),
        parent: Some(parent),
        start: case.started,
        end: case.finished.as_ref().map_or(end, |(at, _)| *at),
        attributes,
        status: status(verdict, case.reason()),
        events: Vec::new(),
    })
}

fn status(verdict: Verdict, reason: Option<&str>) -> Status {
    match verdict {
        Verdict::Passed => Status::Ok,
        Verdict::Skipped => Status::Unset,
        _ => Status::Error(reason.unwrap_or(verdict.as_str()).to_owned()),
    }
}

/// Phases with their times; failures, measurements, signals and reports, whose times a record
/// does not keep, at the end of the attempt.
fn events(attempt: &AttemptRecord, end: Micros) -> Vec<(Micros, &'static str, Attributes)> {
    let phase = |(phase, at): &(rtf_model::Phase, Micros)| {
        (*at, "phase", Attributes::default().text("rtf.phase", phase.as_str()))
    };
    let message = |message: &Message| {
        let (name, attributes) = attributes::of_message(message);
        (end, name, attributes)
    };
    let is_problem =
        |message: &&Message| matches!(message.kind, MessageKind::Failure | MessageKind::Error);
    let messages = attempt.messages.iter();
    let phases = attempt.phases.iter().map(phase);
    let problems = messages.clone().filter(is_problem).map(message);
    let measured = attempt.measurements.iter();
    let measured = measured.map(|it| (end, "measurement", attributes::of_measurement(it)));
    let signals = attempt.series.iter();
    let signals = signals.map(|it| (end, "signal", attributes::of_signal(it)));
    let reports = messages.filter(|it| !is_problem(it)).map(message);
    let faults = attempt.faults.iter().map(|it| (it.injected, "fault", attributes::of_fault(it)));
    phases.chain(faults).chain(problems).chain(measured).chain(signals).chain(reports).collect()
}
