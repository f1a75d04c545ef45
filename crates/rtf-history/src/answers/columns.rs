//! The results and points of many runs, by test: read from the packed columns of the runs.

use std::collections::BTreeMap;

use rtf_model::Verdict;

use super::scope::{RunScope, StoredTest};
use crate::entry::SeriesName;
use crate::store::{PackedPoint, PackedResult, PackedResults};
use crate::{Store, StoreError};

/// A result of a test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ColumnResult {
    /// The position of the run in [`RunScope::runs`].
    pub run: usize,
    pub verdict: Verdict,
    pub is_flaky: bool,
    /// The position of the robot in [`Columns::robots`].
    pub robot: usize,
    pub duration_us: Option<i64>,
    /// The hash of its sources.
    pub source: Option<u64>,
}

/// A point of a series. Small, because there may be millions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ColumnPoint {
    run: u32,
    outside: u32,
    /// NaN if it is unknown.
    value: f64,
}

impl ColumnPoint {
    fn new(run: usize, value: Option<f64>, outside: u64) -> Self {
        let small = |number: u64| u32::try_from(number).unwrap_or(u32::MAX);
        let value = value.unwrap_or(f64::NAN);
        Self { run: small(run as u64), outside: small(outside), value }
    }

    /// The position of the run in [`RunScope::runs`].
    pub fn run(&self) -> usize {
        self.run as usize
    }

    pub fn value(&self) -> Option<f64> {
        (!self.value.is_nan()).then_some(self.value)
    }

    /// Number of values outside the limits.
    pub fn outside(&self) -> u64 {
        u64::from(self.outside)
    }
}

/// The points of a series of a test, the oldest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct ColumnSeries {
    pub points: Vec<ColumnPoint>,
    /// The limits of the newest point.
    pub limits: [Option<f64>; 2],
    newest: u32,
}

impl ColumnSeries {
    fn add(&mut self, point: ColumnPoint, limits: [Option<f64>; 2]) {
        if self.newest <= point.run {
            (self.newest, self.limits) = (point.run, limits);
        }
        self.points.push(point);
    }

    fn append(&mut self, other: Self) {
        if self.newest <= other.newest {
            (self.newest, self.limits) = (other.newest, other.limits);
        }
        self.points.extend(other.points);
    }
}

/// A test in the runs of a scope.
#[derive(Debug)]
pub(super) struct TestColumns {
    pub test: StoredTest,
    /// The oldest first.
    pub results: Vec<ColumnResult>,
    /// Empty if only results were read.
    pub series: BTreeMap<SeriesName, ColumnSeries>,
}

impl TestColumns {
    /// The sources of the test in a run, if they are known.
    pub fn source_in(&self, run: usize) -> Option<u64> {
        let at = self.results.binary_search_by_key(&run, |result| result.run).ok()?;
        self.results.get(at)?.source
    }
}

/// Tests in the runs of a scope.
#[derive(Debug)]
pub(super) struct Columns {
    pub tests: Vec<TestColumns>,
    /// Exclusive resources of suites, separated by spaces.
    pub robots: Vec<String>,
    /// For each run of the scope, whether the sources of any of its tests are known.
    pub runs_with_sources: Vec<bool>,
}

/// Whether the points of series are needed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Depth {
    Results,
    Points,
}

impl Store {
    /// The results, and maybe the points, of tests in the runs of a scope.
    pub(super) fn columns(
        &self,
        tests: Vec<StoredTest>,
        scope: &RunScope,
        depth: Depth,
    ) -> Result<Columns, StoreError> {
        let rows = tests.iter().enumerate();
        let rows = rows.flat_map(|(at, test)| test.ids.iter().map(move |id| (*id, at)));
        let rows = Rows::new(rows.collect());
        let start = |test| TestColumns { test, results: Vec::new(), series: BTreeMap::new() };
        let tests = tests.into_iter().map(start).collect();
        let runs_with_sources = vec![false; scope.runs.len()];
        let mut columns = Columns { tests, robots: Vec::new(), runs_with_sources };
        let Some(range) = scope.id_range() else { return Ok(columns) };
        self.for_each_result_column(range, |run, results| {
            if let Some(run) = scope.position(run) {
                columns.add_results(&rows, scope, run, results);
            }
        })?;
        columns.tests.iter_mut().for_each(|test| test.results.sort_by_key(|result| result.run));
        if depth == Depth::Points {
            let series = self.read_series(&columns, &rows, scope)?;
            columns.add_series(series);
        }
        Ok(columns)
    }

