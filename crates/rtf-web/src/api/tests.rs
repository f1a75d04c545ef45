//! The tests of a run.

use axum::extract::State;
use rtf_model::{CaseRecord, Record, TestRecord, Verdict};
use serde::Deserialize;
use utoipa::IntoParams;

use super::plan::entry;
use super::problems::Problems;
use super::query::{At, QueryParams, limit, verdicts};
use crate::app::{App, JsonResult};
use crate::problem::Problem;
use crate::views::{Test, TestDetail, TestPage, TestState};

/// Default number of tests per page.
const PAGE: usize = 100;

/// Which tests. All conditions hold.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct Which {
    /// Tests of this suite.
    #[param(maximum = 4_294_967_295_i64)]
    suite: Option<u32>,
    /// Tests in this state.
    #[param(inline)]
    state: Option<TestState>,
    /// Tests with one of these verdicts, separated by commas.
    #[param(
        pattern = "^(passed|failed|error|crashed|timed-out|collapsed|skipped|interrupted)(,(passed|failed|error|crashed|timed-out|collapsed|skipped|interrupted))*$"
    )]
    verdict: Option<String>,
    /// Tests with this tag.
    tag: Option<String>,
    /// Tests with this in `suite/name`, in upper or lower case.
    q: Option<String>,
    /// Tests with a case whose path contains all these words, in upper or lower case.
    /// Passed cases that are only counted are not searched.
    case: Option<String>,
    /// The `next` of the page before.
    #[param(maximum = 4_294_967_295_i64)]
    after: Option<u32>,
    /// How many at most.
    #[param(minimum = 1, maximum = 1000, default = 100)]
    limit: Option<usize>,
}

impl Which {
    fn matches(&self, (test, found): &(Test, &TestRecord), verdicts: Option<&[Verdict]>) -> bool {
        let verdict = test.verdict;
        self.suite.is_none_or(|suite| suite == test.suite)
            && self.state.is_none_or(|state| state == test.state)
            && verdicts.is_none_or(|list| verdict.is_some_and(|it| list.contains(&it)))
            && self.tag.as_ref().is_none_or(|tag| test.tags.contains(tag))
            && self.case.as_ref().is_none_or(|case| has_case(found, case))
    }

    fn has_name(&self, test: &Test, record: &Record) -> bool {
        let Some(q) = &self.q else { return true };
        let suite = record.suites.get(test.suite as usize);
        let suite = suite.map_or("", |suite| &suite.plan.name);
        format!("{suite}/{}", test.name).to_lowercase().contains(&q.to_lowercase())
    }

    fn page(&self, record: &Record, over: bool) -> Result<TestPage, Problem> {
        let limit = limit(self.limit, PAGE)?;
        let verdicts = verdicts(self.verdict.as_deref())?;
        let matches = |test: &(Test, &TestRecord)| {
            self.matches(test, verdicts.as_deref()) && self.has_name(&test.0, record)
        };
        let (mut page, mut more) = (TestPage { tests: Vec::new(), total: 0, next: None }, false);
        let all = record.tests.iter().map(|test| (Test::of(test, record, over), test));
        for (test, _) in all.filter(matches) {
            page.total += 1;
            let wanted = self.after.is_none_or(|after| test.id > after);
            match wanted && page.tests.len() < limit {
                true => page.tests.push(test),
                false => more |= wanted,
            }
        }
        page.next = page.tests.last().filter(|_| more).map(|test| test.id);
        Ok(page)
    }
}

/// Whether a kept case has all these words in its path.
fn has_case(test: &TestRecord, words: &str) -> bool {
    let words = words.to_lowercase();
    let has_words = |case: &CaseRecord| {
        let path = case.path.to_lowercase();
        words.split_whitespace().all(|word| path.contains(word))
    };
    test.attempts.iter().flat_map(|attempt| attempt.cases.kept()).any(has_words)
}

/// Tests, filtered, page by page.
#[utoipa::path(get, path = "/runs/{run}/tests", tag = "tests",
    params(("run" = String, Path), Which),
    responses((status = 200, body = TestPage), Problems))]
pub async fn list(
    State(app): State<App>,
    At(run): At<String>,
    QueryParams(which): QueryParams<Which>,
) -> JsonResult {
    app.read(run, move |_, index| which.page(&index.record, index.state().is_over())).await
}

/// One test with its attempts.
#[utoipa::path(get, path = "/runs/{run}/tests/{test}", tag = "tests",
    params(("run" = String, Path), ("test" = u32, Path)),
    responses((status = 200, body = TestDetail), Problems))]
pub async fn test(State(app): State<App>, At((run, test)): At<(String, u32)>) -> JsonResult {
    let commands = app.commands;
    app.read(run, move |run, index| {
        let record = &index.record;
        let test = entry(&record.tests, test, "test")?;
        let commands = commands();
        let command = (commands.rerun)(record, test.plan.test, None);
        let command = command.filter(|_| !run.is_of_worker());
        // It is for the working directory of the run, which is not the server's.
        let dir = std::path::absolute(run.dir()).unwrap_or_else(|_| run.dir());
        let replay = index.replay_command(&commands.replay, test, &dir);
        Ok(TestDetail::of(test, record, index.state().is_over(), (command, replay)))
    })
    .await
}
