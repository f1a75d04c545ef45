//! Is a run worse than the runs before it? New failures, flaky tests and regressions of
//! measurements, compared with a baseline: runs of the default branch, for example.

mod regression;

use std::collections::{HashMap, HashSet};

use rtf_model::Verdict;
use serde::Serialize;

use super::{RunInfo, TestHistory};
use crate::entry::RunEnd;
use crate::{RunSelection, Store, StoreError, TestIdentity, TestSelection};

pub use regression::{
    Direction, JudgedSeries, NotJudged, NotJudgedReason, RegressionGate, RegressionLimit,
};

/// The fewest baseline runs with which a measurement is compared.
pub const MIN_BASELINE_RUNS: usize = 3;

/// What a run may be worse in.
#[derive(Clone, Debug, Default)]
pub struct GateLimits {
    /// The largest number of new failures.
    pub max_new_failures: Option<u32>,
    /// The largest share of flaky tests, between 0 and 1.
    pub max_flaky: Option<f64>,
    /// The measurements that must not be worse.
    pub no_regression: Vec<RegressionLimit>,
}

/// A run, and the runs with which it is compared.
#[derive(Clone, Debug)]
pub struct GateRuns {
    /// The run.
    pub run: RunInfo,
    /// The runs before it with the same profile, the newest first.
    pub baseline: Vec<RunInfo>,
}

/// Whether a run passes the gates.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GateReport {
    /// Whether it finished and passes all gates.
    pub passed: bool,
    /// The run.
    pub run: RunInfo,
    /// Number of runs with which it is compared.
    pub baseline_runs: usize,
    /// Number of its tests.
    pub tests: usize,
    /// The gate for new failures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub new_failures: Option<FailureGate>,
    /// The gate for flaky tests.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flaky: Option<FlakyGate>,
    /// The gates for measurements.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub no_regression: Vec<RegressionGate>,
}

/// The gate for new failures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FailureGate {
    /// Whether the run passes it.
    pub passed: bool,
    /// The largest number.
    pub max: u32,
    /// The new failures.
    pub tests: Vec<NewFailure>,
    /// Tests that failed and have no result in the baseline.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_judged: Vec<TestIdentity>,
}

/// A test that failed, and passed in the newest baseline run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NewFailure {
    /// The test.
    #[serde(flatten)]
    pub identity: TestIdentity,
    /// Its verdict in the run.
    pub verdict: Verdict,
    /// Why it did not pass.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The baseline run in which it passed last.
    pub passed_in: String,
}

/// The gate for flaky tests.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FlakyGate {
    /// Whether the run passes it.
    pub passed: bool,
    /// The largest share.
    pub max: f64,
    /// The share of tests of the run that are flaky in it and its baseline.
    pub share: f64,
    /// The flaky tests.
    pub tests: Vec<TestIdentity>,
}

impl GateRuns {
    /// Compares a run with the last `last` baseline runs before it that have its profile.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn new(
        store: &Store,
        run: RunInfo,
        baseline: &RunSelection,
        last: usize,
    ) -> Result<Self, StoreError> {
        let mut baseline = store.runs(baseline)?;
        baseline.retain(|other| {
            other.id != run.id && other.started <= run.started && other.profile == run.profile
        });
        baseline.truncate(last);
        Ok(Self { run, baseline })
    }

    fn ids(&self) -> impl Iterator<Item = String> {
        self.baseline.iter().map(|run| run.id.clone())
    }
}

impl Store {
    /// Judges the selected tests of a run.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn gate(
        &self,
        runs: &GateRuns,
        limits: &GateLimits,
        tests: TestSelection<'_>,
    ) -> Result<GateReport, StoreError> {
        let select = |ids| RunSelection { ids: Some(ids), ..RunSelection::default() };
        let run = select(HashSet::from([runs.run.id.clone()]));
        let run = self.test_histories(&run, tests)?;
        let baseline = self.test_histories(&select(runs.ids().collect()), tests)?;
        let compared = Compared::new(runs, run, baseline);
        let new_failures = limits.max_new_failures.map(|max| compared.new_failures(max));
        let flaky = limits.max_flaky.map(|max| {
            let all = runs.ids().chain([runs.run.id.clone()]).collect();
            let flaky = self.flaky(&select(all), tests)?;
            let flaky = flaky.tests.into_iter().map(|test| test.identity).collect();
            Ok::<_, StoreError>(compared.flaky(max, flaky))
        });
        let flaky = flaky.transpose()?;
        let no_regression: Vec<_> =
            limits.no_regression.iter().map(|limit| compared.regressions(limit)).collect();
        Ok(GateReport {
            passed: runs.run.end == RunEnd::Finished
                && new_failures.as_ref().is_none_or(|gate| gate.passed)
                && flaky.as_ref().is_none_or(|gate| gate.passed)
                && no_regression.iter().all(|gate| gate.passed),
            run: runs.run.clone(),
            baseline_runs: runs.baseline.len(),
            tests: compared.tests().count(),
            new_failures,
            flaky,
            no_regression,
        })
    }
}

/// The tests and cases of a run, and their results in the baseline.
struct Compared {
    run: Vec<TestHistory>,
    baseline: HashMap<TestIdentity, TestHistory>,
}

impl Compared {
    fn new(runs: &GateRuns, run: Vec<TestHistory>, baseline: Vec<TestHistory>) -> Self {
        debug_assert!(runs.baseline.iter().all(|other| other.id != runs.run.id));
        let by_identity = |test: TestHistory| (test.identity.clone(), test);
        Self { run, baseline: baseline.into_iter().map(by_identity).collect() }
    }

    /// The tests, without their cases.
    fn tests(&self) -> impl Iterator<Item = &TestHistory> {
        self.run.iter().filter(|test| test.identity.case.is_empty())
    }

    fn new_failures(&self, max: u32) -> FailureGate {
        let (mut tests, mut not_judged) = (Vec::new(), Vec::new());
        for test in self.tests() {
            let Some(result) = test.results.last().filter(|it| is_failure(it.verdict)) else {
                continue;
            };
            let baseline = self.baseline.get(&test.identity);
            let before = baseline.iter().flat_map(|test| &test.results);
            let newest = before.rev().find(|result| says_something(result.verdict));
            match newest {
                None => not_judged.push(test.identity.clone()),
                Some(before) if before.verdict == Verdict::Passed => tests.push(NewFailure {
                    identity: test.identity.clone(),
                    verdict: result.verdict,
                    reason: result.reason.clone(),
                    passed_in: before.name.clone(),
                }),
                Some(_) => {}
            }
        }
        FailureGate { passed: tests.len() <= max as usize, max, tests, not_judged }
    }

    fn flaky(&self, max: f64, flaky: HashSet<TestIdentity>) -> FlakyGate {
        let tests: Vec<_> = self.tests().map(|test| test.identity.clone()).collect();
        let count = tests.len();
        let tests: Vec<_> = tests.into_iter().filter(|test| flaky.contains(test)).collect();
        #[expect(clippy::cast_precision_loss, reason = "counts of tests are far below 2^53")]
        let share = tests.len() as f64 / count.max(1) as f64;
        FlakyGate { passed: share <= max, max, share, tests }
    }
}

/// Whether a test with this verdict failed.
fn is_failure(verdict: Verdict) -> bool {
    says_something(verdict) && verdict != Verdict::Passed
}

/// Whether a verdict is one of the test, which was neither skipped nor interrupted.
fn says_something(verdict: Verdict) -> bool {
    !matches!(verdict, Verdict::Skipped | Verdict::Interrupted)
}
