//! Reads rows.

use jiff::Timestamp;
use rtf_model::Verdict;
use serde::de::value::StringDeserializer;
use serde::de::{DeserializeOwned, IntoDeserializer as _};

use super::database::{Database, DatabaseError, Row, Value};
use super::{PackedPoints, PackedResults, Store, StoreError, sql};
use crate::answers::{RunCounts, RunInfo};
use crate::entry::{NumberKind, NumberSummary, RunEnd, SeriesName};
use crate::{TestAttributes, TestIdentity};

#[derive(Clone, Debug)]
pub(crate) struct TestRow {
    pub id: i64,
    pub attributes: TestAttributes,
    /// The test that has this one's history.
    pub renamed_to: Option<i64>,
}

/// The result of a test in a run.
#[derive(Clone, Debug)]
pub(crate) struct ResultRow {
    pub run: i64,
    pub verdict: Verdict,
    pub is_flaky: bool,
    pub attempts: u32,
    pub problems: u32,
    pub duration_us: Option<i64>,
    pub reason: Option<String>,
    pub robot: String,
    pub plugin_hash: Option<String>,
    pub source_hash: Option<String>,
}

/// The numbers of a run in a series.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointRow {
    pub run: i64,
    pub series: i64,
    pub summary: NumberSummary,
}

/// Number of rows of the tables.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct StoreCounts {
    pub runs: u64,
    /// Tests and cases.
    pub tests: u64,
    /// Results of tests and cases.
    pub results: u64,
    /// Series of measurements and signals.
    pub series: u64,
    pub points: u64,
    /// Runs that are not stored because they were pruned, or merged from others.
    pub pruned: u64,
    pub campaigns: u64,
    pub episodes: u64,
    pub pruned_campaigns: u64,
}

impl Store {
    pub(super) fn rows<T>(
        &self,
        sql: &str,
        values: &[Value<'_>],
        read: fn(&Row<'_>) -> Result<T, DatabaseError>,
    ) -> Result<Vec<T>, StoreError> {
        self.database.rows(sql, values, read).map_err(|error| self.error(error))
    }

    /// All runs, the oldest first.
    pub(crate) fn all_runs(&self) -> Result<Vec<(i64, RunInfo)>, StoreError> {
        self.rows(sql::RUNS, &[], run)
    }

    /// All tests and cases, in the order of their identities.
    pub(crate) fn all_tests(&self) -> Result<Vec<TestRow>, StoreError> {
        self.rows(sql::TESTS, &[], test)
    }

    pub(crate) fn results_of_test(&self, test: i64) -> Result<Vec<ResultRow>, StoreError> {
        self.rows(sql::RESULTS_OF_TEST, &[test.into()], result)
    }

    pub(crate) fn result_of_test(
        &self,
        test: i64,
        run: i64,
    ) -> Result<Option<ResultRow>, StoreError> {
        Ok(self.rows(sql::RESULT_OF_TEST, &[test.into(), run.into()], result)?.pop())
    }

    /// Calls `visit` with the packed results of each run from `first` to `last`.
    pub(crate) fn for_each_result_column(
        &self,
        (first, last): (i64, i64),
        mut visit: impl FnMut(i64, PackedResults<'_>),
    ) -> Result<(), StoreError> {
        self.for_each_column(sql::RESULT_COLUMNS, (first, last), |row| {
            // A run that an earlier version imported has no sources.
            let sources = row.optional_bytes(2)?.unwrap_or_default();
            visit(row.get(0)?, PackedResults::new(row.bytes(1)?, sources));
            Ok(())
        })
    }

    /// Calls `visit` with the packed points of each run from `first` to `last`.
    pub(crate) fn for_each_point_column(
        &self,
        (first, last): (i64, i64),
        mut visit: impl FnMut(i64, PackedPoints<'_>),
    ) -> Result<(), StoreError> {
        self.for_each_column(sql::POINT_COLUMNS, (first, last), |row| {
            visit(row.get(0)?, PackedPoints::new(row.bytes(1)?));
            Ok(())
        })
    }

    fn for_each_column(
        &self,
        sql: &str,
        (first, last): (i64, i64),
        mut visit: impl FnMut(&Row<'_>) -> Result<(), DatabaseError>,
    ) -> Result<(), StoreError> {
        let visited = self.database.for_each(sql, &[first.into(), last.into()], &mut visit);
        visited.map_err(|error| self.error(error))
    }

    /// All series, each with its test, in the order of their ids.
    pub(crate) fn all_series(&self) -> Result<Vec<(i64, SeriesName, i64)>, StoreError> {
        self.rows(sql::SERIES, &[], |row| {
            let (id, name) = series(row)?;
            Ok((id, name, row.get(4)?))
        })
    }

    pub(crate) fn series_of_test(&self, test: i64) -> Result<Vec<(i64, SeriesName)>, StoreError> {
        self.rows(sql::SERIES_OF_TEST, &[test.into()], series)
    }

    pub(crate) fn points_of_test(&self, test: i64) -> Result<Vec<PointRow>, StoreError> {
        self.rows(sql::POINTS_OF_TEST, &[test.into()], point)
    }

    pub(crate) fn tests_with_problems(&self) -> Result<Vec<i64>, StoreError> {
        self.rows(sql::TESTS_WITH_PROBLEMS, &[], |row| row.get(0))
    }

    pub(crate) fn tests_with_series(&self, name: &str) -> Result<Vec<i64>, StoreError> {
        self.rows(sql::TESTS_WITH_SERIES, &[name.into()], |row| row.get(0))
    }

    /// The names of all measurements and signals.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn series_names(&self) -> Result<Vec<String>, StoreError> {
        self.rows(sql::SERIES_NAMES, &[], |row| row.get(0))
    }

    /// The names of stored and pruned runs.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn run_names(&self) -> Result<Vec<String>, StoreError> {
        self.rows(sql::RUN_NAMES, &[], |row| row.get(0))
    }

    /// Number of rows.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn counts(&self) -> Result<StoreCounts, StoreError> {
        let read = |row: &Row<'_>| {
            Ok(StoreCounts {
                runs: row.get(0)?,
                tests: row.get(1)?,
                results: row.get(2)?,
                series: row.get(3)?,
                points: row.get(4)?,
                pruned: row.get(5)?,
                ..StoreCounts::default()
            })
        };
        let counts = self.rows(sql::COUNTS, &[], read)?.pop().unwrap_or_default();
        let [campaigns, episodes, pruned_campaigns] = self.campaign_counts()?;
        Ok(StoreCounts { campaigns, episodes, pruned_campaigns, ..counts })
    }

    /// Checks the structure of the database; returns what is wrong with it.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn check(&self) -> Result<Vec<String>, StoreError> {
        // A server checks its files itself.
        let Database::Sqlite(_) = &self.database else { return Ok(Vec::new()) };
        let mut found: Vec<String> = self.rows("PRAGMA quick_check(10)", &[], |row| row.get(0))?;
        found.retain(|line| line != "ok");
        let foreign = self.rows("PRAGMA foreign_key_check", &[], |row| {
            row.get::<String>(0).map(|table| format!("a row of `{table}` refers to nothing"))
        })?;
        found.extend(foreign.into_iter().take(10));
        Ok(found)
    }
}

