//! Questions: each ends once, before the verdict of its test.

use std::collections::BTreeSet;

use super::{OrderChecker, Rule, ensure};
use crate::{QuestionAsked, QuestionClosed, TestId};

impl OrderChecker {
    pub(super) fn ask(&mut self, asked: &QuestionAsked) -> Rule {
        let (id, number) = (asked.test, asked.question.question);
        self.before_verdict(id)?;
        self.inside_case(id, asked.question.case)?;
        let is_new = self.open_questions(id)?.insert(number);
        ensure(is_new, || format!("test {id}: question {number} is asked twice"))
    }

    pub(super) fn close_question(&mut self, closed: &QuestionClosed) -> Rule {
        let (id, number) = (closed.test, closed.question);
        self.before_verdict(id)?;
        let was_open = self.open_questions(id)?.remove(&number);
        ensure(was_open, || format!("test {id}: question {number} is not open"))
    }

    pub(super) fn all_questions_closed(&mut self, id: TestId) -> Rule {
        let is_empty = self.open_questions(id)?.is_empty();
        ensure(is_empty, || format!("test {id} ends before its questions"))
    }

    fn open_questions(&mut self, id: TestId) -> Result<&mut BTreeSet<u32>, String> {
        Ok(&mut self.test(id)?.open_questions)
    }
}
