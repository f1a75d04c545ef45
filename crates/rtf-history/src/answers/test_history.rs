//! Verdicts, durations and numbers of one test.

use jiff::Timestamp;
use rtf_model::Verdict;
use serde::Serialize;
use utoipa::ToSchema;

use super::RunCounts;
use super::scope::{RunScope, ScopedResult};
use super::trend::TestSeries;
use crate::{RunSelection, Store, StoreError, TestIdentity, TestSelection};

/// The result of a test in a run.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[schema(as = HistoryResult)]
pub struct TestResult {
    /// The identity of the run.
    pub run: String,
    /// The name of the run's directory.
    pub name: String,
    /// When the run started.
    #[schema(value_type = String, format = DateTime)]
    pub started: Timestamp,
    /// The commit of the sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// The branch of the sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub branch: Option<String>,
    /// The final verdict.
    #[schema(value_type = String)]
    pub verdict: Verdict,
    /// Whether it both passed and failed in this run: on a retry, or in repetitions.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub flaky: bool,
    /// Number of attempts.
    pub attempts: u32,
    /// Number of attempts that did not pass.
    pub problems: u32,
    /// The duration in seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration: Option<f64>,
    /// Why it did not pass.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The exclusive resources of its suite, separated by spaces.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub robot: String,
    /// The hash of its plug-in.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plugin_hash: Option<String>,
    /// The hash of its sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source_hash: Option<String>,
}

impl TestResult {
    pub(super) fn new(scope: &RunScope, result: &ScopedResult) -> Self {
        let (run, row) = (&scope.runs[result.run], &result.row);
        Self {
            run: run.id.clone(),
            name: run.name.clone(),
            started: run.started,
            commit: run.commit.clone(),
            branch: run.branch.clone(),
            verdict: row.verdict,
            flaky: row.is_flaky,
            attempts: row.attempts,
            problems: row.problems,
            duration: row.duration_us.map(|micros| micros as f64 / 1e6),
            reason: row.reason.clone(),
            robot: row.robot.clone(),
            plugin_hash: row.plugin_hash.clone(),
            source_hash: row.source_hash.clone(),
        }
    }
}

/// The history of a test.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct TestHistory {
    /// The identity.
    #[serde(flatten)]
    pub identity: TestIdentity,
    /// The names that it had before.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub former_names: Vec<String>,
    /// Number of results by verdict.
    #[schema(value_type = HashMap<String, u32>)]
    pub counts: RunCounts,
    /// Its results, the oldest first.
    pub results: Vec<TestResult>,
    /// Its measurements and signals.
    pub series: Vec<TestSeries>,
}

impl Store {
    /// The history of the selected tests that have results.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn test_histories(
        &self,
        runs: &RunSelection,
        tests: TestSelection<'_>,
    ) -> Result<Vec<TestHistory>, StoreError> {
        let scope = self.run_scope(runs)?;
        let mut histories = Vec::new();
        for test in self.selected_tests(tests)? {
            let results = self.results(&test, &scope)?;
            if results.is_empty() {
                continue;
            }
            let points = self.points(&test, &scope, &results)?;
            let mut counts = RunCounts::default();
            results.iter().for_each(|result| counts.add(result.row.verdict));
            histories.push(TestHistory {
                series: TestSeries::all(&test.attributes.identity, &scope, points),
                identity: test.attributes.identity,
                former_names: test.former_names,
                counts,
                results: results.iter().map(|result| TestResult::new(&scope, result)).collect(),
            });
        }
        Ok(histories)
    }

    /// The identities of all tests and cases, under their current names.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn identities(&self) -> Result<Vec<TestIdentity>, StoreError> {
        let tests = self.selected_tests(&|_| true)?;
        Ok(tests.into_iter().map(|test| test.attributes.identity).collect())
    }
}
