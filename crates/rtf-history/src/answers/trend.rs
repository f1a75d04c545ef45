//! Measurements and signals over runs.

use std::collections::BTreeMap;

use jiff::Timestamp;
use serde::Serialize;
use utoipa::ToSchema;

use super::scope::RunScope;
use crate::entry::{NumberKind, NumberSummary, SeriesName};
use crate::{RunSelection, Store, StoreError, TestIdentity, TestSelection};

/// A measurement or signal of a test over runs.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct TestSeries {
    /// The test or case.
    #[serde(flatten)]
    pub identity: TestIdentity,
    /// The name and the unit.
    #[serde(flatten)]
    pub series: SeriesName,
    /// Other units of the same measurement or signal, which are other series.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub other_units: Vec<String>,
    /// The numbers of each run, the oldest first.
    pub points: Vec<SeriesPoint>,
}

/// What a run contributes to a series.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct SeriesPoint {
    /// The identity of the run.
    pub run: String,
    /// When the run started.
    #[schema(value_type = String, format = DateTime)]
    pub started: Timestamp,
    /// The commit of the sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// The median; of a signal, the mean. `None` if no number is finite.
    pub value: Option<f64>,
    /// The smallest number.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// The largest number.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
    /// Number of numbers.
    pub count: u64,
    /// How many of them are not finite.
    #[serde(skip_serializing_if = "crate::is_zero")]
    pub not_finite: u64,
    /// How many of them violate their limits.
    #[serde(skip_serializing_if = "crate::is_zero")]
    pub outside: u64,
    /// The smallest accepted value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub low: Option<f64>,
    /// The largest accepted value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub high: Option<f64>,
}

impl TestSeries {
    pub(super) fn all(
        identity: &TestIdentity,
        scope: &RunScope,
        points: BTreeMap<SeriesName, Vec<(usize, NumberSummary)>>,
    ) -> Vec<Self> {
        let names: Vec<SeriesName> = points.keys().cloned().collect();
        let series = points.into_iter().map(|(series, points)| {
            let is_other = |other: &&SeriesName| {
                (other.kind, &other.name) == (series.kind, &series.name)
                    && other.unit != series.unit
            };
            Self {
                identity: identity.clone(),
                other_units: names.iter().filter(is_other).map(|it| it.unit.clone()).collect(),
                points: points.into_iter().map(|point| SeriesPoint::new(scope, point)).collect(),
                series,
            }
        });
        series.collect()
    }
}

impl SeriesPoint {
    fn new(scope: &RunScope, (run, summary): (usize, NumberSummary)) -> Self {
        let run = &scope.runs[run];
        Self {
            run: run.id.clone(),
            started: run.started,
            commit: run.commit.clone(),
            value: summary.value,
            min: summary.min,
            max: summary.max,
            count: summary.count,
            not_finite: summary.not_finite,
            outside: summary.outside,
            low: summary.low,
            high: summary.high,
        }
    }
}

impl Store {
    /// The series of this name in the selected tests; of one kind, or of both.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn trend(
        &self,
        name: &str,
        kind: Option<NumberKind>,
        runs: &RunSelection,
        tests: TestSelection<'_>,
    ) -> Result<Vec<TestSeries>, StoreError> {
        let scope = self.run_scope(runs)?;
        let mut tests = self.selected_tests(tests)?;
        Self::keep_tests(&mut tests, self.tests_with_series(name)?);
        let mut found = Vec::new();
        for test in tests {
            let results = self.results(&test, &scope)?;
            let mut points = self.points(&test, &scope, &results)?;
            points.retain(|series, _| {
                series.name == name && kind.is_none_or(|kind| kind == series.kind)
            });
            found.extend(TestSeries::all(&test.attributes.identity, &scope, points));
        }
        Ok(found)
    }
}
