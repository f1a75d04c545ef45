//! Tests that both passed and failed on one commit, or in one run.

use jiff::Timestamp;
use rtf_model::Verdict;
use serde::Serialize;

use super::RunInfo;
use super::columns::{ColumnResult, Depth, TestColumns};
use super::scope::{RunScope, ScopedResult, StoredTest};
use super::test_history::TestResult;
use crate::statistics::{Attempt, Flips};
use crate::{RunSelection, Store, StoreError, TestIdentity, TestSelection};

/// A test that both passed and failed on one commit, or in one run.
#[derive(Clone, Debug, PartialEq, Serialize, utoipa::ToSchema)]
pub struct FlakyTest {
    /// The identity.
    #[serde(flatten)]
    pub identity: TestIdentity,
    /// How often its result changed.
    #[serde(flatten)]
    pub flips: Flips,
    /// Its newest result that is a problem, or a pass after a retry.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last_problem: Option<TestResult>,
}

impl Store {
    /// The flaky tests among the selected ones, those with the highest rate first.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn flaky(
        &self,
        runs: &RunSelection,
        tests: TestSelection<'_>,
    ) -> Result<Vec<FlakyTest>, StoreError> {
        let scope = self.run_scope(runs)?;
        let keys = commit_keys(&scope);
        let mut tests = self.selected_tests(tests)?;
        Self::keep_tests(&mut tests, self.tests_with_problems()?);
        let columns = self.columns(tests, &scope, Depth::Results)?;
        let mut flaky = Vec::new();
        for TestColumns { test, results, .. } in &columns.tests {
            let flips = count(&keys, results, &columns.robots);
            if flips.is_flaky() {
                let last_problem = self.last_problem(test, results, &scope)?;
                let identity = test.attributes.identity.clone();
                flaky.push(FlakyTest { identity, flips, last_problem });
            }
        }
        let rate = |test: &FlakyTest| test.flips.flip_rate.map_or(0.0, |rate| rate.value);
        let time = |test: &FlakyTest| -> Option<Timestamp> {
            test.last_problem.as_ref().map(|result| result.started)
        };
        flaky.sort_by(|a, b| {
            rate(b)
                .total_cmp(&rate(a))
                .then(time(b).cmp(&time(a)))
                .then(a.identity.cmp(&b.identity))
        });
        Ok(flaky)
    }

    /// The newest result that is a problem, or a pass after a retry.
    fn last_problem(
        &self,
        test: &StoredTest,
        results: &[ColumnResult],
        scope: &RunScope,
    ) -> Result<Option<TestResult>, StoreError> {
        let is_problem = |it: &&ColumnResult| it.verdict.is_problem() || it.is_flaky;
        let Some(last) = results.iter().rev().find(is_problem) else { return Ok(None) };
        for id in &test.ids {
            if let Some(row) = self.result_of_test(*id, scope.id(last.run))? {
                return Ok(Some(TestResult::new(scope, &ScopedResult { run: last.run, row })));
            }
        }
        Ok(None)
    }
}

/// What the comparable results have in common, except the robot. Without a commit, or with
/// uncommitted changes, only those of one run are comparable.
fn commit_keys(scope: &RunScope) -> Vec<String> {
    let key = |(index, run): (usize, &RunInfo)| match &run.commit {
        Some(commit) if run.is_committed() => {
            let profile = run.profile.as_deref().unwrap_or_default();
            format!("{commit}\0{profile}\0{}", run.parameters.join("\0"))
        }
        _ => format!("run {index}"),
    };
    scope.runs.iter().enumerate().map(key).collect()
}

fn count(keys: &[String], results: &[ColumnResult], robots: &[String]) -> Flips {
    let with_robot = |result: &ColumnResult| {
        let key = keys.get(result.run)?;
        Some(format!("{key}\0{}", robots.get(result.robot)?))
    };
    let keys: Vec<_> = results.iter().map(with_robot).collect();
    let mut attempts = Vec::with_capacity(results.len());
    for (result, key) in results.iter().zip(&keys) {
        let commit = key.as_deref();
        if result.is_flaky {
            let is_passed = result.verdict == Verdict::Passed;
            let verdict = if is_passed { Verdict::Failed } else { Verdict::Passed };
            attempts.push(Attempt { commit, verdict });
        }
        attempts.push(Attempt { commit, verdict: result.verdict });
    }
    Flips::count(&attempts)
}
