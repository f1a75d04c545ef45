//! Cheap rules that hold for every stored event stream: numbers
//! without gaps, times that do not decrease, as many plans as announced, events
//! about planned items, nothing after the end. [`crate::OrderChecker`] has the
//! other rules, which may differ for earlier runners.

use crate::record::source;
use crate::{Event, EventKind, Micros, Source, SuiteId};

/// Checks the events of a stored stream, one by one.
#[derive(Clone, Debug, Default)]
pub struct StreamChecker {
    next: u64,
    /// Whether the previous line cannot be trusted: it may have held any number
    /// of events.
    is_after_fault: bool,
    last_at: Micros,
    planned: PlannedCounts,
    /// Number of suites and tests that the run announced, until it is compared.
    announced: Option<(u32, u32)>,
    has_begun: bool,
    has_ended: bool,
}

/// Number of planned items so far.
#[derive(Clone, Debug, Default)]
struct PlannedCounts {
    suites: u32,
    fixtures: u32,
    hooks: u32,
    tests: u32,
}

/// The result of checking an event.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EventCheck {
    /// Whether the event counts: it is not a repetition of an earlier one.
    pub is_new: bool,
    /// The problem.
    pub problem: Option<String>,
}

impl StreamChecker {
    /// The expected number of the next event.
    #[must_use]
    pub fn next(&self) -> u64 {
        self.next
    }

    /// Skips a line that is no event.
    pub fn skip_line(&mut self) {
        self.is_after_fault = true;
    }

    /// Checks the next event. If its line `is_intact`, its number is trusted.
    pub fn check(&mut self, event: &Event, is_intact: bool) -> EventCheck {
        if event.seq < self.next {
            let problem =
                format!("found event {} where event {} is expected", event.seq, self.next);
            return EventCheck { is_new: false, problem: Some(problem) };
        }
        let gap = (event.seq > self.next && !self.is_after_fault)
            .then(|| format!("found event {} where event {} is expected", event.seq, self.next));
        self.next = if is_intact { event.seq } else { self.next }.saturating_add(1);
        self.is_after_fault = !is_intact;
        let unordered = self.time(event.at, is_intact);
        let unplanned = self.kind(&event.kind);
        EventCheck { is_new: true, problem: gap.or(unordered).or(unplanned) }
    }

    fn time(&mut self, at: Micros, is_intact: bool) -> Option<String> {
        let is_earlier = at < self.last_at;
        if is_intact && !is_earlier {
            self.last_at = at;
        }
        is_earlier.then(|| "it is earlier than the previous event".to_owned())
    }

    fn kind(&mut self, kind: &EventKind) -> Option<String> {
        let is_start = matches!(kind, EventKind::RunStarted(_));
        if is_start == std::mem::replace(&mut self.has_begun, true) {
            return Some(match is_start {
                true => "the run starts a second time".to_owned(),
                false => "the start of the run is missing".to_owned(),
            });
        }
        if self.has_ended {
            return Some("it follows the end of the run".to_owned());
        }
        match kind {
            EventKind::RunStarted(run) => {
                self.announced = Some((run.suites, run.tests));
                None
            }
            EventKind::SuitePlanned(plan) => count("suite", plan.suite.0, &mut self.planned.suites),
            EventKind::FixturePlanned(plan) => {
                let planned = count("fixture", plan.fixture.0, &mut self.planned.fixtures);
                planned.or_else(|| self.suite(plan.suite))
            }
            EventKind::HookPlanned(plan) => {
                let planned = count("hook", plan.hook.0, &mut self.planned.hooks);
                planned.or_else(|| self.suite(plan.suite))
            }
            EventKind::TestPlanned(plan) => {
                let planned = count("test", plan.test.0, &mut self.planned.tests);
                planned.or_else(|| self.suite(plan.suite))
            }
            EventKind::SuiteStarted { suite } => self.totals().or_else(|| self.suite(*suite)),
            EventKind::SuitePrepared(prepared) => self.suite(prepared.suite),
            EventKind::SuiteWaiting { suite, .. } | EventKind::SuiteFinished { suite } => {
                self.suite(*suite)
            }
            EventKind::RunFinished { .. } => {
                self.has_ended = true;
                self.totals()
            }
            EventKind::RunnerDied { .. } => {
                self.has_ended = true;
                None
            }
            kind => source::source_of(kind).and_then(|source| self.source(source)),
        }
    }

    /// Compares the planned items with the numbers that `run-started` announced.
    fn totals(&mut self) -> Option<String> {
        let (suites, tests) = self.announced.take()?;
        let PlannedCounts { suites: known_suites, tests: known_tests, .. } = self.planned;
        let compare = |what, known, all| {
            (known != all).then(|| format!("{known} of {all} {what} are planned"))
        };
        compare("suites", known_suites, suites).or_else(|| compare("tests", known_tests, tests))
    }

    fn suite(&self, suite: SuiteId) -> Option<String> {
        unplanned("suite", suite.0, self.planned.suites)
    }

    fn source(&self, source: Source) -> Option<String> {
        match source {
            Source::Test(test) => unplanned("test", test.0, self.planned.tests),
            Source::Fixture(fixture) => unplanned("fixture", fixture.0, self.planned.fixtures),
            Source::Hook(hook) => unplanned("hook", hook.0, self.planned.hooks),
        }
    }
}

fn unplanned(what: &str, id: u32, planned: u32) -> Option<String> {
    (id >= planned).then(|| format!("it concerns {what} {id}, which is not planned"))
}

/// Counts a planned item; those of one kind are numbered from 0 without gaps.
fn count(what: &str, id: u32, planned: &mut u32) -> Option<String> {
    let expected = *planned;
    *planned = expected.saturating_add(1);
    if id == expected {
        return None;
    }
    if crate::record::is_likely_gap(expected, id) {
        *planned = id.saturating_add(1);
    }
    Some(format!("{what} {id} is planned where {what} {expected} is expected"))
}

#[cfg(test)]
mod tests;
