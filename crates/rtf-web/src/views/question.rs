//! Questions of tests to an operator.

use rtf_model::{Event, EventKind, Question, QuestionClosed, QuestionRecord, Respondent};
use serde::Serialize;
use utoipa::ToSchema;

use super::model;

/// A question.
#[derive(Debug, Serialize, ToSchema)]
pub struct Asked {
    /// When.
    pub at: u64,
    /// The question.
    #[schema(value_type = model::Question)]
    pub question: Question,
    /// Where this server has its picture. Missing in a report, which has it as an attachment.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub url: Option<String>,
    /// Its end; missing while it waits for an answer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closed: Option<Closed>,
}

/// The end of a question.
#[derive(Debug, Serialize, ToSchema)]
pub struct Closed {
    /// When.
    pub at: u64,
    /// The answer that the test got.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub answer: Option<String>,
    /// Who answered or declined.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<model::Respondent>)]
    pub by: Option<Respondent>,
    /// Why no operator answered.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// The questions of an attempt.
#[derive(Debug, Default, Serialize, ToSchema)]
pub struct Questions {
    /// The first 1000, in order.
    pub questions: Vec<Asked>,
}

impl Asked {
    /// An open question; `url` is that of a path in the run's directory.
    pub fn open(record: &QuestionRecord, url: impl Fn(&str) -> String) -> Self {
        let question = record.asked.clone();
        let url = question.picture.as_deref().map(url);
        Self { at: record.at.0, question, url, closed: None }
    }
}

impl Questions {
    /// Takes the start or the end of a question of this attempt; `url` is that of a path in the
    /// run's directory.
    pub fn take(&mut self, event: Event, url: impl FnOnce(&str) -> Option<String>) {
        let at = event.at.0;
        match event.kind {
            EventKind::QuestionAsked(asked) if self.questions.len() < QuestionRecord::KEPT => {
                let question = asked.question;
                let url = question.picture.as_deref().and_then(url);
                self.questions.push(Asked { at, question, url, closed: None });
            }
            EventKind::QuestionClosed(closed) => {
                let is_it = |it: &&mut Asked| it.question.question == closed.question;
                let found = self.questions.iter_mut().rev().find(is_it);
                let QuestionClosed { answer, by, reason, .. } = closed;
                let closed = Closed { at, answer, by, reason };
                if let Some(asked) = found {
                    asked.closed = Some(closed);
                }
            }
            _ => {}
        }
    }
}
