//! Results over time: questions to the history.

mod selection;
mod types;

use rtf_history::answers::FlakyTests;
use rtf_history::{Store, TestAttributes};
use serde::Deserialize;
use utoipa::IntoParams;

use self::selection::{HistoryQuery, HistoryRequest, Selection, answer};
use self::types::{
    HistoryCampaigns, HistoryChange, HistoryComparison, HistoryMatrix, HistoryRuns, SeriesTrend,
    SlowTests, TestHistories,
};
use super::problems::Problems;
use super::query::{QueryParams, limit};
use crate::app::JsonResult;
use crate::problem::Problem;

/// Default number of tests per page.
const PAGE: usize = 100;

/// A page of a matrix or of a list.
#[derive(Clone, Copy, Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct TestPage {
    /// The `next` of the page before.
    #[param(maximum = 4_294_967_295_i64)]
    after: Option<u32>,
    /// How many tests at most.
    #[param(minimum = 1, maximum = 1000, default = 100)]
    limit: Option<usize>,
}

/// The most entries of a list.
#[derive(Clone, Copy, Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct Most {
    /// How many tests at most.
    #[param(minimum = 1, maximum = 1000, default = 100)]
    limit: Option<usize>,
}

/// A test.
#[derive(Clone, Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct NamedTest {
    /// `SUITE/TEST` or `SUITE/TEST::CASE`.
    test: String,
}

/// A measurement or signal.
#[derive(Clone, Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct NamedSeries {
    /// The name of the measurement or signal.
    series: String,
    /// Only of this test.
    test: Option<String>,
}

/// Two sets of runs.
#[derive(Clone, Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct Sides {
    /// `latest`, a run, or `branch:NAME`, `commit:HASH`, `robot:NAME`, `host:NAME`,
    /// `profile:NAME`.
    a: String,
    /// The same, for the other side.
    b: String,
}

fn not_found(detail: String, hint: &str) -> Problem {
    Problem::not_found(detail).hint(hint)
}

/// The runs of the history, the newest first.
#[utoipa::path(get, path = "/history/runs", tag = "history", operation_id = "history_runs",
    params(HistoryQuery), responses((status = 200, body = HistoryRuns), Problems))]
pub async fn runs(request: HistoryRequest) -> JsonResult {
    answer(request, |store, selection| Ok(HistoryRuns { runs: store.runs(&selection.runs)? })).await
}

/// The verdicts of tests in runs, one letter per result.
#[utoipa::path(get, path = "/history/matrix", tag = "history", operation_id = "history_matrix",
    params(HistoryQuery, TestPage), responses((status = 200, body = HistoryMatrix), Problems))]
pub async fn matrix(
    request: HistoryRequest,
    QueryParams(page): QueryParams<TestPage>,
) -> JsonResult {
    let limit = limit(page.limit, PAGE)?;
    answer(request, move |store, selection| {
        let after = page.after.unwrap_or(0) as usize;
        let end = after.saturating_add(limit);
        let lists = |test: &TestAttributes| selection.lists(test);
        let matrix = store.verdict_matrix(&selection.runs, &lists, after..end)?;
        Ok(HistoryMatrix::of(matrix, end))
    })
    .await
}

/// Verdicts, durations, measurements and signals of a test over runs.
#[utoipa::path(get, path = "/history/test", tag = "history", operation_id = "history_test",
    params(HistoryQuery, NamedTest), responses((status = 200, body = TestHistories), Problems))]
pub async fn test(
    request: HistoryRequest,
    QueryParams(named): QueryParams<NamedTest>,
) -> JsonResult {
    answer(request, move |store, selection| {
        let is_meant = |test: &TestAttributes| {
            test.identity.to_string() == named.test && selection.matches(test)
        };
        let tests = store.test_histories(&selection.runs, &is_meant)?;
        if tests.is_empty() {
            let detail = format!("no selected run has a result of the test `{}`", named.test);
            return Err(not_found(detail, "a test is named `SUITE/TEST` or `SUITE/TEST::CASE`"));
        }
        let changes = changes(store, selection, &is_meant)?;
        Ok(TestHistories { tests, changes })
    })
    .await
}

