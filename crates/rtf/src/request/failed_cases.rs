//! The failed cases of a test in a past run, for a rerun of these cases only.

use rtf_model::{AttemptRecord, CaseRecord, TestRecord, Verdict};

/// The prefix of a reason that comes from a case.
const CASE_REASON: &str = "case `";

/// Returns the paths of the failed cases; `None` if the test has to be rerun as a whole:
/// it failed outside of its cases, did not run to its end, or did not keep all messages.
pub fn of_test(test: &TestRecord) -> Option<Vec<String>> {
    let mut paths = Vec::new();
    for attempt in test.deciding_attempts() {
        if !attempt.verdict()?.is_problem() {
            continue;
        }
        if !has_failed_in_cases(attempt) {
            return None;
        }
        let failed = attempt.cases.kept().iter().filter(|case| is_failed(case));
        for case in failed.filter(|case| !is_inherited(attempt, case)) {
            let path = attempt.cases.selectable_path(case);
            if !paths.contains(&path) {
                paths.push(path);
            }
        }
    }
    (!paths.is_empty()).then_some(paths)
}

/// Checks whether every problem of an attempt is that of a case.
fn has_failed_in_cases(attempt: &AttemptRecord) -> bool {
    let Some((_, finished)) = &attempt.finished else { return false };
    matches!(finished.verdict, Verdict::Failed | Verdict::Error)
        && !attempt.stopped
        && finished.reason.as_ref().is_some_and(|reason| reason.starts_with(CASE_REASON))
        && attempt.cases.not_run().is_empty()
        && attempt.messages_omitted == 0
        && attempt.failures().all(|message| message.case.is_some())
        && attempt.violations().all(|measurement| measurement.case.is_some())
}

fn is_failed(case: &CaseRecord) -> bool {
    case.verdict().is_none_or(Verdict::is_problem)
}

/// Checks whether a case failed only because of cases that it contains.
fn is_inherited(attempt: &AttemptRecord, case: &CaseRecord) -> bool {
    let id = Some(case.start.case);
    case.reason().is_some_and(|reason| reason.starts_with(CASE_REASON))
        && attempt.failures().all(|message| message.case != id)
        && attempt.violations().all(|measurement| measurement.case != id)
}
