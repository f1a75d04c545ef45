//! Tests by duration.

use serde::Serialize;
use utoipa::ToSchema;

use super::columns::{Depth, TestColumns};
use crate::statistics::robust::median;
use crate::{RunSelection, Store, StoreError, TestIdentity, TestSelection};

/// The durations of a test, in seconds.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct SlowTest {
    /// The identity.
    #[serde(flatten)]
    pub identity: TestIdentity,
    /// Number of runs in which it ran.
    pub runs: usize,
    /// The median duration.
    pub median: f64,
    /// The longest duration.
    pub max: f64,
    /// The newest duration.
    pub last: f64,
}

impl Store {
    /// The durations of the selected tests, the slowest first.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn slow(
        &self,
        runs: &RunSelection,
        tests: TestSelection<'_>,
    ) -> Result<Vec<SlowTest>, StoreError> {
        let scope = self.run_scope(runs)?;
        let columns = self.columns(self.selected_tests(tests)?, &scope, Depth::Results)?;
        let mut slow = Vec::new();
        for TestColumns { test, results, .. } in columns.tests {
            let micros = results.iter().filter_map(|result| result.duration_us);
            let seconds: Vec<f64> = micros.map(|micros| micros as f64 / 1e6).collect();
            let (Some(median), Some(last)) = (median(&seconds), seconds.last()) else { continue };
            slow.push(SlowTest {
                identity: test.attributes.identity,
                runs: seconds.len(),
                median,
                max: seconds.iter().copied().fold(median, f64::max),
                last: *last,
            });
        }
        slow.sort_by(|a, b| b.median.total_cmp(&a.median).then(a.identity.cmp(&b.identity)));
        Ok(slow)
    }
}
