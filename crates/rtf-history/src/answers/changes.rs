//! Since which run a measurement, a signal or a duration is different.

use std::collections::{BTreeMap, HashMap};

use jiff::Timestamp;
use rtf_model::Verdict;
use serde::Serialize;

use super::columns::{ColumnResult, Depth, TestColumns};
use super::scope::RunScope;
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
    /// Whether the sources of the test, as far as they are known, differ between these two runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sources_changed: Option<bool>,
    /// The numbers before and after the change.
    #[serde(flatten)]
    pub change: ChangePoint,
}

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
        let columns = self.columns(self.selected_tests(tests)?, &scope, Depth::Points)?;
        let search = ChangeSearch::new(&scope, &columns.robots);
        let mut changes = Vec::new();
        columns.tests.iter().for_each(|test| search.add_changes(test, &mut changes));
        changes.sort_by(|a, b| b.started.cmp(&a.started).then(a.identity.cmp(&b.identity)));
        Ok(changes)
    }
}

/// Searches the series of tests.
struct ChangeSearch<'a> {
    scope: &'a RunScope,
    robots: &'a [String],
    /// For each run, the first run with the same profile.
    profiles: Vec<usize>,
}

/// Numbers, each with the position of its run.
type Numbers = Vec<(usize, f64)>;

/// Numbers of comparable runs: their robot and profile are equal.
type Groups<'a> = BTreeMap<(&'a str, Option<&'a str>), Numbers>;

impl<'a> ChangeSearch<'a> {
    fn new(scope: &'a RunScope, robots: &'a [String]) -> Self {
        let mut first = HashMap::new();
        let runs = scope.runs.iter().enumerate();
        let profiles = runs.map(|(at, run)| *first.entry(&run.profile).or_insert(at)).collect();
        Self { scope, robots, profiles }
    }

    fn add_changes(&self, columns: &TestColumns, changes: &mut Vec<SeriesChange>) {
        let durations = self.groups(columns, columns.results.iter().filter_map(passed_duration));
        self.search(columns, (None, Options::default()), durations, changes);
        for (name, series) in &columns.series {
            let [low, high] = series.limits;
            let limits_span = high.zip(low).map(|(high, low)| high - low);
            let options = Options { limits_span, ..Options::default() };
            let values = series.points.iter().filter_map(|it| Some((it.run(), it.value()?)));
            let groups = self.groups(columns, values);
            self.search(columns, (Some(name), options), groups, changes);
        }
    }

    /// Groups numbers, which are in the order of their runs, by the robot and the profile of
    /// the test in that run.
    fn groups(
        &self,
        columns: &TestColumns,
        numbers: impl Iterator<Item = (usize, f64)>,
    ) -> Groups<'a> {
        let count = columns.results.len();
        // By the positions of robot and profile: comparing their names takes longer.
        let mut groups: Vec<((Option<usize>, usize), Numbers)> = Vec::new();
        let mut next = 0;
        for number in numbers {
            while next < count && columns.results[next].run < number.0 {
                next += 1;
            }
            let result = columns.results.get(next).filter(|result| result.run == number.0);
            let key = (result.map(|result| result.robot), self.profiles[number.0]);
            match groups.iter_mut().find(|(known, _)| *known == key) {
                Some((_, group)) => group.push(number),
                None => {
                    let mut group = Vec::with_capacity(count);
                    group.push(number);
                    groups.push((key, group));
                }
            }
        }
        let named = groups.into_iter().map(|((robot, _), group)| {
            let robot = robot.map_or("", |robot| self.robots[robot].as_str());
            let profile = self.scope.runs[group[0].0].profile.as_deref();
            ((robot, profile), group)
        });
        named.collect()
    }

    fn search(
        &self,
        columns: &TestColumns,
        (series, options): (Option<&SeriesName>, Options),
        groups: Groups<'_>,
        changes: &mut Vec<SeriesChange>,
    ) {
        for ((robot, profile), numbers) in groups {
            let values: Vec<f64> = numbers.iter().map(|(_, value)| *value).collect();
            for change in find_change_points(&values, &options).points {
                let position = |index: usize| numbers[index].0;
                let first = position(change.index);
                let last = change.index.checked_sub(1).map(position);
                let run = &self.scope.runs[first];
                changes.push(SeriesChange {
                    identity: columns.test.attributes.identity.clone(),
                    series: series.cloned(),
                    robot: robot.to_owned(),
                    profile: profile.map(str::to_owned),
                    run: run.id.clone(),
                    run_name: run.name.clone(),
                    started: run.started,
                    commit: run.commit.clone(),
                    commit_before: last.and_then(|run| self.scope.runs[run].commit.clone()),
                    sources_changed: last.and_then(|last| {
                        Some(columns.source_in(last)? != columns.source_in(first)?)
                    }),
                    change,
                });
            }
        }
    }
}

/// The duration of a result in seconds. A failure may end a test early.
fn passed_duration(result: &ColumnResult) -> Option<(usize, f64)> {
    let micros = result.duration_us.filter(|_| result.verdict == Verdict::Passed)?;
    Some((result.run, micros as f64 / 1e6))
}
