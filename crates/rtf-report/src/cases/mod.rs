//! The cases of a test over all its repetitions, as reports list them.
//!
//! Like a test's verdict, that of a case is the first one that is a problem, of the last
//! attempt of each repetition.

mod source;
mod totals;

use std::collections::{HashMap, HashSet};
use std::time::Duration;

use rtf_model::{
    AttemptRecord, CaseId, CaseRecord, Location, Measurement, Message, TestRecord, Verdict,
};

pub(crate) use source::{CaseSource, sources};
pub(crate) use totals::{CaseTotals, describe as describe_counts};

/// The reason of a case that was running when the run ended.
const CUT_SHORT: &str = "the run ended before the case did";

#[derive(Debug)]
pub(crate) struct TestCases<'r> {
    /// In the order in which they started; those that did not run are last.
    pub results: Vec<CaseResult<'r>>,
    /// Number of passed cases that the record does not keep.
    pub omitted: u64,
    attempts: Vec<&'r AttemptRecord>,
    problems: HashMap<(usize, CaseId), CaseProblems<'r>>,
}

#[derive(Debug, Default)]
pub(crate) struct CaseResult<'r> {
    /// Its name, after those of the cases that contain it.
    pub path: &'r str,
    /// Its record; `None` if it did not run.
    pub record: Option<&'r CaseRecord>,
    /// The duration in all repetitions.
    pub duration: Duration,
    /// The index of the case that contains it.
    pub parent: Option<usize>,
    pub is_container: bool,
    /// Whether it has a problem that is not only that of a case that it contains.
    pub is_problem: bool,
    /// The deciding attempt to which `record` belongs, from 0.
    attempt: usize,
}

/// The problems that were reported in a case.
#[derive(Debug, Default)]
pub(crate) struct CaseProblems<'r> {
    pub failures: Vec<&'r Message>,
    pub violations: Vec<&'r Measurement>,
}

impl CaseResult<'_> {
    /// The verdict in a run that has ended; `None` if it did not run.
    pub fn verdict(&self) -> Option<Verdict> {
        self.record.map(|record| record.verdict().unwrap_or(Verdict::Interrupted))
    }

    pub fn reason(&self) -> &str {
        match (self.record, self.verdict()) {
            (Some(record), _) if record.finished.is_none() => CUT_SHORT,
            (Some(record), Some(verdict)) => record.reason().unwrap_or(verdict.as_str()),
            _ => "did not run",
        }
    }

    /// The deciding attempt in which it ran, from 0, and its id.
    pub fn key(&self) -> Option<(usize, CaseId)> {
        self.record.map(|record| (self.attempt, record.start.case))
    }

    /// Of several repetitions, the first one with the highest rank decides.
    fn rank(&self) -> u8 {
        match self.verdict() {
            Some(verdict) if verdict.is_problem() => 2,
            Some(Verdict::Skipped) => 1,
            _ => 0,
        }
    }
}

impl<'r> TestCases<'r> {
    /// The cases of a test, `None` if it has none.
    pub fn of(test: &'r TestRecord) -> Option<Self> {
        let attempts: Vec<_> = test.deciding_attempts().collect();
        if attempts.iter().all(|attempt| attempt.cases.total() == 0) {
            return None;
        }
        let (mut results, not_run) = match attempts.as_slice() {
            [attempt] => one_attempt(attempt),
            attempts => several_attempts(attempts),
        };
        let problems = problems(&sources(test));
        for parent in results.iter().filter_map(|result| result.parent).collect::<Vec<_>>() {
            results[parent].is_container = true;
        }
        results.extend(not_run.into_iter().map(CaseResult::not_run));
        let omitted = attempts.iter().map(|attempt| attempt.cases.omitted()).max().unwrap_or(0);
        Some(Self { results, omitted, attempts, problems })
    }