pub(super) fn time(micros: i64) -> Timestamp {
    Timestamp::from_microsecond(micros).unwrap_or_default()
}

pub(super) fn list<T: DeserializeOwned>(
    row: &Row<'_>,
    index: usize,
) -> Result<Vec<T>, DatabaseError> {
    let text: String = row.get(index)?;
    Ok(serde_json::from_str(&text).unwrap_or_default())
}

/// A variant of an enumeration by its word; `None` if it has none with this word.
pub(super) fn word<T: DeserializeOwned>(
    row: &Row<'_>,
    index: usize,
) -> Result<Option<T>, DatabaseError> {
    let word: String = row.get(index)?;
    let word: StringDeserializer<serde::de::value::Error> = word.into_deserializer();
    Ok(T::deserialize(word).ok())
}

fn run(row: &Row<'_>) -> Result<(i64, RunInfo), DatabaseError> {
    let mut counts = [0; Verdict::ALL.len()];
    for (index, count) in counts.iter_mut().enumerate() {
        *count = row.get(7 + index)?;
    }
    let info = RunInfo {
        id: row.get(1)?,
        name: row.get(2)?,
        started: time(row.get(3)?),
        duration: row.get::<i64>(4)? as f64 / 1e6,
        end: word(row, 5)?.unwrap_or(RunEnd::Unfinished),
        green: row.get(6)?,
        counts: RunCounts(counts),
        commit: row.get(15)?,
        branch: row.get(16)?,
        dirty: row.get(17)?,
        author_time: row.get(18)?,
        ci_job: row.get(19)?,
        host: row.get(20)?,
        cpus: row.get(21)?,
        load_percent: row.get(22)?,
        profile: row.get(23)?,
        parameters: list(row, 24)?,
        rtf: row.get(25)?,
    };
    Ok((row.get(0)?, info))
}

/// The identity of a test, from the columns after its id.
pub(super) fn identity(row: &Row<'_>) -> Result<TestIdentity, DatabaseError> {
    Ok(TestIdentity {
        suite_file: row.get(1)?,
        suite: row.get(2)?,
        test: row.get(3)?,
        case: row.get(4)?,
    })
}

fn test(row: &Row<'_>) -> Result<TestRow, DatabaseError> {
    let attributes = TestAttributes {
        identity: identity(row)?,
        plugin_type: row.get(5)?,
        tags: list(row, 6)?,
        parameters: list(row, 7)?,
    };
    Ok(TestRow { id: row.get(0)?, attributes, renamed_to: row.get(8)? })
}

fn result(row: &Row<'_>) -> Result<ResultRow, DatabaseError> {
    Ok(ResultRow {
        run: row.get(0)?,
        verdict: word(row, 1)?.unwrap_or(Verdict::Error),
        is_flaky: row.get(2)?,
        attempts: row.get(3)?,
        problems: row.get(4)?,
        duration_us: row.get(5)?,
        reason: row.get(6)?,
        robot: row.get(7)?,
        plugin_hash: row.get(8)?,
        source_hash: row.get(9)?,
    })
}

pub(super) fn series(row: &Row<'_>) -> Result<(i64, SeriesName), DatabaseError> {
    let kind = word(row, 1)?.unwrap_or(NumberKind::Measurement);
    Ok((row.get(0)?, SeriesName { kind, name: row.get(2)?, unit: row.get(3)? }))
}

fn point(row: &Row<'_>) -> Result<PointRow, DatabaseError> {
    let summary = NumberSummary {
        value: row.get(2)?,
        min: row.get(3)?,
        max: row.get(4)?,
        count: row.get(5)?,
        not_finite: row.get(6)?,
        outside: row.get(7)?,
        low: row.get(8)?,
        high: row.get(9)?,
    };
    Ok(PointRow { run: row.get(0)?, series: row.get(1)?, summary })
}