fn changes(
    store: &Store,
    selection: &Selection,
    is_meant: &dyn Fn(&TestAttributes) -> bool,
) -> Result<Vec<HistoryChange>, Problem> {
    let changes = store.changes(&selection.runs, is_meant)?;
    Ok(changes.into_iter().map(HistoryChange::from).collect())
}

/// A measurement or signal over runs, with its change points.
#[utoipa::path(get, path = "/history/trend", tag = "history", operation_id = "history_trend",
    params(HistoryQuery, NamedSeries), responses((status = 200, body = SeriesTrend), Problems))]
pub async fn trend(
    request: HistoryRequest,
    QueryParams(named): QueryParams<NamedSeries>,
) -> JsonResult {
    answer(request, move |store, selection| {
        let is_named = |name: String| named.test.as_ref().is_none_or(|wanted| *wanted == name);
        let is_meant =
            |test: &TestAttributes| is_named(test.identity.to_string()) && selection.matches(test);
        let series = store.trend(&named.series, None, &selection.runs, &is_meant)?;
        if series.is_empty() {
            let detail = format!("no selected test measures `{}`", named.series);
            return Err(not_found(detail, "`rtf history show TEST` lists its measurements"));
        }
        let measures =
            |test: &TestAttributes| series.iter().any(|series| series.identity == test.identity);
        let mut changes = changes(store, selection, &measures)?;
        changes.retain(|it| it.series.as_ref().is_some_and(|it| it.name == named.series));
        Ok(SeriesTrend { series, changes })
    })
    .await
}

/// The rates of campaigns over commits, and since when they are different. The filter, the robot
/// and cases have no effect.
#[utoipa::path(get, path = "/history/campaigns", tag = "history", operation_id = "history_campaigns",
    params(HistoryQuery), responses((status = 200, body = HistoryCampaigns), Problems))]
pub async fn campaigns(request: HistoryRequest) -> JsonResult {
    answer(request, |store, selection| {
        let rates = store.campaign_rates(&selection.runs, None)?;
        let changes = store.campaign_changes(&selection.runs)?;
        Ok(HistoryCampaigns { rates, changes })
    })
    .await
}

/// Tests that both passed and failed on one commit, with equal sources, or in one run, the most
/// flaky first.
#[utoipa::path(get, path = "/history/flaky", tag = "history", operation_id = "history_flaky",
    params(HistoryQuery, Most), responses((status = 200, body = FlakyTests), Problems))]
pub async fn flaky(request: HistoryRequest, QueryParams(most): QueryParams<Most>) -> JsonResult {
    let limit = limit(most.limit, PAGE)?;
    answer(request, move |store, selection| {
        let mut flaky = store.flaky(&selection.runs, &|test| selection.lists(test))?;
        flaky.tests.truncate(limit);
        Ok(flaky)
    })
    .await
}

/// Tests by median duration, the slowest first.
#[utoipa::path(get, path = "/history/slow", tag = "history", operation_id = "history_slow",
    params(HistoryQuery, Most), responses((status = 200, body = SlowTests), Problems))]
pub async fn slow(request: HistoryRequest, QueryParams(most): QueryParams<Most>) -> JsonResult {
    let limit = limit(most.limit, PAGE)?;
    answer(request, move |store, selection| {
        let mut tests = store.slow(&selection.runs, &|test| selection.lists(test))?;
        tests.truncate(limit);
        Ok(SlowTests { tests })
    })
    .await
}

/// Differences between two sets of runs.
#[utoipa::path(get, path = "/history/compare", tag = "history", operation_id = "history_compare",
    params(HistoryQuery, Sides), responses((status = 200, body = HistoryComparison), Problems))]
pub async fn compare(
    request: HistoryRequest,
    QueryParams(sides): QueryParams<Sides>,
) -> JsonResult {
    answer(request, move |store, selection| {
        let side = |name: &str| store.comparison_side(name, &selection.runs);
        let (a, b) = (side(&sides.a)?, side(&sides.b)?);
        let comparison = store.compare((&a, &b), &|test| selection.lists(test))?;
        for (name, runs) in [(&sides.a, comparison.runs_a), (&sides.b, comparison.runs_b)] {
            if runs == 0 {
                let detail = format!("no run of the history matches `{name}`");
                return Err(not_found(detail, "`GET /api/v1/history/runs` lists the runs"));
            }
        }
        Ok(HistoryComparison { comparison })
    })
    .await
}
