//! All results and points as rows, one after the other.

use serde::Serialize;

use super::test_history::TestResult;
use super::trend::{SeriesPoint, TestSeries};
use crate::entry::SeriesName;
use crate::{RunSelection, Store, StoreError, TestIdentity, TestSelection};

/// A result of a test.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResultLine {
    /// The test.
    #[serde(flatten)]
    pub identity: TestIdentity,
    /// The result.
    #[serde(flatten)]
    pub result: TestResult,
}

/// A point of a series of a test.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PointLine {
    /// The test.
    #[serde(flatten)]
    pub identity: TestIdentity,
    /// The series.
    #[serde(flatten)]
    pub series: SeriesName,
    /// The point.
    #[serde(flatten)]
    pub point: SeriesPoint,
}

impl Store {
    /// Calls `visit` with each result of the selected tests, by test and run. Holds the
    /// results of one test at a time.
    ///
    /// # Errors
    /// The database cannot be read; or the first error of `visit`.
    pub fn for_each_result<E: From<StoreError>>(
        &self,
        runs: &RunSelection,
        tests: TestSelection<'_>,
        mut visit: impl FnMut(ResultLine) -> Result<(), E>,
    ) -> Result<(), E> {
        let scope = self.run_scope(runs)?;
        for test in self.selected_tests(tests)? {
            for result in self.results(&test, &scope)? {
                let identity = test.attributes.identity.clone();
                visit(ResultLine { identity, result: TestResult::new(&scope, &result) })?;
            }
        }
        Ok(())
    }

    /// Calls `visit` with each point of the selected tests, by test, series and run.
    ///
    /// # Errors
    /// As for [`Store::for_each_result`].
    pub fn for_each_point<E: From<StoreError>>(
        &self,
        runs: &RunSelection,
        tests: TestSelection<'_>,
        mut visit: impl FnMut(PointLine) -> Result<(), E>,
    ) -> Result<(), E> {
        let scope = self.run_scope(runs)?;
        for test in self.selected_tests(tests)? {
            let results = self.results(&test, &scope)?;
            let points = self.points(&test, &scope, &results)?;
            for TestSeries { identity, series, points, .. } in
                TestSeries::all(&test.attributes.identity, &scope, points)
            {
                for point in points {
                    visit(PointLine { identity: identity.clone(), series: series.clone(), point })?;
                }
            }
        }
        Ok(())
    }
}
