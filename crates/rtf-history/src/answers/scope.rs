//! The runs and tests that a question is about, and the results of the one in the other.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::RunInfo;
use crate::entry::{NumberSummary, SeriesName};
use crate::store::{ResultRow, TestRow};
use crate::{RunSelection, Store, StoreError, TestAttributes, TestSelection};

/// The runs that a question is about.
#[derive(Debug)]
pub(super) struct RunScope {
    /// The oldest first.
    pub runs: Vec<RunInfo>,
    /// The row of each run.
    pub ids: Vec<i64>,
    /// The position of each run in `runs`.
    positions: HashMap<i64, usize>,
    pub selection: RunSelection,
}

impl RunScope {
    /// The position of a run in `runs`.
    pub fn position(&self, id: i64) -> Option<usize> {
        self.positions.get(&id).copied()
    }

    /// The smallest and the largest row; `None` without runs.
    pub fn id_range(&self) -> Option<(i64, i64)> {
        Some((self.ids.iter().min().copied()?, self.ids.iter().max().copied()?))
    }
}

/// A test or a case, under all its names.
#[derive(Debug)]
pub(super) struct StoredTest {
    /// Under its current name.
    pub attributes: TestAttributes,
    /// The names of the test that it had before.
    pub former_names: Vec<String>,
    /// Its rows.
    pub ids: Vec<i64>,
}

/// The result of a test in a run of a scope.
#[derive(Debug)]
pub(super) struct ScopedResult {
    /// The position of the run in [`RunScope::runs`].
    pub run: usize,
    pub row: ResultRow,
}

impl Store {
    /// The runs that a selection matches, the oldest first.
    pub(super) fn selected_runs(
        &self,
        selection: &RunSelection,
    ) -> Result<Vec<(i64, RunInfo)>, StoreError> {
        let mut runs = self.all_runs()?;
        runs.retain(|(_, run)| selection.matches(run));
        let surplus = runs.len().saturating_sub(selection.last.unwrap_or(usize::MAX));
        Ok(runs.split_off(surplus))
    }

    pub(super) fn run_scope(&self, selection: &RunSelection) -> Result<RunScope, StoreError> {
        let (ids, runs): (Vec<_>, Vec<_>) = self.selected_runs(selection)?.into_iter().unzip();
        let positions = ids.iter().copied().zip(0..).collect();
        Ok(RunScope { runs, ids, positions, selection: selection.clone() })
    }

    /// The selected tests and cases, in the order of their identities.
    pub(super) fn selected_tests(
        &self,
        selection: TestSelection<'_>,
    ) -> Result<Vec<StoredTest>, StoreError> {
        let mut tests = merge_renamed(self.all_tests()?);
        tests.retain(|test| selection(&test.attributes));
        Ok(tests)
    }

    /// Keeps the tests that have one of these rows.
    pub(super) fn keep_tests(tests: &mut Vec<StoredTest>, rows: Vec<i64>) {
        let rows: HashSet<i64> = rows.into_iter().collect();
        tests.retain(|test| test.ids.iter().any(|id| rows.contains(id)));
    }

    /// The results of a test, the oldest first.
    pub(super) fn results(
        &self,
        test: &StoredTest,
        scope: &RunScope,
    ) -> Result<Vec<ScopedResult>, StoreError> {
        let mut results = Vec::new();
        for id in &test.ids {
            results.extend(self.results_of_test(*id)?.into_iter().filter_map(|row| {
                let run = *scope.positions.get(&row.run)?;
                scope.selection.matches_robot(&row.robot).then_some(ScopedResult { run, row })
            }));
        }
        results.sort_by_key(|result| result.run);
        Ok(results)
    }

    /// The points of a test by series, the oldest first. `results` are those of the test.
    pub(super) fn points(
        &self,
        test: &StoredTest,
        scope: &RunScope,
        results: &[ScopedResult],
    ) -> Result<BTreeMap<SeriesName, Vec<(usize, NumberSummary)>>, StoreError> {
        let runs: HashSet<usize> = results.iter().map(|result| result.run).collect();
        let mut points = BTreeMap::<SeriesName, Vec<_>>::new();
        for id in &test.ids {
            let names: HashMap<_, _> = self.series_of_test(*id)?.into_iter().collect();
            for point in self.points_of_test(*id)? {
                let run = scope.positions.get(&point.run).filter(|run| runs.contains(run));
                let (Some(run), Some(name)) = (run, names.get(&point.series)) else { continue };
                match points.get_mut(name) {
                    Some(series) => series.push((*run, point.summary)),
                    None => drop(points.insert(name.clone(), vec![(*run, point.summary)])),
                }
            }
        }
        points.values_mut().for_each(|series| series.sort_by_key(|(run, _)| *run));
        Ok(points)
    }
}

/// Merges the rows of tests that were renamed.
fn merge_renamed(rows: Vec<TestRow>) -> Vec<StoredTest> {
    let renamed: HashMap<i64, i64> =
        rows.iter().filter_map(|row| Some((row.id, row.renamed_to?))).collect();
    let current = |id: i64| {
        let mut last = id;
        // Two names that lead to each other are both current.
        for _ in 0..renamed.len() {
            match renamed.get(&last) {
                Some(next) if *next != id => last = *next,
                Some(_) => return id,
                None => break,
            }
        }
        last
    };
    let mut former = HashMap::<i64, Vec<(i64, String)>>::new();
    let mut tests = Vec::new();
    for row in rows {
        match current(row.id) {
            id if id == row.id => tests.push(row),
            id => {
                former.entry(id).or_default().push((row.id, row.attributes.identity.test));
            }
        }
    }
    let merged = tests.into_iter().map(|row| {
        let (mut ids, former_names): (Vec<_>, Vec<_>) =
            former.remove(&row.id).unwrap_or_default().into_iter().unzip();
        ids.push(row.id);
        StoredTest { attributes: row.attributes, former_names, ids }
    });
    merged.collect()
}
