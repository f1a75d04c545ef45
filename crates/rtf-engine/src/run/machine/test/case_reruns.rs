//! Cases that their framework runs again: the last attempt of each one decides. Names of cases, which
//! are unique apart from attempts.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use rtf_model::{CaseId, CaseStart};

use crate::run::machine::judge::TestProblem;

/// A top-level case whose next attempt has not started.
#[derive(Debug)]
pub(super) struct DueCase {
    /// That of its last attempt.
    last: CaseName,
    /// The problem of the last one.
    problem: Option<TestProblem>,
}

impl DueCase {
    /// The name of its next attempt.
    pub fn next(&self) -> CaseName {
        CaseName { attempt: self.last.attempt + 1, ..self.last.clone() }
    }

    /// Why the case has no result.
    pub fn not_started(&self) -> String {
        let reason = "the test ended before the next attempt of the case".to_owned();
        match &self.problem {
            Some(problem) => format!("{reason}; the last one: {}", problem.reason),
            None => reason,
        }
    }
}

/// The cases of an attempt of a test whose next attempts have not started.
#[derive(Debug, Default)]
pub(super) struct CaseReruns(Vec<DueCase>);

impl CaseReruns {
    /// A case has finished that its framework runs again.
    pub fn add(&mut self, last: CaseName, problem: Option<TestProblem>) {
        self.0.push(DueCase { last, problem });
    }

    /// Takes the case of which this is the next attempt.
    pub fn take(&mut self, start: &CaseStart) -> Option<DueCase> {
        let is_next = |due: &DueCase| start.parent.is_none() && due.last.host_name == start.name;
        let due = self.0.iter().position(is_next)?;
        Some(self.0.remove(due))
    }

    /// Takes a case: no further attempt follows.
    pub fn pop(&mut self) -> Option<DueCase> {
        (!self.0.is_empty()).then(|| self.0.remove(0))
    }
}

/// The names of a case, and which attempt of it runs, from 1.
#[derive(Clone, Debug)]
pub(super) struct CaseName {
    pub host_name: String,
    /// Its name in the record.
    pub name: String,
    pub attempt: u32,
}

/// Makes a name unique: the second one becomes `NAME#2`.
pub(super) fn unique(
    counts: &mut HashMap<u64, u32>,
    parent: Option<CaseId>,
    name: String,
) -> (String, bool) {
    let mut hasher = DefaultHasher::new();
    (parent, &name).hash(&mut hasher);
    let count = counts.entry(hasher.finish()).or_default();
    *count += 1;
    if *count == 1 { (name, false) } else { (format!("{name}#{count}"), true) }
}
