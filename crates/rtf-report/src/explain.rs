//! Explains line by line why a test or hook failed. Console, text and JUnit
//! use the same lines with their own style and indentation.

use rtf_model::{
    AttemptRecord, CaseId, Comparison, FaultRecord, HookRunRecord, LeakedProcess, Measurement,
    Message, MessageKind, QuestionRecord, SignalSummary,
};

use crate::cases::{CaseProblems, CaseResult, TestCases};
use crate::{escape, words};

/// The style of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tone {
    /// A problem.
    Bad,
    /// A fact.
    Plain,
    /// A secondary fact.
    Dim,
}

/// How much of an attempt is explained.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    /// Maximum number of failures, and of measurements outside their limits.
    pub items: usize,
    /// Maximum number of lines per stack dump.
    pub stack_lines: usize,
}

impl Extent {
    pub(crate) const ALL: Self = Self { items: usize::MAX, stack_lines: usize::MAX };
}

/// Receives each line, without its line break.
pub(crate) type Sink<'a> = &'a mut dyn FnMut(Tone, &str);

/// The lines that `explain` passes on, without their tones.
pub(crate) fn lines(explain: impl FnOnce(Sink<'_>)) -> Vec<String> {
    let mut lines = Vec::new();
    explain(&mut |_, line| lines.push(line.to_owned()));
    lines
}

/// Explains why an attempt did not pass: reason, failures, measurements and signals
/// outside their limits, stacks. Output and leaked processes are not included, nor is
/// what was reported in a case.
pub(crate) fn explain(attempt: &AttemptRecord, extent: Extent, sink: Sink<'_>) {
    let reason = attempt.finished.as_ref().and_then(|(_, finished)| finished.reason.as_deref());
    if let Some(reason) = reason.filter(|reason| !is_reported_with_its_place(attempt, reason)) {
        block(Tone::Bad, reason, "", sink);
    }
    let failures = own_failures(attempt);
    let violations = attempt.violations().filter(|value| !is_in_case(attempt, value.case));
    problems(&failures.collect::<Vec<_>>(), &violations.collect::<Vec<_>>(), extent, sink);
    attempt.series.iter().filter(|s| s.outside > 0).for_each(|s| sink(Tone::Bad, &series(s)));
    for fault in attempt.faults.iter().take(extent.items) {
        sink(Tone::Dim, &self::fault(attempt, fault));
    }
    left_out(attempt.faults.len(), extent.items, "fault", sink);
    for stack in &attempt.stacks {
        self::stack(stack, extent, sink);
    }
}

/// Explains why an attempt did not pass, with its leaked processes.
pub(crate) fn attempt(attempt: &AttemptRecord, extent: Extent, sink: Sink<'_>) {
    explain(attempt, extent, sink);
    left(&attempt.leaked, sink);
}

/// `fault drop-camera (stop) from 0.201 s to 0.702 s: stopped …`, in the time of the attempt.
pub(crate) fn fault(attempt: &AttemptRecord, record: &FaultRecord) -> String {
    let FaultRecord { fault, .. } = record;
    let times = fault_times(attempt, record);
    let (name, effect) = (escape::line(&fault.name), escape::line(&fault.effect));
    format!("fault {name} ({}) {times}: {effect}", fault.kind.as_str())
}

/// When a fault began and ended, since the start of the attempt.
pub(crate) fn fault_times(attempt: &AttemptRecord, record: &FaultRecord) -> String {
    let time = |at: rtf_model::Micros| words::time(at.since(attempt.started));
    match record.removed {
        None if record.fault.kind.lasts() => format!("from {} on", time(record.injected)),
        None => format!("at {}", time(record.injected)),
        Some(removed) => format!("from {} to {}", time(record.injected), time(removed)),
    }
}

/// Explains why a case did not pass: its reason, failures, and measurements outside
/// their limits.
pub(crate) fn case(cases: &TestCases<'_>, case: &CaseResult<'_>, extent: Extent, sink: Sink<'_>) {
    let none = CaseProblems::default();
    let reported = cases.problems(case).unwrap_or(&none);
    case_problems(case.reason(), reported, extent, sink);
}

/// The reason of a case, unless it is one of its problems, and these problems.
pub(crate) fn case_problems(
    reason: &str,
    reported: &CaseProblems<'_>,
    extent: Extent,
    sink: Sink<'_>,
) {
    let is_reported = reported.failures.iter().any(|failure| failure.text == reason)
        || reported.violations.iter().any(|value| value.problem().as_deref() == Some(reason));
    if !is_reported {
        block(Tone::Bad, reason, "", sink);
    }
    problems(&reported.failures, &reported.violations, extent, sink);
}

fn problems(failures: &[&Message], violations: &[&Measurement], extent: Extent, sink: Sink<'_>) {
    failures.iter().take(extent.items).for_each(|failure| message(failure, sink));
    left_out(failures.len(), extent.items, "failure", sink);
    for violation in violations.iter().take(extent.items) {
        sink(Tone::Bad, &measurement(violation));
    }
    left_out(violations.len(), extent.items, "measurement", sink);
}

/// The failures that were not reported in a case.
pub(crate) fn own_failures(attempt: &AttemptRecord) -> impl Iterator<Item = &Message> {
    attempt.failures().filter(|failure| !is_in_case(attempt, failure.case))
}

/// Whether the attempt has the case in which something was reported.
pub(crate) fn is_in_case(attempt: &AttemptRecord, case: Option<CaseId>) -> bool {
    case.is_some_and(|case| attempt.cases.get(case).is_some())
}

/// Explains why a run of a hook failed: problem, failures, stacks,
/// leaked processes. Output is not included.
pub(crate) fn hook(run: &HookRunRecord, extent: Extent, sink: Sink<'_>) {
    let is_reported = |problem: &&str| run.messages.iter().any(|message| message.text == *problem);
    if let Some(problem) = run.problem().filter(|problem| !is_reported(problem)) {
        block(Tone::Bad, problem, "", sink);
    }
    run.messages.iter().take(extent.items).for_each(|failure| message(failure, sink));
    left_out(run.messages.len(), extent.items, "failure", sink);
    for stack in &run.stacks {
        self::stack(stack, extent, sink);
    }
    left(&run.leaked, sink);
}

/// Whether the reason is one of the failures or measurements that are
/// listed with their locations: usually it is the first one.
fn is_reported_with_its_place(attempt: &AttemptRecord, reason: &str) -> bool {
    attempt.failures().any(|failure| failure.text == reason)
        || attempt.violations().any(|value| value.problem().as_deref() == Some(reason))
        || attempt.series.iter().any(|series| series.problem.as_deref() == Some(reason))
}

/// A message with its location and compared vectors.
pub(crate) fn message(message: &Message, sink: Sink<'_>) {
    let (tone, word) = match message.kind {
        MessageKind::Report => (Tone::Plain, "report"),
        MessageKind::Check => (Tone::Plain, "check"),
        MessageKind::Failure => (Tone::Bad, "failure"),
        MessageKind::Error => (Tone::Bad, "error"),
    };
    let critical = if message.critical { "critical " } else { "" };
    block(tone, &message.text, &format!("{critical}{word}: "), sink);
    if let Some(location) = &message.location {
        sink(Tone::Dim, &format!("  at {}", escape::line(&location.to_string())));
    }
    let fails = matches!(message.kind, MessageKind::Failure | MessageKind::Error);
    // The text already contains a scalar's numbers.
    if let Some(comparison) = message.comparison.as_ref().filter(|c| fails && c.got.len() > 1) {
        vectors(comparison, sink);
    }
}

fn vectors(comparison: &Comparison, sink: Sink<'_>) {
    let list = |numbers: &[Option<f64>]| {
        let number = |n: &Option<f64>| n.map_or("not finite".to_owned(), rtf_model::format_number);
        numbers.iter().map(number).collect::<Vec<_>>().join(", ")
    };
    sink(Tone::Dim, &format!("  expected [{}]", list(&comparison.expected)));
    sink(Tone::Dim, &format!("  got      [{}]", list(&comparison.got)));
}

/// `measured rate = 98.2 Hz, outside ≥ 100 at rate.py:12`.
pub(crate) fn measurement(measurement: &Measurement) -> String {
    let name = escape::line(&measurement.name);
    let (value, limits) = measurement.for_display();
    let mut text = format!("measured {name} = {}", escape::line(&value));
    let learned = if measurement.learned { "learned " } else { "" };
    match (limits.is_empty(), measurement.is_within_limits()) {
        (false, true) => text += &format!(", within {learned}{limits}"),
        (false, false) => text += &format!(", outside {learned}{limits}"),
        (true, _) => {}
    }
    if let Some(location) = &measurement.location {
        text += &format!(" at {}", escape::line(&location.to_string()));
    }
    text
}

/// A question to an operator, and how it ended.
pub(crate) fn question(question: &QuestionRecord, sink: Sink<'_>) {
    block(Tone::Plain, &question.asked.text, "question: ", sink);
    block(Tone::Plain, &question.answer_summary(), "  answer: ", sink);
}

/// `sampled elbow: 500 samples in 4.99 s, 0.1 … 0.6 rad, mean 0.31 rad at arm.py:12`,
/// and before the place what was wrong first, and how often.
pub(crate) fn series(series: &SignalSummary) -> String {
    let name = escape::line(&series.name);
    let mut text = format!("sampled {name}: {}", escape::line(&series.summary()));
    if let Some(problem) = &series.problem {
        text += &format!("; {} outside: {}", series.outside, escape::line(problem));
    }
    if let Some(location) = &series.location {
        text += &format!(" at {}", escape::line(&location.to_string()));
    }
    text
}

/// The stack dump of a process that was killed.
pub(crate) fn stack(stack: &str, extent: Extent, sink: Sink<'_>) {
    sink(Tone::Plain, "stack before it was killed:");
    let text = escape::block(stack);
    for line in text.lines().take(extent.stack_lines) {
        sink(Tone::Dim, &format!("| {line}"));
    }
    left_out(text.lines().count(), extent.stack_lines, "line", sink);
}

pub(crate) fn left(processes: &[LeakedProcess], sink: Sink<'_>) {
    if processes.is_empty() {
        return;
    }
    let count = words::count(processes.len() as u64, "process");
    sink(Tone::Bad, &format!("{count} left behind and killed:"));
    for process in processes {
        sink(Tone::Plain, &format!("  {}", self::process(process)));
    }
}

/// `4711 sleep 1000 (test arm/EncoderTest)`.
pub(crate) fn process(process: &LeakedProcess) -> String {
    let command = escape::line(&process.command);
    let owner = process.owner.as_deref();
    let owner = owner.map_or(String::new(), |owner| format!(" ({})", escape::line(owner)));
    format!("{} {command}{owner}", process.pid)
}

/// Lines of a process's output.
pub(crate) fn printed<'a>(lines: impl IntoIterator<Item = &'a str>, sink: Sink<'_>) {
    for line in lines {
        sink(Tone::Dim, format!("| {}", escape::block(line)).trim_end());
    }
}

/// Text of several lines: the first after `label`, the others below it.
pub(crate) fn block(tone: Tone, text: &str, label: &str, sink: Sink<'_>) {
    let text = escape::block(text);
    let mut lines = text.lines();
    sink(tone, format!("{label}{}", lines.next().unwrap_or_default()).trim_end());
    for line in lines {
        sink(tone, format!("{:width$}{line}", "", width = label.len()).trim_end());
    }
}

fn left_out(total: usize, shown: usize, what: &str, sink: Sink<'_>) {
    if total > shown {
        let more = (total - shown) as u64;
        sink(Tone::Dim, &format!("… and {more} more {}", words::plural(more, what)));
    }
}
