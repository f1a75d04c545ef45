//! Since which run a measurement, a signal or a duration is different.

use std::collections::BTreeMap;

use jiff::Timestamp;
use rtf_model::Verdict;
use serde::Serialize;

use super::scope::{RunScope, ScopedResult, StoredTest};
use crate::entry::SeriesName;
use crate::statistics::change_points::{ChangePoint, Options, find_change_points};
use crate::{RunSelection, Store, StoreError, TestIdentity, TestSelection};

/// A change of a series of a test.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SeriesChange {
    /// The test or case.
    #[serde(flatten)]
    pub identity: TestIdentity,
    /// The measurement or signal; `None` for the duration.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub series: Option<SeriesName>,
    /// The exclusive resources of the suite, separated by spaces.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub robot: String,
    /// The profile of the runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<String>,
    /// The first run after the change.
    pub run: String,
    /// The name of its directory.
    pub run_name: String,
    /// When it started.
    pub started: Timestamp,
    /// The commit of its sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// The commit of the last run before the change.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commit_before: Option<String>,
    /// The numbers before and after the change.
    #[serde(flatten)]
    pub change: ChangePoint,
}

/// Numbers of comparable runs: their robot and profile are equal.
type Groups = BTreeMap<(String, Option<String>), Vec<(usize, f64)>>;

impl Store {
    /// The changes in the selected tests, the newest first.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn changes(
        &self,
        runs: &RunSelection,
        tests: TestSelection<'_>,
    ) -> Result<Vec<SeriesChange>, StoreError> {
        let scope = self.run_scope(runs)?;
        let mut changes = Vec::new();
        for test in self.selected_tests(tests)? {
            self.add_changes(&test, &scope, &mut changes)?;
        }
        changes.sort_by(|a, b| b.started.cmp(&a.started).then(a.identity.cmp(&b.identity)));
        Ok(changes)
    }

    fn add_changes(
        &self,
        test: &StoredTest,
        scope: &RunScope,
        changes: &mut Vec<SeriesChange>,
    ) -> Result<(), StoreError> {
        let results = self.results(test, scope)?;
        let robots: BTreeMap<usize, &str> =
            results.iter().map(|result| (result.run, result.row.robot.as_str())).collect();
        let group = |run: usize| {
            let robot = robots.get(&run).copied().unwrap_or_default().to_owned();
            (robot, scope.runs[run].profile.clone())
        };
        let identity = &test.attributes.identity;
        let mut durations = Groups::new();
        for (run, seconds) in results.iter().filter_map(passed_duration) {
            durations.entry(group(run)).or_default().push((run, seconds));
        }
        find(scope, identity, (None, Options::default()), durations, changes);
        for (series, points) in self.points(test, scope, &results)? {
            let limits = points.last().and_then(|(_, point)| Some(point.high? - point.low?));
            let options = Options { limits_span: limits, ..Options::default() };
            let mut groups = Groups::new();
            for (run, value) in points.into_iter().filter_map(|(run, it)| Some((run, it.value?))) {
                groups.entry(group(run)).or_default().push((run, value));
            }
            find(scope, identity, (Some(&series), options), groups, changes);
        }
        Ok(())
    }
}

/// The duration of a result in seconds. A failure may end a test early.
fn passed_duration(result: &ScopedResult) -> Option<(usize, f64)> {
    let micros = result.row.duration_us.filter(|_| result.row.verdict == Verdict::Passed)?;
    Some((result.run, micros as f64 / 1e6))
}

fn find(
    scope: &RunScope,
    identity: &TestIdentity,
    (series, options): (Option<&SeriesName>, Options),
    groups: Groups,
    changes: &mut Vec<SeriesChange>,
) {
    for ((robot, profile), numbers) in groups {
        let values: Vec<f64> = numbers.iter().map(|(_, value)| *value).collect();
        for change in find_change_points(&values, &options).points {
            let run = &scope.runs[numbers[change.index].0];
            let before = change.index.checked_sub(1).map(|index| &scope.runs[numbers[index].0]);
            changes.push(SeriesChange {
                identity: identity.clone(),
                series: series.cloned(),
                robot: robot.clone(),
                profile: profile.clone(),
                run: run.id.clone(),
                run_name: run.name.clone(),
                started: run.started,
                commit: run.commit.clone(),
                commit_before: before.and_then(|run| run.commit.clone()),
                change,
            });
        }
    }
}
