//! Suites, fixtures and hooks of a run.

use axum::extract::State;

use super::problems::Problems;
use super::query::At;
use crate::app::{App, JsonResult};
use crate::problem::Problem;
use crate::views::{Fixture, Fixtures, Hook, Hooks, Suite, Suites};

/// The entry of a list with this id.
pub fn entry<'a, T>(list: &'a [T], id: u32, what: &str) -> Result<&'a T, Problem> {
    let index = usize::try_from(id).unwrap_or(usize::MAX);
    list.get(index)
        .ok_or_else(|| Problem::not_found(format!("there is no {what} {id} in this run")))
}

/// All suites.
#[utoipa::path(get, path = "/runs/{run}/suites", tag = "plan", params(("run" = String, Path)),
    responses((status = 200, body = Suites), Problems))]
pub async fn suites(State(app): State<App>, At(run): At<String>) -> JsonResult {
    app.read(run, |_, index| {
        let (record, over) = (&index.record, index.state().is_over());
        let suites = record.suites.iter().map(|suite| Suite::of(suite, record, over));
        Ok(Suites { suites: suites.collect() })
    })
    .await
}

/// One suite.
#[utoipa::path(get, path = "/runs/{run}/suites/{suite}", tag = "plan",
    params(("run" = String, Path), ("suite" = u32, Path)),
    responses((status = 200, body = Suite), Problems))]
pub async fn suite(State(app): State<App>, At((run, suite)): At<(String, u32)>) -> JsonResult {
    app.read(run, move |_, index| {
        let (record, over) = (&index.record, index.state().is_over());
        Ok(Suite::of(entry(&record.suites, suite, "suite")?, record, over))
    })
    .await
}

/// All fixtures.
#[utoipa::path(get, path = "/runs/{run}/fixtures", tag = "plan", params(("run" = String, Path)),
    responses((status = 200, body = Fixtures), Problems))]
pub async fn fixtures(State(app): State<App>, At(run): At<String>) -> JsonResult {
    app.read(run, |_, index| {
        Ok(Fixtures { fixtures: index.record.fixtures.iter().map(Fixture::of).collect() })
    })
    .await
}

/// One fixture.
#[utoipa::path(get, path = "/runs/{run}/fixtures/{fixture}", tag = "plan",
    params(("run" = String, Path), ("fixture" = u32, Path)),
    responses((status = 200, body = Fixture), Problems))]
pub async fn fixture(State(app): State<App>, At((run, id)): At<(String, u32)>) -> JsonResult {
    app.read(run, move |_, index| Ok(Fixture::of(entry(&index.record.fixtures, id, "fixture")?)))
        .await
}

/// All hooks.
#[utoipa::path(get, path = "/runs/{run}/hooks", tag = "plan", params(("run" = String, Path)),
    responses((status = 200, body = Hooks), Problems))]
pub async fn hooks(State(app): State<App>, At(run): At<String>) -> JsonResult {
    app.read(run, |_, index| Ok(Hooks { hooks: index.record.hooks.iter().map(Hook::of).collect() }))
        .await
}

/// One hook.
#[utoipa::path(get, path = "/runs/{run}/hooks/{hook}", tag = "plan",
    params(("run" = String, Path), ("hook" = u32, Path)),
    responses((status = 200, body = Hook), Problems))]
pub async fn hook(State(app): State<App>, At((run, id)): At<(String, u32)>) -> JsonResult {
    app.read(run, move |_, index| Ok(Hook::of(entry(&index.record.hooks, id, "hook")?))).await
}
