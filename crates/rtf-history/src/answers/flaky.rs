//! Tests that both passed and failed on one commit, with equal sources, or in one run.

use jiff::Timestamp;
use rtf_model::Verdict;
use serde::Serialize;
use utoipa::ToSchema;

use super::columns::{ColumnResult, Depth, TestColumns};
use super::scope::{RunScope, ScopedResult, StoredTest};
use super::test_history::TestResult;
use crate::statistics::{Attempt, Flips};
use crate::{RunSelection, Store, StoreError, TestIdentity, TestSelection};

/// A test that both passed and failed on one commit, with equal sources, or in one run.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
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

/// Flaky tests, and which runs were compared.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct FlakyTests {
    /// The most flaky first.
    pub tests: Vec<FlakyTest>,
    /// The runs by what makes their results comparable.
    pub compared: ComparedRuns,
}

/// Number of runs by what makes their results comparable with those of other runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, ToSchema)]
pub struct ComparedRuns {
    /// Their commit, without uncommitted changes; and their sources, if they are known.
    pub by_commit: u64,
    /// The sources of each test: the commit is not known, or there were uncommitted changes.
    pub by_sources: u64,
    /// Nothing: neither is known.
    pub neither: u64,
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
    ) -> Result<FlakyTests, StoreError> {
        let scope = self.run_scope(runs)?;
        let mut tests = self.selected_tests(tests)?;
        Self::keep_tests(&mut tests, self.tests_with_problems()?);
        let columns = self.columns(tests, &scope, Depth::Results)?;
        let keys = RunKeys::of_scope(&scope, &columns.runs_with_sources);
        let mut flaky = Vec::new();
        for TestColumns { test, results, .. } in &columns.tests {
            let flips = keys.count(results, &columns.robots);
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
        Ok(FlakyTests { tests: flaky, compared: keys.compared })
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
            if let Some(row) = self.result_of_test(*id, scope.ids[last.run])? {
                return Ok(Some(TestResult::new(scope, &ScopedResult { run: last.run, row })));
            }
        }
        Ok(None)
    }
}

/// What makes the results of runs comparable, apart from the robot.
struct RunKeys {
    /// For each run: its commit, or else the run itself.
    commits: Vec<String>,
    /// For each run: what its results with equal sources have in common.
    settings: Vec<String>,
    compared: ComparedRuns,
}

impl RunKeys {
    fn of_scope(scope: &RunScope, has_sources: &[bool]) -> Self {
        let (mut commits, mut settings) = (Vec::new(), Vec::new());
        let mut compared = ComparedRuns::default();
        for (index, (run, has_sources)) in scope.runs.iter().zip(has_sources).enumerate() {
            let profile = run.profile.as_deref().unwrap_or_default();
            let options = format!("{profile}\0{}", run.parameters.join("\0"));
            let commit = run.compared_commit(*has_sources);
            match (commit, has_sources) {
                (Some(_), _) => compared.by_commit += 1,
                (None, true) => compared.by_sources += 1,
                (None, false) => compared.neither += 1,
            }
            commits.push(match commit {
                Some(commit) => format!("{commit}\0{options}"),
                None => format!("run {index}"),
            });
            settings.push(options);
        }
        Self { commits, settings, compared }
    }

    fn count(&self, results: &[ColumnResult], robots: &[String]) -> Flips {
        let keys_of = |result: &ColumnResult| {
            let robot = robots.get(result.robot).map_or("", String::as_str);
            let commit = format!("{}\0{robot}", self.commits.get(result.run)?);
            let settings = self.settings.get(result.run)?;
            let sources = result.source.map(|hash| format!("{hash:x}\0{settings}\0{robot}"));
            Some((commit, sources))
        };
        let keys: Vec<_> = results.iter().map(keys_of).collect();
        let mut attempts = Vec::with_capacity(results.len());
        for (result, keys) in results.iter().zip(&keys) {
            let commit = keys.as_ref().map(|(commit, _)| commit.as_str());
            let sources = keys.as_ref().and_then(|(_, sources)| sources.as_deref());
            if result.is_flaky {
                let is_passed = result.verdict == Verdict::Passed;
                let verdict = if is_passed { Verdict::Failed } else { Verdict::Passed };
                attempts.push(Attempt { commit, sources, verdict });
            }
            attempts.push(Attempt { commit, sources, verdict: result.verdict });
        }
        Flips::count(&attempts)
    }
}
