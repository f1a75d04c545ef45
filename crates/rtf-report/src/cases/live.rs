//! Cases of a running attempt.

use rtf_model::{AttemptRecord, CaseRecord, Verdict};

/// Whether the problem of a finished case is only that of a case that it contains.
pub(crate) fn has_inner_problem(attempt: &AttemptRecord, case: &CaseRecord) -> bool {
    let is_same = |inner: &CaseRecord| {
        inner.start.parent == Some(case.start.case)
            && inner.verdict().map(Verdict::severity) >= case.verdict().map(Verdict::severity)
    };
    let is_reported = attempt.failures().any(|failure| failure.case == Some(case.start.case))
        || attempt.violations().any(|violation| violation.case == Some(case.start.case));
    // Cases are in the order in which they started.
    let inner = attempt.cases.kept().iter().rev();
    !is_reported && inner.take_while(|inner| inner.start.case > case.start.case).any(is_same)
}

/// Number of finished cases that did not pass, without skipped ones.
pub(crate) fn problem_count(attempt: &AttemptRecord) -> u64 {
    let problems = Verdict::ALL.into_iter().filter(|verdict| verdict.is_problem());
    problems.map(|verdict| attempt.cases.of(verdict)).sum()
}
