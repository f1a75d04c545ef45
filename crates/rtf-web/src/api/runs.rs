//! Runs as a whole.

use axum::extract::State;
use serde::Deserialize;
use utoipa::IntoParams;

use super::problems::Problems;
use super::query::{At, QueryParams, limit};
use crate::app::{App, JsonResult, JsonText, blocking};
use crate::runs::RunFilter;
use crate::views::{RunInfo, RunList, Snapshot};

/// Default number of runs per page.
const PAGE: usize = 50;

/// A page of the list.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct RunPage {
    /// Only runs that are older than the one of this name.
    before: Option<String>,
    /// How many at most.
    #[param(minimum = 1, maximum = 1000, default = 50)]
    limit: Option<usize>,
}

/// All runs, the newest first.
#[utoipa::path(get, path = "/runs", tag = "runs", params(RunPage, RunFilter),
    responses((status = 200, body = RunList), Problems))]
pub async fn list(
    State(app): State<App>,
    QueryParams(page): QueryParams<RunPage>,
    QueryParams(filter): QueryParams<RunFilter>,
) -> JsonResult {
    let limit = limit(page.limit, PAGE)?;
    filter.check()?;
    blocking(move || JsonText::of(&app.runs.list(page.before.as_deref(), limit, &filter))).await
}

/// A run as a whole.
#[utoipa::path(get, path = "/runs/{run}", tag = "runs",
    params(("run" = String, Path, description = "its name, `latest` or `current`")),
    responses((status = 200, body = RunInfo), Problems))]
pub async fn run(State(app): State<App>, At(run): At<String>) -> JsonResult {
    app.read(run, |run, index| Ok(RunInfo::of(&run.name, index))).await
}

/// All that a page needs to draw a run, without messages and outputs.
#[utoipa::path(get, path = "/runs/{run}/snapshot", tag = "runs",
    params(("run" = String, Path, description = "its name, `latest` or `current`")),
    responses((status = 200, body = Snapshot), Problems))]
pub async fn snapshot(State(app): State<App>, At(run): At<String>) -> JsonResult {
    app.read(run, |run, index| Ok(Snapshot::of(&run.name, index))).await
}
