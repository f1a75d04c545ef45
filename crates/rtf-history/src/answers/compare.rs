//! Differences between two sets of runs.

use rtf_model::Verdict;
use serde::Serialize;

use super::RunCounts;
use super::scope::{ScopedResult, StoredTest};
use crate::entry::{NumberSummary, SeriesName};
use crate::statistics::robust::median;
use crate::{RunSelection, Store, StoreError, TestIdentity, TestSelection};

/// Number of results of a test by verdict.
pub type VerdictCounts = RunCounts;

/// Two sets of runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Number of runs in the first set.
    pub runs_a: usize,
    /// Number of runs in the second set.
    pub runs_b: usize,
    /// Tests with results in both sets.
    pub tests: Vec<TestComparison>,
    /// Tests with results in the first set only.
    pub only_a: Vec<TestIdentity>,
    /// Tests with results in the second set only.
    pub only_b: Vec<TestIdentity>,
}

/// A test in two sets of runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TestComparison {
    /// The identity.
    #[serde(flatten)]
    pub identity: TestIdentity,
    /// Its verdicts in the first set.
    pub verdicts_a: VerdictCounts,
    /// Its verdicts in the second set.
    pub verdicts_b: VerdictCounts,
    /// Its newest verdict in the first set.
    pub last_a: Verdict,
    /// Its newest verdict in the second set.
    pub last_b: Verdict,
    /// Its median duration in the first set, in seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration_a: Option<f64>,
    /// Its median duration in the second set, in seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration_b: Option<f64>,
    /// Its measurements and signals in both sets.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub numbers: Vec<NumberChange>,
}

/// A measurement or signal in two sets of runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NumberChange {
    /// The name and the unit.
    #[serde(flatten)]
    pub series: SeriesName,
    /// The median of the runs of the first set; `None` if it has no finite number.
    pub a: Option<f64>,
    /// The same for the second set.
    pub b: Option<f64>,
    /// Number of numbers outside their limits in the first set.
    pub outside_a: u64,
    /// The same for the second set.
    pub outside_b: u64,
}

/// A test in one set of runs.
struct Side {
    verdicts: VerdictCounts,
    last: Verdict,
    duration: Option<f64>,
    numbers: Vec<(SeriesName, Vec<(usize, NumberSummary)>)>,
}

impl Store {
    /// Compares the selected tests in two sets of runs.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn compare(
        &self,
        (a, b): (&RunSelection, &RunSelection),
        tests: TestSelection<'_>,
    ) -> Result<Comparison, StoreError> {
        let (scope_a, scope_b) = (self.run_scope(a)?, self.run_scope(b)?);
        let mut comparison = Comparison {
            runs_a: scope_a.runs.len(),
            runs_b: scope_b.runs.len(),
            tests: Vec::new(),
            only_a: Vec::new(),
            only_b: Vec::new(),
        };
        for test in self.selected_tests(tests)? {
            let sides = (self.side(&test, &scope_a)?, self.side(&test, &scope_b)?);
            let identity = test.attributes.identity;
            match sides {
                (Some(a), Some(b)) => comparison.tests.push(TestComparison::new(identity, a, b)),
                (Some(_), None) => comparison.only_a.push(identity),
                (None, Some(_)) => comparison.only_b.push(identity),
                (None, None) => {}
            }
        }
        Ok(comparison)
    }

    fn side(
        &self,
        test: &StoredTest,
        scope: &super::scope::RunScope,
    ) -> Result<Option<Side>, StoreError> {
        let results = self.results(test, scope)?;
        let Some(last) = results.last().map(|result| result.row.verdict) else { return Ok(None) };
        let mut verdicts = VerdictCounts::default();
        results.iter().for_each(|result| verdicts.add(result.row.verdict));
        let seconds = |result: &ScopedResult| Some(result.row.duration_us? as f64 / 1e6);
        let seconds: Vec<_> = results.iter().filter_map(seconds).collect();
        let numbers = self.points(test, scope, &results)?.into_iter().collect();
        Ok(Some(Side { verdicts, last, duration: median(&seconds), numbers }))
    }
}

impl TestComparison {
    fn new(identity: TestIdentity, a: Side, b: Side) -> Self {
        let numbers = a.numbers.iter().filter_map(|(series, points)| {
            let other = b.numbers.iter().find(|(other, _)| other == series);
            other.map(|(_, other)| NumberChange::new(series.clone(), points, other))
        });
        Self {
            identity,
            numbers: numbers.collect(),
            verdicts_a: a.verdicts,
            verdicts_b: b.verdicts,
            last_a: a.last,
            last_b: b.last,
            duration_a: a.duration,
            duration_b: b.duration,
        }
    }
}

impl NumberChange {
    fn new(series: SeriesName, a: &[(usize, NumberSummary)], b: &[(usize, NumberSummary)]) -> Self {
        let value = |points: &[(usize, NumberSummary)]| {
            median(&points.iter().filter_map(|(_, point)| point.value).collect::<Vec<_>>())
        };
        let outside =
            |points: &[(usize, NumberSummary)]| points.iter().map(|(_, point)| point.outside).sum();
        Self { series, a: value(a), b: value(b), outside_a: outside(a), outside_b: outside(b) }
    }
}