    /// The attempts of a case before the one that decides.
    pub fn earlier_attempts(&self, case: &CaseResult<'r>) -> Vec<CaseResult<'r>> {
        let Some((record, attempt)) = case.record.zip(self.attempts.get(case.attempt)) else {
            return Vec::new();
        };
        let earlier = attempt.cases.earlier_attempts(record);
        earlier.map(|case_of| CaseResult::new((case.attempt, attempt), case_of, None)).collect()
    }

    /// The failures and violated limits that were reported in a case.
    pub fn problems(&self, case: &CaseResult<'_>) -> Option<&CaseProblems<'r>> {
        self.problems.get(&case.key()?)
    }

    /// The path with which the case is selected.
    pub fn selectable_path(&self, case: &CaseResult<'_>) -> String {
        let attempt = self.attempts.get(case.attempt);
        let path = attempt.zip(case.record).map(|(a, record)| a.cases.selectable_path(record));
        path.unwrap_or_else(|| case.path.to_owned())
    }

    /// The locations of the problems of a case, and then that of the case.
    pub fn locations<'a>(
        &'a self,
        case: &'a CaseResult<'r>,
    ) -> impl Iterator<Item = &'r Location> + 'a {
        let problems = self.problems(case).into_iter();
        let reported = problems.flat_map(|problems| {
            let failures = problems.failures.iter().map(|failure| failure.location.as_ref());
            failures.chain(problems.violations.iter().map(|violation| violation.location.as_ref()))
        });
        let start = case.record.map(|record| record.start.location.as_ref());
        reported.chain(start).flatten()
    }

    /// Whether the test has a problem that none of its cases has.
    pub fn has_test_problem(&self, test: &TestRecord) -> bool {
        let decisive = test.decisive_attempt();
        let is_of_case = decisive.is_some_and(|attempt| {
            let finished = attempt.finished.as_ref();
            finished.is_some_and(|(_, finished)| finished.decided_by.is_some())
                && !attempt.has_reported_problem(None)
        });
        test.final_verdict().is_problem() && !is_of_case
    }
}

impl<'r> CaseResult<'r> {
    fn new(
        (number, attempt): (usize, &AttemptRecord),
        record: &'r CaseRecord,
        parent: Option<usize>,
    ) -> Self {
        Self {
            path: &record.path,
            record: Some(record),
            duration: record.duration().unwrap_or_default(),
            parent,
            is_container: false,
            is_problem: attempt.has_own_problem(record),
            attempt: number,
        }
    }

    fn not_run(path: &'r str) -> Self {
        Self { path, ..Self::default() }
    }
}

/// The results of an attempt, and the names of the cases that did not run.
type Results<'r> = (Vec<CaseResult<'r>>, Vec<&'r str>);

fn one_attempt(attempt: &AttemptRecord) -> Results<'_> {
    let decisive: Vec<&CaseRecord> = attempt.cases.decisive().collect();
    let index = |id: CaseId| decisive.binary_search_by_key(&id, |case| case.start.case).ok();
    let parent = |case: &CaseRecord| case.start.parent.and_then(index);
    let results =
        decisive.iter().map(|case| CaseResult::new((0, attempt), case, parent(case))).collect();
    (results, attempt.cases.not_run().names().collect())
}

fn several_attempts<'r>(attempts: &[&'r AttemptRecord]) -> Results<'r> {
    let mut results: Vec<CaseResult<'r>> = Vec::new();
    let mut indices: HashMap<&str, usize> = HashMap::new();
    for (number, attempt) in attempts.iter().enumerate() {
        for case in attempt.cases.decisive() {
            let parent = case.start.parent.and_then(|id| attempt.cases.get(id));
            let parent = parent.and_then(|parent| indices.get(parent.path.as_str()).copied());
            let result = CaseResult::new((number, attempt), case, parent);
            let index = *indices.entry(result.path).or_insert(results.len());
            match results.get_mut(index) {
                None => results.push(result),
                Some(before) => {
                    let duration = before.duration + result.duration;
                    if result.rank() > before.rank() {
                        *before = result;
                    }
                    before.duration = duration;
                }
            }
        }
    }
    let names = attempts.iter().flat_map(|attempt| attempt.cases.not_run().names());
    let mut seen = HashSet::new();
    let not_run = names.filter(|name| !indices.contains_key(name) && seen.insert(*name)).collect();
    (results, not_run)
}

fn problems<'r>(sources: &[CaseSource<'r>]) -> HashMap<(usize, CaseId), CaseProblems<'r>> {
    let mut problems: HashMap<_, CaseProblems<'r>> = HashMap::new();
    for source in sources {
        for failure in source.attempt.failures() {
            if let Some(key) = source.key(failure.case) {
                problems.entry(key).or_default().failures.push(failure);
            }
        }
        for violation in source.attempt.violations() {
            if let Some(key) = source.key(violation.case) {
                problems.entry(key).or_default().violations.push(violation);
            }
        }
    }
    problems
}
