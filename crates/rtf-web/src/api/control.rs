//! Control over the run that this process makes. Who may do it was found out
//! before, by [`crate::access`].

use std::sync::Arc;

use axum::extract::State;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use rtf_model::{SuiteId, TestId};
use serde::Serialize;
use utoipa::ToSchema;

use super::asked::At;
use super::parts::entry;
use super::problems::ChangeProblems;
use crate::app::{App, Control, JsonText};
use crate::index::Index;
use crate::problem::Problem;

/// The request was passed on; what comes of it is seen in the events.
#[derive(Debug, Serialize, ToSchema)]
pub struct Accepted {
    /// Always true.
    accepted: bool,
}

type Answer = Result<Response, Problem>;

async fn act(
    app: App,
    run: String,
    act: impl FnOnce(&dyn Control, &Index) -> Result<(), Problem> + Send + 'static,
) -> Answer {
    let (control, runs): (Option<Arc<dyn Control>>, _) = (app.control.clone(), app.runs.clone());
    app.with_run(run, move |run| {
        let Some(control) = control.filter(|_| runs.is_own(run)) else {
            return Err(Problem::conflict("this server does not make this run")
                .hint("only `rtf run --web` controls a run, and only its own"));
        };
        let index = run.read()?;
        if index.state().is_over() {
            return Err(Problem::conflict("the run is over"));
        }
        act(&*control, &index)?;
        let body = JsonText::of(&Accepted { accepted: true })?;
        Ok((StatusCode::ACCEPTED, body).into_response())
    })
    .await
}

/// Ends the run as SIGINT does.
#[utoipa::path(post, path = "/runs/{run}/stop", tag = "control", params(("run" = String, Path)),
    responses((status = 202, body = Accepted), ChangeProblems))]
pub async fn stop_run(State(app): State<App>, At(run): At<String>) -> Answer {
    act(app, run, |control, _| {
        control.stop_run();
        Ok(())
    })
    .await
}

/// Stops a test that runs, and skips what is left of its repetitions.
#[utoipa::path(post, path = "/runs/{run}/tests/{test}/stop", tag = "control",
    params(("run" = String, Path), ("test" = u32, Path)),
    responses((status = 202, body = Accepted), ChangeProblems))]
pub async fn stop_test(State(app): State<App>, At((run, test)): At<(String, u32)>) -> Answer {
    act(app, run, move |control, index| {
        if !entry(&index.record().tests, test, "test")?.is_running() {
            return Err(Problem::conflict(format!("test {test} does not run")));
        }
        control.stop_test(TestId(test));
        Ok(())
    })
    .await
}

/// Stops the running test of a suite, and skips the rest of the suite.
#[utoipa::path(post, path = "/runs/{run}/suites/{suite}/skip", tag = "control",
    params(("run" = String, Path), ("suite" = u32, Path)),
    responses((status = 202, body = Accepted), ChangeProblems))]
pub async fn skip_suite(State(app): State<App>, At((run, suite)): At<(String, u32)>) -> Answer {
    act(app, run, move |control, index| {
        if entry(&index.record().suites, suite, "suite")?.finished.is_some() {
            return Err(Problem::conflict(format!("suite {suite} is over")));
        }
        control.skip_suite(SuiteId(suite));
        Ok(())
    })
    .await
}