    /// Each series, with the position of its test.
    fn read_series(
        &self,
        columns: &Columns,
        tests: &Rows,
        scope: &RunScope,
    ) -> Result<Vec<(usize, SeriesName, ColumnSeries)>, StoreError> {
        let (mut series, mut rows) = (Vec::new(), Vec::new());
        for (id, name, test) in self.all_series()? {
            if let Some(test) = tests.find(&mut 0, test) {
                rows.push((id, series.len()));
                series.push((test, name, ColumnSeries::default()));
            }
        }
        let rows = Rows::new(rows);
        // Without a filter, a run with a point has a result.
        let on_robot =
            scope.selection.robot.is_some().then(|| columns.runs_of_tests(scope.runs.len()));
        let Some(range) = scope.id_range() else { return Ok(series) };
        self.for_each_point_column(range, |run, points| {
            let Some(run) = scope.position(run) else { return };
            let mut next = 0;
            for PackedPoint { series: id, value, outside, limits } in points {
                let Some((test, _, series)) = rows.find(&mut next, id).map(|at| &mut series[at])
                else {
                    continue;
                };
                if on_robot.as_ref().is_none_or(|tests| tests[*test][run]) {
                    series.add(ColumnPoint::new(run, value, outside), limits);
                }
            }
        })?;
        Ok(series)
    }
}

impl Columns {
    fn add_results(
        &mut self,
        rows: &Rows,
        scope: &RunScope,
        run: usize,
        results: PackedResults<'_>,
    ) {
        let robots: Vec<_> = results
            .robots
            .iter()
            .map(|robot| scope.selection.matches_robot(robot).then(|| self.robot(robot)))
            .collect();
        self.runs_with_sources[run] = !results.sources.is_empty();
        let mut next = 0;
        for PackedResult { test, verdict, is_flaky, robot, duration_us, source } in results {
            let Some(robot) = robots.get(robot).copied().flatten() else { continue };
            let Some(test) = rows.find(&mut next, test) else { continue };
            let result = ColumnResult { run, verdict, is_flaky, robot, duration_us, source };
            self.tests[test].results.push(result);
        }
    }

    fn robot(&mut self, name: &str) -> usize {
        self.robots.iter().position(|known| known == name).unwrap_or_else(|| {
            self.robots.push(name.to_owned());
            self.robots.len() - 1
        })
    }

    /// For each test, whether it has a result in each run.
    fn runs_of_tests(&self, runs: usize) -> Vec<Vec<bool>> {
        let runs_of = |test: &TestColumns| {
            let mut has_result = vec![false; runs];
            test.results.iter().for_each(|result| has_result[result.run] = true);
            has_result
        };
        self.tests.iter().map(runs_of).collect()
    }

    fn add_series(&mut self, series: Vec<(usize, SeriesName, ColumnSeries)>) {
        for (test, name, series) in series.into_iter().filter(|it| !it.2.points.is_empty()) {
            // A renamed test has rows of the same series.
            self.tests[test].series.entry(name).or_default().append(series);
        }
        let all = self.tests.iter_mut().flat_map(|test| test.series.values_mut());
        all.for_each(|series| series.points.sort_by_key(|point| point.run));
    }
}

/// The positions of rows by their ids.
struct Rows {
    ids: Vec<i64>,
    positions: Vec<usize>,
}

impl Rows {
    fn new(mut rows: Vec<(i64, usize)>) -> Self {
        rows.sort_unstable();
        let (ids, positions) = rows.into_iter().unzip();
        Self { ids, positions }
    }

    /// The position of the row. Ids are searched for in ascending order: it is usually at
    /// `next`, after the previous one.
    fn find(&self, next: &mut usize, id: i64) -> Option<usize> {
        let at = match self.ids.get(*next) {
            Some(found) if *found == id => *next,
            _ => self.ids.binary_search(&id).ok()?,
        };
        *next = at + 1;
        self.positions.get(at).copied()
    }
}
