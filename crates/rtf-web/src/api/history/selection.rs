//! Which runs and tests a question to the history is about.

use std::sync::Arc;

use axum::extract::FromRequestParts;
use axum::http::StatusCode;
use axum::http::request::Parts;
use rtf_history::{RunSelection, Store, StoreError, TestAttributes};
use serde::{Deserialize, Deserializer};
use utoipa::IntoParams;

use crate::api::query::QueryParams;
use crate::app::{App, JsonResult, JsonText, blocking};
use crate::history_source::{HistorySource, TestCondition};
use crate::problem::Problem;

/// The largest value of `last`.
const MOST_RUNS: u32 = 1_000_000;

/// Which runs and tests.
#[derive(Clone, Debug, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct HistoryQuery {
    /// Only tests that match, as `-E` on the command line.
    #[serde(default, deserialize_with = "text")]
    filter: Option<String>,
    /// Only runs of this branch.
    #[serde(default, deserialize_with = "text")]
    branch: Option<String>,
    /// Only runs of commits whose hash begins so.
    #[serde(default, deserialize_with = "text")]
    commit: Option<String>,
    /// Only results of suites that require this resource.
    #[serde(default, deserialize_with = "text")]
    robot: Option<String>,
    /// Only runs with this profile.
    #[serde(default, deserialize_with = "text")]
    profile: Option<String>,
    /// Only runs on this machine.
    #[serde(default, deserialize_with = "text")]
    host: Option<String>,
    /// Only runs since a date or within a time: `2026-11-01`, `30d`.
    #[serde(default, deserialize_with = "text")]
    #[param(
        pattern = "^(20[0-9]{2}-(0[1-9]|1[0-2])-(0[1-9]|1[0-9]|2[0-8])|[1-9][0-9]{0,3}[dh])?$"
    )]
    since: Option<String>,
    /// Only the newest of the remaining runs.
    #[param(minimum = 1, maximum = 1_000_000)]
    last: Option<u32>,
    /// Whether cases are included.
    cases: Option<bool>,
}

/// A text; an empty one is none.
fn text<'de, D: Deserializer<'de>>(input: D) -> Result<Option<String>, D::Error> {
    Ok(Option::<String>::deserialize(input)?.filter(|text| !text.is_empty()))
}

/// The resolved query.
pub struct Selection {
    pub runs: RunSelection,
    filter: Option<TestCondition>,
    cases: bool,
}

impl Selection {
    fn of(query: HistoryQuery, source: &dyn HistorySource) -> Result<Self, Problem> {
        let bad = |name: &str, error: String| Problem::bad_request(format!("`{name}`: {error}"));
        let since = query.since.map(|text| source.parse_since(&text)).transpose();
        let filter = query.filter.map(|text| source.parse_filter(&text)).transpose();
        if let Some(last) = query.last.filter(|last| !(1..=MOST_RUNS).contains(last)) {
            let expected = format!("expected a number from 1 to {MOST_RUNS}");
            return Err(Problem::bad_request(format!("`last` is {last}, {expected}")));
        }
        let runs = RunSelection {
            branch: query.branch,
            commit: query.commit,
            robot: query.robot,
            profile: query.profile,
            host: query.host,
            since: since.map_err(|error| bad("since", error))?,
            last: query.last.map(|last| last as usize),
            ids: None,
        };
        let filter = filter.map_err(|error| bad("filter", error))?;
        Ok(Self { runs, filter, cases: query.cases.unwrap_or(false) })
    }

    /// Whether a test matches the filter.
    pub fn matches(&self, test: &TestAttributes) -> bool {
        self.filter.as_ref().is_none_or(|filter| filter(test))
    }

    /// Whether a test matches the filter, and is no case if those are not included.
    pub fn lists(&self, test: &TestAttributes) -> bool {
        (self.cases || test.identity.case.is_empty()) && self.matches(test)
    }
}

/// A request for an answer about some runs and tests.
pub struct HistoryRequest {
    source: Arc<dyn HistorySource>,
    query: HistoryQuery,
}

impl FromRequestParts<App> for HistoryRequest {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, app: &App) -> Result<Self, Problem> {
        let QueryParams(query) = QueryParams::from_request_parts(parts, app).await?;
        Ok(Self { source: app.history.clone(), query })
    }
}

/// Answers a request in a thread that may block.
///
/// # Errors
/// The query is wrong, the history cannot be read, or `view` has no answer.
pub async fn answer<T: serde::Serialize>(
    HistoryRequest { source, query }: HistoryRequest,
    view: impl FnOnce(&Store, &Selection) -> Result<T, Problem> + Send + 'static,
) -> JsonResult {
    blocking(move || {
        let selection = Selection::of(query, source.as_ref())?;
        let value = view(&source.open()?, &selection)?;
        JsonText::of(&value)
    })
    .await
}

impl From<StoreError> for Problem {
    fn from(error: StoreError) -> Self {
        let status = match error {
            StoreError::Missing { .. } => StatusCode::NOT_FOUND,
            _ => StatusCode::SERVICE_UNAVAILABLE,
        };
        let mut detail = error.to_string();
        if let Some(cause) = std::error::Error::source(&error) {
            detail += &format!(": {cause}");
        }
        Self { hint: error.hint().map(str::to_owned), ..Self::new(status, detail) }
    }
}
