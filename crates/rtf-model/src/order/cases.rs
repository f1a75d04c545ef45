//! Cases: each starts and finishes once, inside its parent and its test.

use super::{OrderChecker, Rule, ensure};
use crate::{CaseFinished, CaseId, CaseStarted, TestId};

/// The open cases of an attempt.
#[derive(Clone, Debug, Default)]
pub(super) struct CaseProgress {
    started: u32,
    /// Whether a case has finished in this attempt.
    any_finished: bool,
    open: Vec<OpenCase>,
    /// Cases of which a further attempt is due: name and number of attempts so far.
    reruns: Vec<(String, u32)>,
}

#[derive(Clone, Debug)]
struct OpenCase {
    case: CaseId,
    parent: Option<CaseId>,
    name: String,
    earlier_attempts: u32,
}

impl CaseProgress {
    fn is_open(&self, case: CaseId) -> bool {
        self.open.iter().any(|open| open.case == case)
    }
}

impl OrderChecker {
    pub(super) fn start_case(&mut self, started: &CaseStarted) -> Rule {
        let id = started.test;
        self.before_verdict(id)?;
        let test = self.test(id)?;
        let is_retry = test.last.is_some_and(|(_, attempt)| attempt > 1);
        let cases = &mut test.cases;
        let start = &started.start;
        cases.started += 1;
        ensure(start.case.0 == cases.started, || format!("test {id}: case out of order"))?;
        ensure(start.parent.is_none_or(|parent| cases.is_open(parent)), || {
            format!("test {id}: case {} starts in a case that is not open", start.case)
        })?;
        let (name, earlier_attempts) = (start.name.clone(), start.earlier_attempts);
        let rerun = (name.clone(), earlier_attempts);
        if let Some(due) = cases.reruns.iter().position(|due| *due == rerun) {
            cases.reruns.remove(due);
        } else {
            // A carried case has only its last attempt.
            ensure(earlier_attempts == 0 || is_retry, || {
                format!("test {id}: case {} is not the next attempt of a case", start.case)
            })?;
        }
        let (case, parent) = (start.case, start.parent);
        cases.open.push(OpenCase { case, parent, name, earlier_attempts });
        Ok(())
    }

    pub(super) fn finish_case(&mut self, end: &CaseFinished) -> Rule {
        let (id, case) = (end.test, end.case);
        self.before_verdict(id)?;
        let test = self.test(id)?;
        let is_retry = test.last.is_some_and(|(_, attempt)| attempt > 1);
        let cases = &mut test.cases;
        ensure(!end.carried || (is_retry && !cases.any_finished), || {
            format!("test {id}: case {case} of an earlier attempt is out of order")
        })?;
        cases.any_finished |= !end.carried;
        let position = cases.open.iter().rposition(|open| open.case == case);
        let position = position.ok_or_else(|| format!("test {id}: case {case} is not open"))?;
        ensure(!cases.open.iter().any(|open| open.parent == Some(case)), || {
            format!("test {id}: case {case} finishes before a case in it")
        })?;
        let open = cases.open.remove(position);
        if end.rerun {
            ensure(open.parent.is_none(), || {
                format!("test {id}: case {case} is in a case, and has another attempt")
            })?;
            cases.reruns.push((open.name, open.earlier_attempts + 1));
        }
        Ok(())
    }

    pub(super) fn before_verdict(&mut self, id: TestId) -> Rule {
        self.inside_test(id)?;
        ensure(!self.test(id)?.judged, || format!("test {id} has a case after its verdict"))
    }

    /// A report belongs to an open case, if it belongs to one.
    pub(super) fn inside_case(&mut self, id: TestId, case: Option<CaseId>) -> Rule {
        let Some(case) = case else { return Ok(()) };
        ensure(self.test(id)?.cases.is_open(case), || {
            format!("test {id}: case {case} reports and is not open")
        })
    }

    pub(super) fn all_cases_finished(&mut self, id: TestId) -> Rule {
        let cases = &mut self.test(id)?.cases;
        ensure(cases.open.is_empty(), || format!("test {id} ends before its cases"))?;
        cases.reruns.clear();
        (cases.started, cases.any_finished) = (0, false);
        Ok(())
    }
}
