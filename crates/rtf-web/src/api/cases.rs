//! The cases of one attempt of a test.

use std::ops::ControlFlow;

use axum::extract::State;
use rtf_model::{AttemptCases, CaseId, CaseRecord};
use serde::Deserialize;
use utoipa::IntoParams;

use super::case_filter::CaseReader;
use super::details::{DetailQuery, Path3};
use super::plan::entry;
use super::problems::Problems;
use super::query::{At, QueryParams, limit, verdicts};
use crate::app::{App, JsonResult, JsonText};
use crate::problem::Problem;
use crate::runs::Run;
use crate::views::{Case, Cases};

/// Default number of cases per page.
const PAGE: usize = 100;

/// Which cases.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct CaseQuery {
    /// Only this case and the cases that it contains, also if the run does not keep them.
    #[param(maximum = 4_294_967_295_i64)]
    case: Option<u32>,
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
    /// A page of these cases, and the number after which the next one starts.
    fn page(&self, all: &[CaseRecord]) -> Result<(Vec<Case>, Option<u32>), Problem> {
        let limit = limit(self.limit, PAGE)?;
        let verdicts = verdicts(self.verdict.as_deref())?;
        let has_verdict = |case: &&CaseRecord| {
            let verdict = case.verdict();
            verdicts.as_ref().is_none_or(|list| verdict.is_some_and(|it| list.contains(&it)))
        };
        let after = self.after.unwrap_or(0);
        let start = all.partition_point(|case| case.start.case.0 <= after);
        let mut matching = all.get(start..).unwrap_or_default().iter().filter(has_verdict);
        let page: Vec<_> = matching.by_ref().take(limit).map(Case::of).collect();
        let next = page.last().map(|case| case.case).filter(|_| matching.next().is_some());
        Ok((page, next))
    }

    /// A page of the cases that the run keeps.
    fn kept(&self, cases: &AttemptCases) -> Result<Cases, Problem> {
        let (page, next) = self.page(cases.kept())?;
        let names = cases.not_run().names().take(limit(self.limit, PAGE)?).map(str::to_owned);
        let lists_planned = next.is_none() && self.verdict.is_none();
        let not_run = if lists_planned { names.collect() } else { Vec::new() };
        Ok(Cases { cases: page, next, omitted: cases.omitted(), not_run })
    }

    /// A page of a case and those that it contains, from the journal.
    fn inside(&self, run: &Run, part: &DetailQuery, case: CaseId) -> Result<Cases, Problem> {
        let mut reader = CaseReader::new(case);
        part.each(run, |event, _| match reader.add(event) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        })?;
        let (cases, next) = self.page(&reader.into_cases()?)?;
        Ok(Cases { cases, next, omitted: 0, not_run: Vec::new() })
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
    if let Some(case) = query.case {
        let part = DetailQuery::cases_of(test, number);
        let inside = move |run: &Run| query.inside(run, &part, CaseId(case));
        return app.with_run(run, move |run| JsonText::of(&inside(run)?)).await;
    }
    app.read(run, move |_, index| {
        let record = entry(&index.record.tests, test, "test")?;
        let attempt = usize::try_from(number).ok().and_then(|number| number.checked_sub(1));
        let attempt = attempt.and_then(|index| record.attempts.get(index));
        let missing = || Problem::not_found(format!("there is no attempt {number} of test {test}"));
        query.kept(&attempt.ok_or_else(missing)?.cases)
    })
    .await
}
