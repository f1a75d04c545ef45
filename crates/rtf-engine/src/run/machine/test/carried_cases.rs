//! The cases of an attempt that a collapse interrupts: the finished ones are carried to the
//! next attempt, whose host runs only the others.

use std::collections::{HashMap, HashSet};
use std::time::Duration;

use rtf_model::protocol::CaseSelector;
use rtf_model::{CaseFinished, CaseId, CaseStart, CaseStarted, EventKind, TestId, Verdict};

use super::verdict::COLLAPSE_WAIT;
use crate::run::machine::context::Context;
use crate::run::machine::judge::TestProblem;

/// A case and its result.
#[derive(Clone, Debug)]
struct PastCase {
    start: CaseStart,
    /// The top-level case that contains it, or itself.
    top: CaseId,
    started: Duration,
    end: Option<PastEnd>,
}

#[derive(Clone, Debug)]
struct PastEnd {
    event: CaseFinished,
    at: Duration,
    /// Its problem as that of the test, if it is a top-level case.
    problem: Option<TestProblem>,
}

/// The finished cases of an attempt, with those that they contain, and the names of the
/// other top-level cases.
#[derive(Debug, Default)]
pub struct CarriedCases {
    /// By number, from 1.
    finished: Vec<PastCase>,
    /// The top-level cases that the host runs.
    remaining: Vec<String>,
}

/// The cases of an attempt, as far as the next one needs them.
#[derive(Debug, Default)]
pub(super) struct CaseHistory {
    /// By number, from 1: the carried ones, then those of the host.
    cases: Vec<PastCase>,
    carried: usize,
    /// The top-level cases that the host is going to run.
    planned: Vec<String>,
    /// The top-level case that finished last.
    last_finished: Option<CaseId>,
    /// Whether the names do not identify the cases that are left.
    is_ambiguous: bool,
}

impl PastCase {
    fn is_top(&self) -> bool {
        self.start.case == self.top
    }

    /// Whether it finished before the collapse. A case of the last moments may have run
    /// without the fixture: neither its problem nor its pass counts.
    fn is_finished(&self, now: Duration) -> bool {
        self.end.as_ref().is_some_and(|end| now.saturating_sub(end.at) > COLLAPSE_WAIT)
    }

    /// Numbers it as a case of the next attempt.
    fn renumber(&mut self, numbers: &HashMap<CaseId, CaseId>) {
        let renumber = |case: &mut CaseId| *case = numbers.get(case).copied().unwrap_or(*case);
        renumber(&mut self.start.case);
        renumber(&mut self.top);
        self.start.parent.iter_mut().for_each(renumber);
        let Some(PastEnd { event, at, problem }) = &mut self.end else { return };
        renumber(&mut event.case);
        event.decided_by.iter_mut().for_each(renumber);
        problem.iter_mut().filter_map(|problem| problem.case.as_mut()).for_each(renumber);
        let duration = at.saturating_sub(self.started).as_micros();
        event.duration_us.get_or_insert(u64::try_from(duration).unwrap_or(u64::MAX));
        event.carried = true;
    }
}

impl CarriedCases {
    /// Selects the cases that the host runs.
    pub fn selectors(&self) -> Vec<CaseSelector> {
        self.remaining.iter().cloned().map(CaseSelector::Equals).collect()
    }

    /// The number of finished cases.
    pub(super) fn count(&self) -> u32 {
        u32::try_from(self.finished.len()).unwrap_or(u32::MAX)
    }

    pub(super) fn top_names(&self) -> impl Iterator<Item = &str> {
        self.tops().map(|case| &*case.start.name)
    }

    /// The paths of all finished cases.
    pub(super) fn paths(&self) -> HashSet<String> {
        let mut paths: HashMap<CaseId, String> = HashMap::new();
        for PastCase { start, .. } in &self.finished {
            let parent = start.parent.and_then(|parent| paths.get(&parent));
            let path = parent.map_or(start.name.clone(), |parent| {
                let name = &start.name;
                format!("{parent}/{name}")
            });
            paths.insert(start.case, path);
        }
        paths.into_values().collect()
    }

    /// The problems of the finished top-level cases.
    pub(super) fn problems(&self) -> impl Iterator<Item = &TestProblem> {
        self.tops().filter_map(|case| case.end.as_ref()?.problem.as_ref())
    }

    pub(super) fn any_passed(&self) -> bool {
        let verdict = |case: &PastCase| case.end.as_ref().map(|end| end.event.verdict);
        self.tops().any(|case| verdict(case) == Some(Verdict::Passed))
    }

    fn tops(&self) -> impl Iterator<Item = &PastCase> {
        self.finished.iter().filter(|case| case.is_top())
    }

