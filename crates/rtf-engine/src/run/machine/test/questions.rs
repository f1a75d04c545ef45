//! The questions of a test to an operator. Each ends with an answer, its time-out, or with the test's
//! `run`: a question never delays a tear-down.

use rtf_model::protocol::{QuestionEnd, Request};
use rtf_model::{EventKind, Phase, Question, QuestionAsked, QuestionClosed, Respondent};

use super::TestRun;
use crate::run::machine::context::Context;
use crate::run::machine::io::{Deadline, Effect, QuestionReply, TestTimer};

/// Why a question ends with its step.
pub(super) const ENDED: &str = "the test has ended";

/// Maximum number of questions of a test that wait at the same time.
const MAX_OPEN: usize = 16;

/// A question that waits for an answer.
#[derive(Debug)]
pub(super) struct OpenQuestion {
    /// The number that its host has given it.
    in_host: u32,
    asked: Question,
}

/// How a question ends without an answer of an operator.
struct Unanswered<'a> {
    reason: &'a str,
    by: Option<Respondent>,
}

impl TestRun<'_> {
    /// The test asks a question. The host waits for its end.
    pub(super) fn ask_person(&mut self, asked: Question, cx: &mut Context<'_>) {
        // The host gets the request to stop, which ends its wait.
        if self.step.is_some() || self.evidence.stopped.is_some() {
            return;
        }
        if let Some(problem) = self.question_problem(&asked) {
            return self.end_in_host(asked.question, Err(problem), cx);
        }
        let number = cx.next_question();
        let case = self.cases.open(asked.case);
        let in_host = asked.question;
        let asked =
            Question { question: number, case, timeout_ms: milliseconds(asked.timeout()), ..asked };
        let test = self.plan.id;
        let event = QuestionAsked { test, question: asked.clone() };
        cx.emit(EventKind::QuestionAsked(Box::new(event)));
        if self.questions.is_empty() {
            cx.push(Effect::PauseLimits(test));
        }
        cx.set(Deadline::Test(test, TestTimer::Question(number)), asked.timeout());
        self.questions.push(OpenQuestion { in_host, asked });
        self.update_stopwatch();
        if let Some(reason) = cx.unattended() {
            let reason = format!("no operator can answer: {reason}");
            self.close_unanswered(number, &Unanswered { reason: &reason, by: None }, cx);
        }
    }

    fn question_problem(&self, asked: &Question) -> Option<String> {
        if !matches!(self.phase, Phase::Setup | Phase::Run) {
            return Some("questions are allowed in `setup` and `run` only".to_owned());
        }
        if self.questions.iter().any(|open| open.in_host == asked.question) {
            return Some(format!("question {} is asked twice", asked.question));
        }
        if self.questions.len() >= MAX_OPEN {
            return Some(format!("more than {MAX_OPEN} questions wait for an answer"));
        }
        let problem = asked.problem();
        problem.map(|problem| format!("the question \"{}\" is not valid: {problem}", title(asked)))
    }

    /// An operator replies. A late reply, and one that is no answer, have no effect.
    pub fn on_reply(&mut self, reply: QuestionReply, cx: &mut Context<'_>) {
        let QuestionReply { question, answer, by } = reply;
        match answer {
            Some(answer) => {
                let is_valid = |open: &OpenQuestion| {
                    open.asked.question == question && open.asked.answer_problem(&answer).is_none()
                };
                if self.questions.iter().any(is_valid) {
                    let closed = self.closed(question, Some(answer), Some(by), None);
                    self.close(closed, cx);
                }
            }
            None => {
                let reason = format!("declined by {by}");
                self.close_unanswered(question, &Unanswered { reason: &reason, by: Some(by) }, cx);
            }
        }
    }

    pub(super) fn on_question_timeout(&mut self, number: u32, cx: &mut Context<'_>) {
        let Some(open) = self.questions.iter().find(|open| open.asked.question == number) else {
            return;
        };
        let reason = format!("no operator answered within {:?}", open.asked.timeout());
        self.close_unanswered(number, &Unanswered { reason: &reason, by: None }, cx);
    }

    /// Ends all questions of a step that ends. The host does not wait for them any more.
    pub(super) fn close_questions(&mut self, reason: &str, cx: &mut Context<'_>) {
        while let Some(open) = self.questions.first() {
            let number = open.asked.question;
            let closed = self.closed(number, None, None, Some(reason.to_owned()));
            self.remove(&closed, cx);
            cx.emit(EventKind::QuestionClosed(closed));
        }
    }

    /// The default answer counts, or there is none.
    fn close_unanswered(&mut self, number: u32, why: &Unanswered<'_>, cx: &mut Context<'_>) {
        let open = self.questions.iter().find(|open| open.asked.question == number);
        let default = open.and_then(|open| open.asked.default.clone());
        let reason = Some(why.reason.to_owned());
        let by = why.by.clone().filter(|_| default.is_none());
        let closed = self.closed(number, default, by, reason);
        self.close(closed, cx);
    }

    fn closed(
        &self,
        question: u32,
        answer: Option<String>,
        by: Option<Respondent>,
        reason: Option<String>,
    ) -> QuestionClosed {
        QuestionClosed { test: self.plan.id, question, answer, by, reason }
    }

    /// Ends a question with its answer, or the problem that there is none.
    fn close(&mut self, closed: QuestionClosed, cx: &mut Context<'_>) {
        let Some(OpenQuestion { in_host, asked }) = self.remove(&closed, cx) else { return };
        let result = closed.answer.clone().ok_or_else(|| {
            let reason = closed.reason.as_deref().unwrap_or_default();
            format!("no answer to \"{}\": {reason}", title(&asked))
        });
        cx.emit(EventKind::QuestionClosed(closed));
        self.end_in_host(in_host, result, cx);
    }

    fn remove(&mut self, closed: &QuestionClosed, cx: &mut Context<'_>) -> Option<OpenQuestion> {
        let is_it = |open: &OpenQuestion| open.asked.question == closed.question;
        let open = self.questions.remove(self.questions.iter().position(is_it)?);
        self.clear(TestTimer::Question(closed.question), cx);
        if self.questions.is_empty() {
            cx.push(Effect::ResumeLimits(self.plan.id));
        }
        self.update_stopwatch();
        Some(open)
    }

    fn end_in_host(&self, question: u32, result: Result<String, String>, cx: &mut Context<'_>) {
        let (answer, problem) = match result {
            Ok(answer) => (Some(answer), None),
            Err(problem) => (None, Some(problem)),
        };
        let end = QuestionEnd { question, answer, problem };
        cx.send(self.host, None, Request::QuestionClosed(end));
    }
}

/// The first line of a question, for messages.
fn title(question: &Question) -> &str {
    question.text.trim().lines().next().unwrap_or_default()
}

fn milliseconds(time: std::time::Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}
