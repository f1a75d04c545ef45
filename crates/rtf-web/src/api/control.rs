//! Control over the run that this process makes, or those that it starts. Who may
//! do it was found out before, by [`crate::access`].

use std::path::Path;

use axum::extract::State;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use rtf_model::{SuiteId, TestId};
use serde::Serialize;
use utoipa::ToSchema;

use super::plan::entry;
use super::problems::ChangeProblems;
use super::query::At;
use crate::app::{App, JsonText};
use crate::capabilities::{Capabilities, FinishedRun, RerunRejected, RunControl, RunStarter};
use crate::index::Index;
use crate::problem::Problem;
use crate::runs::{Run, Runs};

/// The request was passed on; what comes of it is seen in the events.
#[derive(Debug, Serialize, ToSchema)]
pub struct Accepted {
    /// Always true.
    accepted: bool,
}

/// A run was started.
#[derive(Debug, Serialize, ToSchema)]
pub struct Started {
    /// Always true.
    accepted: bool,
    /// Its name.
    run: String,
}

pub(super) type ControlResult = Result<Response, Problem>;

fn accepted<T: Serialize>(body: &T) -> ControlResult {
    Ok((StatusCode::ACCEPTED, JsonText::of(body)?).into_response())
}

/// Something about the run that this process makes.
pub(super) async fn act(
    app: App,
    run: String,
    act: impl FnOnce(&dyn RunControl, &Index) -> Result<(), Problem> + Send + 'static,
) -> ControlResult {
    let role = app.role.clone();
    app.with_run(run, move |run| {
        let control = match &role {
            Capabilities::Runner(own, control) if *own == run.name => control,
            Capabilities::Runner(..) => return Err(foreign()),
            Capabilities::Viewer(_) => {
                return Err(Problem::conflict("only the whole run can be stopped here")
                    .hint("`rtf run --web` stops tests and suites of its run, one by one"));
            }
        };
        let index = run.read()?;
        if index.state().is_over() {
            return Err(over());
        }
        act(&**control, &index)?;
        accepted(&Accepted { accepted: true })
    })
    .await
}

fn foreign() -> Problem {
    Problem::conflict("this server does not make this run")
        .hint("a run is controlled by the `rtf run --web` that makes it, or the `rtf serve` that started it")
}

fn over() -> Problem {
    Problem::conflict("the run is over")
}

/// Ends the run as SIGINT does.
#[utoipa::path(post, path = "/runs/{run}/stop", tag = "control", params(("run" = String, Path)),
    responses((status = 202, body = Accepted), ChangeProblems))]
pub async fn stop_run(State(app): State<App>, At(run): At<String>) -> ControlResult {
    let Capabilities::Viewer(starter) = app.role.clone() else {
        let stop = |control: &dyn RunControl, _: &Index| {
            control.stop_run();
            Ok(())
        };
        return act(app, run, stop).await;
    };
    app.with_run(run, move |run| {
        if starter.started().as_ref() != Some(&run.name) {
            return Err(if run.read()?.state().is_over() { over() } else { foreign() });
        }
        starter.stop();
        accepted(&Accepted { accepted: true })
    })
    .await
}

/// Stops a test that runs, and skips its remaining repetitions.
#[utoipa::path(post, path = "/runs/{run}/tests/{test}/stop", tag = "control",
    params(("run" = String, Path), ("test" = u32, Path)),
    responses((status = 202, body = Accepted), ChangeProblems))]
pub async fn stop_test(
    State(app): State<App>,
    At((run, test)): At<(String, u32)>,
) -> ControlResult {
    act(app, run, move |control, index| {
        if !entry(&index.record.tests, test, "test")?.is_running() {
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
pub async fn skip_suite(
    State(app): State<App>,
    At((run, suite)): At<(String, u32)>,
) -> ControlResult {
    act(app, run, move |control, index| {
        if entry(&index.record.suites, suite, "suite")?.finished.is_some() {
            return Err(Problem::conflict(format!("suite {suite} is over")));
        }
        control.skip_suite(SuiteId(suite));
        Ok(())
    })
    .await
}

/// Runs the tests of a past run that failed again, as a new run.
#[utoipa::path(post, path = "/runs/{run}/rerun", tag = "control", params(("run" = String, Path)),
    responses((status = 202, body = Started), ChangeProblems))]
pub async fn rerun(State(app): State<App>, At(run): At<String>) -> ControlResult {
    let (role, runs) = (app.role.clone(), app.runs.clone());
    app.with_run(run, move |run| match role {
        Capabilities::Viewer(starter) => start(run, &runs, &*starter),
        Capabilities::Runner(..) => {
            Err(Problem::conflict("this server makes one run, and no other")
                .hint("`rtf serve` runs failed tests again"))
        }
    })
    .await
}

fn start(run: &Run, runs: &Runs, starter: &dyn RunStarter) -> ControlResult {
    if run.is_of_worker() {
        return Err(Problem::conflict("the run is a part of a campaign")
            .hint("the page of the campaign has the commands that repeat its episodes"));
    }
    let folder = {
        let index = run.read()?;
        if !index.state().is_over() {
            return Err(Problem::conflict("the run goes on"));
        }
        let started = index.record.run.as_ref();
        let started = started.ok_or_else(|| Problem::conflict("its journal has no beginning"))?;
        started.working_dir.clone()
    };
    if let Some(other) = runs.current() {
        return Err(Problem::conflict(format!("the run `{other}` goes on")));
    }
    let past = FinishedRun { name: &run.name, folder: Path::new(&folder) };
    let name = starter
        .rerun_failed(&past)
        .map_err(|RerunRejected { reason, hint }| Problem { hint, ..Problem::conflict(reason) })?;
    accepted(&Started { accepted: true, run: name })
}