    /// Reports them as cases of the new attempt.
    pub(super) fn report(&self, test: TestId, cx: &mut Context<'_>) {
        for cases in self.finished.chunk_by(|one, next| one.top == next.top) {
            for case in cases {
                let started = CaseStarted { test, start: case.start.clone() };
                cx.emit(EventKind::CaseStarted(Box::new(started)));
            }
            // A case has a larger number than the one that contains it.
            for end in cases.iter().rev().filter_map(|case| case.end.as_ref()) {
                cx.emit(EventKind::CaseFinished(end.event.clone()));
            }
        }
    }

    pub(super) fn into_history(self) -> CaseHistory {
        let Self { finished: cases, remaining: planned } = self;
        CaseHistory { carried: cases.len(), cases, planned, ..CaseHistory::default() }
    }
}

impl CaseHistory {
    pub fn plan(&mut self, names: &[String]) {
        self.is_ambiguous |= self.cases.len() > self.carried;
        self.planned.extend_from_slice(names);
    }

    /// Two cases have one name.
    pub fn on_repeated_name(&mut self) {
        self.is_ambiguous = true;
    }

    pub fn start(&mut self, start: &CaseStart, now: Duration) {
        let top = start.parent.and_then(|parent| self.get_mut(parent)).map(|parent| parent.top);
        let top = top.unwrap_or(start.case);
        self.cases.push(PastCase { start: start.clone(), top, started: now, end: None });
    }

    pub fn finish(&mut self, event: &CaseFinished, problem: Option<&TestProblem>, now: Duration) {
        if event.rerun {
            // The case has not finished yet.
            return;
        }
        let Some(case) = self.get_mut(event.case) else { return };
        let problem = problem.filter(|_| case.is_top()).cloned();
        case.end = Some(PastEnd { event: event.clone(), at: now, problem });
        if case.is_top() {
            self.last_finished = Some(event.case);
        }
    }

    fn get_mut(&mut self, case: CaseId) -> Option<&mut PastCase> {
        self.cases.get_mut((case.0 as usize).checked_sub(1)?)
    }

    /// A collapse interrupts the attempt. Returns the cases that the next one does not run
    /// again; `None` if it runs all cases.
    pub fn carry(mut self, now: Duration) -> Option<CarriedCases> {
        if self.is_ambiguous {
            return None;
        }
        let mut finished = self.finished_tops(now);
        let mut remaining = self.remaining(&finished)?;
        if remaining.is_empty() {
            // Something has to run without a collapse.
            let last = self.last_finished?;
            finished.remove(&last);
            remaining.push(self.get_mut(last)?.start.name.clone());
        }
        if finished.is_empty() || self.select_each_other(&finished, &remaining) {
            return None;
        }
        self.cases.retain(|case| finished.contains(&case.top));
        // Cases of different top-level cases may have alternated.
        self.cases.sort_by_key(|case| case.top);
        let numbers = self.cases.iter().map(|case| case.start.case).zip((1..).map(CaseId));
        let numbers: HashMap<_, _> = numbers.collect();
        self.cases.iter_mut().for_each(|case| case.renumber(&numbers));
        Some(CarriedCases { finished: self.cases, remaining })
    }

    fn finished_tops(&self, now: Duration) -> HashSet<CaseId> {
        let (carried, own) = self.cases.split_at(self.carried);
        let own = own.iter().filter(|case| case.is_finished(now));
        let all = carried.iter().chain(own).filter(|case| case.is_top());
        all.map(|case| case.top).collect()
    }

    /// The planned cases that have not finished; `None` if a case was not planned.
    fn remaining(&self, finished: &HashSet<CaseId>) -> Option<Vec<String>> {
        let own = || self.cases[self.carried..].iter().filter(|case| case.is_top());
        let planned: HashSet<&str> = self.planned.iter().map(String::as_str).collect();
        let finished = own().filter(|case| finished.contains(&case.top));
        let mut listed: HashSet<&str> = finished.map(|case| &*case.start.name).collect();
        let all_planned = own().all(|case| planned.contains(&*case.start.name));
        let remaining = self.planned.iter().filter(|name| listed.insert(name)).cloned();
        all_planned.then(|| remaining.collect())
    }

    /// Whether the selection of the remaining cases includes finished ones: names with
    /// slashes can look like those of inner cases.
    fn select_each_other(&self, finished: &HashSet<CaseId>, remaining: &[String]) -> bool {
        let finished =
            self.cases.iter().filter(|case| case.is_top() && finished.contains(&case.top));
        let finished: HashSet<&str> = finished.map(|case| &*case.start.name).collect();
        let remaining: HashSet<&str> = remaining.iter().map(String::as_str).collect();
        let any_outer = |names: &HashSet<&str>, others: &HashSet<&str>| {
            names.iter().flat_map(|name| outer_paths(name)).any(|path| others.contains(path))
        };
        any_outer(&finished, &remaining) || any_outer(&remaining, &finished)
    }
}

/// The paths of the cases that could contain the one with this path.
fn outer_paths(path: &str) -> impl Iterator<Item = &str> {
    path.match_indices('/').map(|(end, _)| &path[..end])
}
