//! What holds for every stored stream of events, and is cheap to check: numbers
//! without gaps, times that do not go back, as many plans as announced, events
//! about what is planned, nothing after the end. [`crate::OrderChecker`] has the
//! other rules; an earlier runner may have obeyed other ones.

use crate::record::source;
use crate::{Event, EventKind, Micros, Source, SuiteId};

/// Checks the events of a stored stream, one by one.
#[derive(Clone, Debug, Default)]
pub struct StreamChecker {
    next: u64,
    /// Whether the line before could not be trusted: nobody knows how many
    /// events it held.
    is_after_fault: bool,
    last_at: Micros,
    planned: Planned,
    /// How many suites and tests the run has, until that was compared.
    announced: Option<(u32, u32)>,
    has_begun: bool,
    is_over: bool,
}

/// How many of each are planned so far.
#[derive(Clone, Debug, Default)]
struct Planned {
    suites: u32,
    fixtures: u32,
    hooks: u32,
    tests: u32,
}

/// What was found in an event.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Checked {
    /// Whether the event counts: it was not there before.
    pub is_new: bool,
    /// What is wrong.
    pub problem: Option<String>,
}

impl StreamChecker {
    /// The number of the next event.
    #[must_use]
    pub fn next(&self) -> u64 {
        self.next
    }

    /// A line came that is no event.
    pub fn skip_line(&mut self) {
        self.is_after_fault = true;
    }

    /// Checks the next event. When its line `is_intact`, its number is believed.
    pub fn check(&mut self, event: &Event, is_intact: bool) -> Checked {
        if event.seq < self.next {
            let problem = format!("event {} stands where event {} should be", event.seq, self.next);
            return Checked { is_new: false, problem: Some(problem) };
        }
        let gap = (event.seq > self.next && !self.is_after_fault)
            .then(|| format!("event {} stands where event {} should be", event.seq, self.next));
        self.next = if is_intact { event.seq } else { self.next }.saturating_add(1);
        self.is_after_fault = !is_intact;
        let unordered = self.time(event.at, is_intact);
        let unplanned = self.kind(&event.kind);
        Checked { is_new: true, problem: gap.or(unordered).or(unplanned) }
    }

    fn time(&mut self, at: Micros, is_intact: bool) -> Option<String> {
        let is_earlier = at < self.last_at;
        if is_intact && !is_earlier {
            self.last_at = at;
        }
        is_earlier.then(|| "it happened earlier than the event before it".to_owned())
    }

    fn kind(&mut self, kind: &EventKind) -> Option<String> {
        let is_start = matches!(kind, EventKind::RunStarted(_));
        if is_start == std::mem::replace(&mut self.has_begun, true) {
            return Some(match is_start {
                true => "the run begins a second time".to_owned(),
                false => "the beginning of the run is missing".to_owned(),
            });
        }
        if self.is_over {
            return Some("it stands after the end of the run".to_owned());
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
                self.is_over = true;
                self.totals()
            }
            EventKind::RunnerDied { .. } => {
                self.is_over = true;
                None
            }
            kind => source::of(kind).and_then(|source| self.source(source)),
        }
    }

    /// Compares what is planned with what the beginning of the run announced.
    fn totals(&mut self) -> Option<String> {
        let (suites, tests) = self.announced.take()?;
        let Planned { suites: known_suites, tests: known_tests, .. } = self.planned;
        let of = |what, known, all| {
            (known != all).then(|| format!("of {all} {what}, {known} are planned"))
        };
        of("suites", known_suites, suites).or_else(|| of("tests", known_tests, tests))
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
    (id >= planned).then(|| format!("it is about {what} {id}, which is not planned"))
}

/// Counts a plan; those of one kind are numbered from 0 without gaps.
fn count(what: &str, id: u32, planned: &mut u32) -> Option<String> {
    let due = *planned;
    *planned = due.saturating_add(1);
    if id == due {
        return None;
    }
    if crate::record::is_likely_gap(due, id) {
        *planned = id.saturating_add(1);
    }
    Some(format!("{what} {id} is planned where {what} {due} should be"))
}

#[cfg(test)]
mod tests;
