//! The attempts in which the cases of a test reported: a carried case did in an earlier
//! attempt than the deciding one.

use std::collections::HashMap;

use rtf_model::{AttemptRecord, CaseId, CaseRecord, TestRecord};

/// An attempt in which cases of a deciding attempt reported.
#[derive(Debug)]
pub(crate) struct CaseSource<'r> {
    pub attempt: &'r AttemptRecord,
    /// The deciding attempt, from 0.
    deciding: usize,
    /// In an earlier attempt: the numbers of the carried cases in the deciding one.
    carried: Option<HashMap<CaseId, CaseId>>,
}

impl CaseSource<'_> {
    /// The deciding attempt, from 0, and the case there in which something was reported.
    pub fn key(&self, reported: Option<CaseId>) -> Option<(usize, CaseId)> {
        let case = match &self.carried {
            None => reported?,
            Some(carried) => *carried.get(&reported?)?,
        };
        Some((self.deciding, case))
    }
}

/// The deciding attempts of a test, each with the earlier ones that have its carried cases.
pub(crate) fn sources(test: &TestRecord) -> Vec<CaseSource<'_>> {
    let mut sources = Vec::new();
    for (number, attempt) in test.deciding_attempts().enumerate() {
        sources.push(CaseSource { attempt, deciding: number, carried: None });
        let carried = attempt.cases.kept().iter().filter(|case| case.is_carried());
        let mut wanted: HashMap<&str, CaseId> =
            carried.map(|case| (case.path.as_str(), case.start.case)).collect();
        let is_earlier = |other: &&AttemptRecord| {
            other.repetition == attempt.repetition && other.attempt < attempt.attempt
        };
        // The last one that ran a case has its reports.
        for earlier in test.attempts.iter().filter(is_earlier).rev() {
            if wanted.is_empty() {
                break;
            }
            let has_run = |case: &&CaseRecord| {
                case.finished.is_some() && !case.is_carried() && !case.is_superseded
            };
            let cases = earlier.cases.kept().iter().filter(has_run);
            let found = cases.filter_map(|case| {
                wanted.remove(case.path.as_str()).map(|number| (case.start.case, number))
            });
            let carried = Some(found.collect());
            sources.push(CaseSource { attempt: earlier, deciding: number, carried });
        }
    }
    sources
}
