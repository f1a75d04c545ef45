//! Runs as a whole.

use axum::extract::State;
use serde::Deserialize;
use utoipa::IntoParams;

use super::problems::Problems;
use super::query::{At, QueryParams, limit};
use crate::app::{App, JsonText, blocking};
use crate::problem::Problem;
use crate::runs::{Listing, RunFilter, RunResult};
use crate::views::{RunInfo, RunList, Snapshot};

/// Default number of runs per page.
const PAGE: usize = 50;

/// Which runs.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct RunQuery {
    /// Only runs that are older than the one of this name.
    before: Option<String>,
    /// How many at most.
    #[param(minimum = 1, maximum = 1000, default = 50)]
    limit: Option<usize>,
    /// Runs with all of these words in their name, command, suites, commit, branch,
    /// robot or profile, in upper or lower case.
    q: Option<String>,
    /// Runs with this result, or still running.
    #[param(inline)]
    result: Option<RunResult>,
    /// Runs with a suite of this name.
    suite: Option<String>,
    /// Runs of this branch.
    branch: Option<String>,
    /// Runs of the commit whose hash begins so.
    #[param(pattern = "^[0-9A-Fa-f]{4,64}$")]
    commit: Option<String>,
    /// Runs for this robot.
    robot: Option<String>,
    /// Runs with this profile.
    profile: Option<String>,
    /// Runs that started on this day or later, in their own time zone.
    #[param(pattern = "^[0-9]{4}-[0-9]{2}-[0-9]{2}$")]
    since: Option<String>,
    /// Runs that started on this day or before.
    #[param(pattern = "^[0-9]{4}-[0-9]{2}-[0-9]{2}$")]
    until: Option<String>,
}

impl RunQuery {
    fn filter(self) -> Result<RunFilter, Problem> {
        let is_hash = |text: &String| {
            (4..=64).contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_hexdigit())
        };
        if let Some(commit) = self.commit.as_ref().filter(|text| !is_hash(text)) {
            let expected = "expected 4 to 64 hexadecimal digits";
            return Err(Problem::bad_request(format!("`commit` is `{commit}`, {expected}")));
        }
        for (name, day) in [("since", &self.since), ("until", &self.until)] {
            if let Some(day) = day.as_ref().filter(|day| !is_day(day)) {
                let expected = "expected a day like `2026-11-21`";
                return Err(Problem::bad_request(format!("`{name}` is `{day}`, {expected}")));
            }
        }
        let words = self.q.unwrap_or_default().to_lowercase();
        Ok(RunFilter {
            words: words.split_whitespace().map(str::to_owned).collect(),
            result: self.result,
            suite: self.suite,
            branch: self.branch,
            commit: self.commit.map(|commit| commit.to_ascii_lowercase()),
            robot: self.robot,
            profile: self.profile,
            since: self.since,
            until: self.until,
        })
    }
}

fn is_day(text: &str) -> bool {
    let bytes = text.as_bytes();
    let digits = |mut range: std::ops::Range<usize>| range.all(|n| bytes[n].is_ascii_digit());
    bytes.len() == 10
        && (bytes[4], bytes[7]) == (b'-', b'-')
        && digits(0..4)
        && digits(5..7)
        && digits(8..10)
}

/// All runs, the newest first.
#[utoipa::path(get, path = "/runs", tag = "runs", params(RunQuery),
    responses((status = 200, body = RunList), Problems))]
pub async fn list(
    State(app): State<App>,
    QueryParams(which): QueryParams<RunQuery>,
) -> Result<JsonText, Problem> {
    let limit = limit(which.limit, PAGE)?;
    let before = which.before.clone();
    let filter = which.filter()?;
    blocking(move || {
        let Listing { runs, next, unread } = app.runs.list(before.as_deref(), limit, &filter);
        JsonText::of(&RunList { runs, next, unread })
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
