//! The questions of an attempt, and the answers of an operator or a program.

use std::ops::ControlFlow;

use axum::Json;
use axum::extract::rejection::JsonRejection;
use axum::extract::{ConnectInfo, Extension, State};
use rtf_model::{AnswerChannel, Respondent, TestId};
use serde::Deserialize;
use utoipa::ToSchema;

use super::control::{Accepted, ControlResult, act};
use super::details::{DetailQuery, Path3};
use super::plan::entry;
use super::problems::{ChangeProblems, Problems};
use super::query::At;
use super::session::rejected;
use crate::access::Who;
use crate::address;
use crate::app::{App, JsonResult, JsonText};
use crate::capabilities::AnswerRequest;
use crate::connections::Peer;
use crate::index::Index;
use crate::problem::Problem;
use crate::views::Questions;

/// What an attempt of a test asked, and the answers.
#[utoipa::path(get, path = "/runs/{run}/tests/{test}/attempts/{number}/questions", tag = "details",
    params(("run" = String, Path), ("test" = u32, Path), ("number" = u32, Path)),
    responses((status = 200, body = Questions), Problems))]
pub async fn questions(State(app): State<App>, At((run, test, number)): Path3) -> JsonResult {
    app.with_run(run, move |run| {
        let mut questions = Questions::default();
        DetailQuery::questions_of(test, number).each(run, |event, _| {
            questions.take(event, |path| Some(address::file(&run.name, path)));
            ControlFlow::Continue(())
        })?;
        JsonText::of(&questions)
    })
    .await
}

/// An answer.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Answering {
    /// One of the choices, or without choices a line of text.
    answer: String,
}

/// Answers a question that waits for an answer.
#[utoipa::path(post, path = "/runs/{run}/tests/{test}/questions/{question}/answer",
    tag = "control", request_body = Answering,
    params(("run" = String, Path), ("test" = u32, Path), ("question" = u32, Path)),
    responses((status = 202, body = Accepted), ChangeProblems))]
pub async fn answer(
    State(app): State<App>,
    Extension(who): Extension<Who>,
    ConnectInfo(Peer(client)): ConnectInfo<Peer>,
    At((run, test, question)): At<(String, u32, u32)>,
    body: Result<Json<Answering>, JsonRejection>,
) -> ControlResult {
    let Json(Answering { answer }) = body.map_err(rejected)?;
    let via = if who == Who::Session { AnswerChannel::Page } else { AnswerChannel::Api };
    let by = Respondent { via, who: Some(client.ip().to_string()) };
    act(app, run, move |control, index| {
        check(index, (test, question), &answer)?;
        control.answer(AnswerRequest { test: TestId(test), question, answer, by });
        Ok(())
    })
    .await
}

/// Whether the question waits for this answer.
fn check(index: &Index, (test, question): (u32, u32), answer: &str) -> Result<(), Problem> {
    let attempts = &entry(&index.record.tests, test, "test")?.attempts;
    let questions = attempts.last().map_or(&[][..], |attempt| &attempt.questions);
    let open = questions.iter().find(|it| it.is_open() && it.asked.question == question);
    let open = open.ok_or_else(|| {
        Problem::conflict(format!("question {question} of test {test} does not wait for an answer"))
    })?;
    match open.asked.answer_problem(answer) {
        Some(problem) => Err(Problem::bad_request(format!("the answer {problem}"))),
        None => Ok(()),
    }
}
