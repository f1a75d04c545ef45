//! The failed cases of a test in a past run, for a rerun of these cases only.

use rtf_model::{AttemptRecord, ExitStatus, TestRecord, Verdict};

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
        for case in attempt.cases.kept().iter().filter(|case| attempt.has_own_problem(case)) {
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
    let has_answered = match finished.verdict {
        Verdict::Failed | Verdict::Error => true,
        // Of a case in a program that the host started.
        Verdict::Crashed | Verdict::TimedOut => finished.exit == Some(ExitStatus::Code(0)),
        _ => false,
    };
    has_answered
        && !attempt.stopped
        && finished.decided_by.is_some()
        && attempt.cases.not_run().is_empty()
        && attempt.messages_omitted == 0
        && !attempt.has_reported_problem(None)
}
