//! The cases of one attempt of a test.

use axum::extract::State;
use rtf_model::{AttemptCases, CaseRecord};
use serde::Deserialize;
use utoipa::IntoParams;

use super::details::Path3;
use super::plan::entry;
use super::problems::Problems;
use super::query::{At, QueryParams, limit, verdicts};
use crate::app::{App, JsonResult};
use crate::problem::Problem;
use crate::views::{Case, Cases};

/// Default number of cases per page.
const PAGE: usize = 100;

/// Which cases.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct CaseQuery {
    /// Cases with one of these verdicts, separated by commas.
    #[param(
        pattern = "^(passed|failed|error|crashed|timed-out|collapsed|skipped|interrupted)(,(passed|failed|error|crashed|timed-out|collapsed|skipped|interrupted))*$"
    )]
    verdict: Option<String>,
    /// The `next` of the page before.
    #[param(maximum = 4_294_967_295_i64)]
    after: Option<u32>,
    /// How many at most.
    #[param(minimum = 1, maximum = 1000, default = 100)]
    limit: Option<usize>,
}

impl CaseQuery {
    fn page(&self, cases: &AttemptCases) -> Result<Cases, Problem> {
        let limit = limit(self.limit, PAGE)?;
        let verdicts = verdicts(self.verdict.as_deref())?;
        let has_verdict = |case: &&CaseRecord| {
            let verdict = case.verdict();
            verdicts.as_ref().is_none_or(|list| verdict.is_some_and(|it| list.contains(&it)))
        };
        let after = self.after.unwrap_or(0);
        let start = cases.kept().partition_point(|case| case.start.case.0 <= after);
        let rest = cases.kept().get(start..).unwrap_or_default();
        let mut matching = rest.iter().filter(has_verdict);
        let page: Vec<_> = matching.by_ref().take(limit).map(Case::of).collect();
        let next = page.last().map(|case| case.case).filter(|_| matching.next().is_some());
        let names = cases.not_run().names().take(limit).map(str::to_owned);
        let lists_planned = next.is_none() && verdicts.is_none();
        let not_run = if lists_planned { names.collect() } else { Vec::new() };
        Ok(Cases { cases: page, next, omitted: cases.omitted(), not_run })
    }
}

/// The cases of an attempt of a test.
#[utoipa::path(get, path = "/runs/{run}/tests/{test}/attempts/{number}/cases", tag = "details",
    params(("run" = String, Path), ("test" = u32, Path), ("number" = u32, Path), CaseQuery),
    responses((status = 200, body = Cases), Problems))]
pub async fn cases(
    State(app): State<App>,
    At((run, test, number)): Path3,
    QueryParams(query): QueryParams<CaseQuery>,
) -> JsonResult {
    app.read(run, move |_, index| {
        let record = entry(&index.record.tests, test, "test")?;
        let attempt = usize::try_from(number).ok().and_then(|number| number.checked_sub(1));
        let attempt = attempt.and_then(|index| record.attempts.get(index));
        let missing = || Problem::not_found(format!("there is no attempt {number} of test {test}"));
        query.page(&attempt.ok_or_else(missing)?.cases)
    })
    .await
}
