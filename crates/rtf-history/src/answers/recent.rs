//! The last results of tests, from which the next run is planned.

use std::collections::HashMap;

use rtf_model::Verdict;

use super::ResultLine;
use crate::statistics::robust::median;
use crate::{RunSelection, Store, StoreError, TestIdentity};

/// Number of results of which the duration is the median.
const RESULTS: usize = 10;

/// The last results of a test.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RecentResults {
    /// Whether the last one is a problem, or a pass on a retry.
    pub failed: bool,
    /// The median duration of one repetition, in seconds.
    pub duration: Option<f64>,
}

impl RecentResults {
    /// Summarises the results of a test, the oldest first. Results that say nothing about the
    /// test, because it was skipped or interrupted, do not count.
    fn new(results: &[ResultLine]) -> Self {
        let counts = |line: &&ResultLine| {
            !matches!(line.result.verdict, Verdict::Skipped | Verdict::Interrupted)
        };
        let last: Vec<_> = results.iter().rev().filter(counts).take(RESULTS).collect();
        let failed = |line: &&ResultLine| line.result.verdict.is_problem() || line.result.flaky;
        let durations: Vec<f64> = last.iter().filter_map(|line| line.result.duration).collect();
        Self { failed: last.first().is_some_and(failed), duration: median(&durations) }
    }
}

impl Store {
    /// The last results of all tests, without cases, in runs with a profile; `None`: in runs
    /// without one.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn recent_results(
        &self,
        profile: Option<&str>,
    ) -> Result<HashMap<TestIdentity, RecentResults>, StoreError> {
        let profile = Some(profile.unwrap_or_default().to_owned());
        let runs = RunSelection { profile, ..RunSelection::default() };
        let mut results = HashMap::<TestIdentity, Vec<ResultLine>>::new();
        self.for_each_result(&runs, &|test| test.identity.case.is_empty(), |line| {
            results.entry(line.identity.clone()).or_default().push(line);
            Ok::<_, StoreError>(())
        })?;
        let summaries = results.into_iter().map(|(test, lines)| (test, RecentResults::new(&lines)));
        Ok(summaries.collect())
    }
}
