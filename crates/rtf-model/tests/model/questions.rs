//! What a record keeps of questions to the operator.

use crate::record::record;
use crate::reports::asked;
use crate::support::*;
use rtf_model::{AnswerChannel, EventKind, QuestionClosed, QuestionRecord, Record, Respondent};

fn answered(question: u32, answer: &str) -> EventKind {
    let by = Some(Respondent { via: AnswerChannel::Page, who: None });
    let (answer, reason) = (Some(answer.to_owned()), None);
    EventKind::QuestionClosed(QuestionClosed { test: TEST, question, answer, by, reason })
}

fn running(kinds: impl IntoIterator<Item = EventKind>) -> Vec<EventKind> {
    opened(1).into_iter().chain([started(1, 1)]).chain(kinds).collect()
}

fn questions(record: &Record) -> Vec<(u32, bool, String)> {
    let questions = record.tests[0].attempts[0].questions.iter();
    let row = |it: &QuestionRecord| (it.asked.question, it.is_open(), it.answer_summary());
    questions.map(row).collect()
}

#[test]
fn an_answer_belongs_to_its_question() {
    let record = record(running([asked(1), asked(2), answered(1, "yes"), answered(7, "no")]));
    let expected =
        [(1, false, "yes (on the page)".to_owned()), (2, true, "not answered".to_owned())];
    assert_eq!(questions(&record), expected);
}

/// Memory stays bounded.
#[test]
fn answered_questions_beyond_a_limit_are_not_kept() {
    let most = u32::try_from(QuestionRecord::KEPT).unwrap();
    let answered = (1..=most + 2).flat_map(|number| [asked(number), answered(number, "yes")]);
    let record = record(running(answered.chain([asked(most + 3)])));
    let questions = questions(&record);
    assert_eq!(questions.len(), QuestionRecord::KEPT + 1);
    assert_eq!(questions[QuestionRecord::KEPT - 1].0, most);
    assert_eq!(
        (questions[QuestionRecord::KEPT].0, questions[QuestionRecord::KEPT].1),
        (most + 3, true)
    );
}

#[test]
fn a_lean_record_keeps_open_questions_only() {
    let mut record = Record::lean();
    let kinds = running([asked(1), answered(1, "yes"), asked(2)]);
    stream(kinds).iter().for_each(|event| record.apply(event));
    assert_eq!(questions(&record), [(2, true, "not answered".to_owned())]);
}
