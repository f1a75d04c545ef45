//! Differences between two sets of runs.

use std::collections::BTreeMap;

use rtf_model::Verdict;
use serde::Serialize;
use utoipa::ToSchema;

use super::RunCounts;
use super::columns::{ColumnPoint, ColumnSeries, Depth, TestColumns};
use super::scope::RunScope;
use crate::entry::SeriesName;
use crate::statistics::robust::median;
use crate::{RunSelection, Store, StoreError, TestIdentity, TestSelection};

/// Two sets of runs.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[schema(as = HistoryDifferences)]
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
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct TestComparison {
    /// The identity.
    #[serde(flatten)]
    pub identity: TestIdentity,
    /// Its verdicts in the first set.
    #[schema(value_type = HashMap<String, u32>)]
    pub verdicts_a: RunCounts,
    /// Its verdicts in the second set.
    #[schema(value_type = HashMap<String, u32>)]
    pub verdicts_b: RunCounts,
    /// Its newest verdict in the first set.
    #[schema(value_type = String)]
    pub last_a: Verdict,
    /// Its newest verdict in the second set.
    #[schema(value_type = String)]
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
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
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
    verdicts: RunCounts,
    last: Verdict,
    duration: Option<f64>,
    numbers: BTreeMap<SeriesName, ColumnSeries>,
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
        let (sides_a, sides_b) = (self.sides(&scope_a, tests)?, self.sides(&scope_b, tests)?);
        for ((identity, a), (_, b)) in sides_a.into_iter().zip(sides_b) {
            match (a, b) {
                (Some(a), Some(b)) => comparison.tests.push(TestComparison::new(identity, a, b)),
                (Some(_), None) => comparison.only_a.push(identity),
                (None, Some(_)) => comparison.only_b.push(identity),
                (None, None) => {}
            }
        }
        Ok(comparison)
    }

    /// The selected tests, each with its results in one set of runs.
    fn sides(
        &self,
        scope: &RunScope,
        tests: TestSelection<'_>,
    ) -> Result<Vec<(TestIdentity, Option<Side>)>, StoreError> {
        let columns = self.columns(self.selected_tests(tests)?, scope, Depth::Points)?;
        let side =
            |columns: TestColumns| (columns.test.attributes.identity.clone(), Side::new(columns));
        Ok(columns.tests.into_iter().map(side).collect())
    }
}

impl Side {
    fn new(TestColumns { results, series, .. }: TestColumns) -> Option<Self> {
        let last = results.last()?.verdict;
        let mut verdicts = RunCounts::default();
        results.iter().for_each(|result| verdicts.add(result.verdict));
        let micros = results.iter().filter_map(|result| result.duration_us);
        let seconds: Vec<_> = micros.map(|micros| micros as f64 / 1e6).collect();
        Some(Self { verdicts, last, duration: median(&seconds), numbers: series })
    }
}

impl TestComparison {
    fn new(identity: TestIdentity, a: Side, b: Side) -> Self {
        let numbers = a.numbers.iter().filter_map(|(series, points)| {
            Some(NumberChange::new(series.clone(), points, b.numbers.get(series)?))
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
    fn new(series: SeriesName, a: &ColumnSeries, b: &ColumnSeries) -> Self {
        let value = |series: &ColumnSeries| {
            median(&series.points.iter().filter_map(ColumnPoint::value).collect::<Vec<_>>())
        };
        let outside = |series: &ColumnSeries| series.points.iter().map(ColumnPoint::outside).sum();
        Self { series, a: value(a), b: value(b), outside_a: outside(a), outside_b: outside(b) }
    }
}
