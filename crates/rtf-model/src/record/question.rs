//! The questions of an attempt of a test.

use crate::{Micros, Question, QuestionClosed};

/// A question that an attempt asked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct QuestionRecord {
    /// When it was asked.
    pub at: Micros,
    /// The question.
    pub asked: Question,
    /// When it ended, and its answer.
    pub closed: Option<(Micros, QuestionClosed)>,
}

impl QuestionRecord {
    /// Maximum number of questions of an attempt that are kept in memory.
    pub const KEPT: usize = 1000;

    /// Whether it waits for an answer.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.closed.is_none()
    }

    /// The answer and who gave it, or why there is none, see [`QuestionClosed::summary`].
    #[must_use]
    pub fn answer_summary(&self) -> String {
        let closed = self.closed.as_ref().map(|(_, closed)| closed.summary());
        closed.unwrap_or_else(|| "not answered".to_owned())
    }

    /// Adds a question. Only open questions are kept beyond the limit.
    pub(super) fn ask(questions: &mut Vec<Self>, at: Micros, asked: &Question) {
        questions.push(Self { at, asked: asked.clone(), closed: None });
    }

    /// Records the end of a question, which `keep` says whether to keep.
    pub(super) fn close(
        questions: &mut Vec<Self>,
        at: Micros,
        closed: &QuestionClosed,
        keep: bool,
    ) {
        let is_it =
            |question: &Self| question.is_open() && question.asked.question == closed.question;
        let Some(index) = questions.iter().rposition(is_it) else { return };
        if keep && questions.len() <= Self::KEPT {
            questions[index].closed = Some((at, closed.clone()));
        } else {
            questions.remove(index);
        }
    }
}
