//! Tests: which attempt may follow which one, and when an attempt is judged.

use super::{OrderChecker, Rule, TestProgress, ensure};
use crate::TestId;

impl OrderChecker {
    pub(super) fn test(&mut self, test: TestId) -> Result<&mut TestProgress, String> {
        let suite = self.tests.get(test.index()).map(|t| t.suite);
        let suite = suite.ok_or_else(|| format!("test {test} was not planned"))?;
        self.suite_open(suite)?;
        Ok(&mut self.tests[test.index()])
    }

    pub(super) fn start_test(&mut self, id: TestId, number: (u32, u32)) -> Rule {
        let test = self.test(id)?;
        ensure(!test.open, || format!("test {id} started twice"))?;
        ensure(!test.ended, || format!("test {id} started although it was skipped or has ended"))?;
        let follows = match test.last {
            None => number == (1, 1),
            Some((r, a)) if test.rerun => number == (r, a + 1),
            Some((r, _)) => number == (r + 1, 1),
        };
        ensure(follows, || format!("test {id}: repetition or attempt out of order"))?;
        ensure(test.repetitions.is_none_or(|most| number.0 <= most), || {
            format!("test {id}: more repetitions than planned")
        })?;
        test.last = Some(number);
        test.open = true;
        test.faults.clear();
        let suite = test.suite.index();
        self.concurrency.test_running(suite, true);
        Ok(())
    }

    pub(super) fn judge_test(&mut self, id: TestId) -> Rule {
        self.inside_test(id)?;
        self.all_cases_finished(id)?;
        self.all_questions_closed(id)?;
        let test = self.test(id)?;
        ensure(!test.judged, || format!("test {id} is judged twice"))?;
        test.judged = true;
        let suite = test.suite.index();
        self.concurrency.test_judged(suite, true);
        Ok(())
    }

    pub(super) fn finish_test(&mut self, id: TestId, rerun: bool) -> Rule {
        self.inside_test(id)?;
        self.all_cases_finished(id)?;
        self.all_questions_closed(id)?;
        let test = self.test(id)?;
        test.open = false;
        test.rerun = rerun;
        let was_judged = std::mem::take(&mut test.judged);
        let suite = test.suite.index();
        if was_judged {
            self.concurrency.test_judged(suite, false);
        }
        self.concurrency.test_running(suite, false);
        Ok(())
    }

    pub(super) fn skip_test(&mut self, id: TestId) -> Rule {
        let test = self.test(id)?;
        ensure(!test.open, || format!("test {id} skipped while it runs"))?;
        ensure(!test.ended, || format!("test {id} skipped twice, or after its end"))?;
        test.ended = true;
        Ok(())
    }

    pub(super) fn end_test(&mut self, id: TestId, repetitions: u32) -> Rule {
        let test = self.test(id)?;
        let ends = test.repetitions.is_none() && !test.open && !test.rerun && !test.ended;
        ensure(ends, || format!("test {id} cannot end here"))?;
        ensure(test.last.is_some_and(|(r, _)| r == repetitions), || {
            format!("test {id} was not repeated {repetitions} times")
        })?;
        test.ended = true;
        Ok(())
    }
}
