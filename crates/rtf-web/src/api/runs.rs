//! Runs as a whole.

use axum::extract::State;
use serde::Deserialize;
use utoipa::IntoParams;

use super::asked::{Asked, At, limit};
use super::problems::Problems;
use super::types::{RunInfo, RunList, Snapshot};
use crate::app::{App, JsonText, blocking};
use crate::problem::Problem;

/// How many runs a page has when nobody says so.
const PAGE: usize = 50;

/// Which runs.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct Which {
    /// Only runs that are older than the one of this name.
    before: Option<String>,
    /// How many at most.
    #[param(minimum = 1, maximum = 1000, default = 50)]
    limit: Option<usize>,
}

/// All runs, the newest first.
#[utoipa::path(get, path = "/runs", tag = "runs", params(Which),
    responses((status = 200, body = RunList), Problems))]
pub async fn list(State(app): State<App>, Asked(which): Asked<Which>) -> Result<JsonText, Problem> {
    let limit = limit(which.limit, PAGE)?;
    blocking(move || {
        let (runs, next) = app.runs.list(which.before.as_deref(), limit);
        JsonText::of(&RunList { runs, next })
    })
    .await
}

/// A run as a whole.
#[utoipa::path(get, path = "/runs/{run}", tag = "runs",
    params(("run" = String, Path, description = "its name, `latest` or `current`")),
    responses((status = 200, body = RunInfo), Problems))]
pub async fn run(State(app): State<App>, At(run): At<String>) -> Result<JsonText, Problem> {
    app.read(run, |run, index| Ok(RunInfo::of(&run.name, index))).await
}

/// All that a page needs to draw a run, without messages and outputs.
#[utoipa::path(get, path = "/runs/{run}/snapshot", tag = "runs",
    params(("run" = String, Path, description = "its name, `latest` or `current`")),
    responses((status = 200, body = Snapshot), Problems))]
pub async fn snapshot(State(app): State<App>, At(run): At<String>) -> Result<JsonText, Problem> {
    app.read(run, |run, index| Ok(Snapshot::of(&run.name, index))).await
}
