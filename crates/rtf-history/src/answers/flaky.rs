//! Tests that both passed and failed on one commit.

use jiff::Timestamp;
use rtf_model::Verdict;
use serde::Serialize;

use super::scope::{RunScope, ScopedResult};
use super::test_history::TestResult;
use crate::statistics::{Attempt, Flips};
use crate::{RunSelection, Store, StoreError, TestIdentity, TestSelection};

/// A test that both passed and failed on one commit.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
        let mut flaky = Vec::new();
        for test in tests {
            let results = self.results(&test, &scope)?;
            let flips = count(&keys, &results);
            if flips.is_flaky() {
                let is_problem =
                    |result: &&ScopedResult| result.row.verdict.is_problem() || result.row.is_flaky;
                let last = results.iter().rev().find(is_problem);
                let last_problem = last.map(|result| TestResult::new(&scope, result));
                let identity = test.attributes.identity;
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
}

/// What two comparable results of a run have in common, except the robot: `None` without a
/// commit, or with uncommitted changes.
fn commit_keys(scope: &RunScope) -> Vec<Option<String>> {
    let key = |run: &super::RunInfo| {
        let commit = run.commit.as_ref().filter(|_| run.dirty != Some(true))?;
        let profile = run.profile.as_deref().unwrap_or_default();
        Some(format!("{commit}\0{profile}\0{}", run.parameters.join("\0")))
    };
    scope.runs.iter().map(key).collect()
}

fn count(keys: &[Option<String>], results: &[ScopedResult]) -> Flips {
    let with_robot = |result: &ScopedResult| {
        let key = keys.get(result.run)?.as_ref()?;
        Some(format!("{key}\0{}", result.row.robot))
    };
    let keys: Vec<_> = results.iter().map(with_robot).collect();
    let mut attempts = Vec::with_capacity(results.len());
    for (result, key) in results.iter().zip(&keys) {
        let commit = key.as_deref();
        if result.row.is_flaky {
            attempts.push(Attempt { commit, verdict: Verdict::Failed });
        }
        attempts.push(Attempt { commit, verdict: result.row.verdict });
    }
    Flips::count(&attempts)
}
