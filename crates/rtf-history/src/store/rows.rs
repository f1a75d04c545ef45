//! The rows of the results of a run, written many at a time, and its packed columns.

use std::collections::{HashMap, HashSet};

use super::columns::{PackedResult, PointPacker, ResultPacker};
use super::database::{Database, DatabaseError, Row, Value};
use super::json::json;
use super::{read, sql};
use crate::TestIdentity;
use crate::entry::{ResultEntry, RunEntry, SeriesName};

/// Results, each with the row of its test.
type Results<'a> = Vec<(i64, &'a ResultEntry)>;

/// How many results are in memory as values of the database.
const RESULTS_AT_ONCE: usize = 4096;

/// The packed columns of a run.
#[derive(Default)]
struct Columns {
    results: ResultPacker,
    points: PointPacker,
}

/// Adds the results of a run.
pub(super) fn insert(
    database: &Database,
    run_id: i64,
    run: &RunEntry,
) -> Result<(), DatabaseError> {
    let started_us = run.started_at.as_microsecond();
    let mut seen = HashSet::new();
    let results = run.results.iter().filter(|result| seen.insert(&result.identity));
    let results: Vec<_> = results.collect();
    let mut columns = Columns::default();
    for part in results.chunks(RESULTS_AT_ONCE) {
        let results = with_tests(database, part, started_us)?;
        insert_results(database, run_id, &results, &mut columns)?;
    }
    let ((results, sources), points) = (columns.results.finish(), columns.points.finish());
    let blobs = [&results, &points, &sources].map(|blob| Value::from(blob.as_slice()));
    let [results, points, sources] = blobs;
    let values = [run_id.into(), results, points, sources];
    database.execute(sql::INSERT_RUN_COLUMNS, &values)
}

/// Adds or updates the rows of the tests of results.
fn with_tests<'a>(
    database: &Database,
    results: &[&'a ResultEntry],
    started_us: i64,
) -> Result<Results<'a>, DatabaseError> {
    let current = results.iter().map(|result| (result.identity.clone(), *result));
    let ids = upsert(database, current.collect(), started_us)?;
    // Of several tests with one former name, the last one continues its history.
    let former = results.iter().filter_map(|result| {
        let was = result.was.as_ref().filter(|was| **was != result.identity.test)?;
        Some((TestIdentity { test: was.clone(), ..result.identity.clone() }, *result))
    });
    let former: HashMap<_, _> = former.collect();
    let former_ids =
        upsert(database, former.iter().map(|(it, by)| (it.clone(), *by)).collect(), i64::MIN)?;
    for (identity, result) in &former {
        if let (Some(id), Some(former)) = (ids.get(&result.identity), former_ids.get(identity)) {
            database.execute(sql::RENAME_TEST, &[(*id).into(), (*former).into()])?;
        }
    }
    let with_ids = results.iter().filter_map(|it| Some((*ids.get(&it.identity)?, *it)));
    Ok(with_ids.collect())
}

struct StoredTest {
    id: i64,
    /// Type of the plug-in, tags and parameters.
    attributes: [String; 3],
    /// The start of the run from which the attributes are. A later run may have the same ones.
    seen_us: i64,
}

/// Adds tests, or updates their attributes if no newer run is known; returns their rows.
fn upsert(
    database: &Database,
    tests: Vec<(TestIdentity, &ResultEntry)>,
    seen_us: i64,
) -> Result<HashMap<TestIdentity, i64>, DatabaseError> {
    // Most tests have the same attributes in each run: to read is faster than to write.
    let stored = find(database, &tests)?;
    let mut ids = HashMap::new();
    let mut values: Vec<Value<'_>> = Vec::new();
    let attributes = |result: &ResultEntry| {
        [result.plugin_type.clone(), json(&result.tags), json(&result.parameters)]
    };
    let attributes: Vec<_> = tests.iter().map(|(_, result)| attributes(result)).collect();
    for ((identity, _), attributes) in tests.iter().zip(&attributes) {
        if let Some(stored) = stored.get(identity)
            && (stored.attributes == *attributes || is_newer(database, stored, seen_us)?)
        {
            ids.insert(identity.clone(), stored.id);
            continue;
        }
        let TestIdentity { suite_file, suite, test, case } = identity;
        values.extend([suite_file, suite, test, case].map(Value::from));
        values.extend(attributes.iter().map(Value::from));
        values.push(seen_us.into());
    }
    database.batch(&sql::UPSERT_TESTS, &values, &mut |row| {
        ids.insert(read::identity(row)?, row.get(0)?);
        Ok(())
    })?;
    Ok(ids)
}

/// The tests that are stored.
fn find(
    database: &Database,
    tests: &[(TestIdentity, &ResultEntry)],
) -> Result<HashMap<TestIdentity, StoredTest>, DatabaseError> {
    let mut values: Vec<Value<'_>> = Vec::with_capacity(tests.len() * sql::FIND_TESTS.columns);
    for (TestIdentity { suite_file, suite, test, case }, _) in tests {
        values.extend([suite_file, suite, test, case].map(Value::from));
    }
    let mut stored = HashMap::with_capacity(tests.len());
    database.batch(&sql::FIND_TESTS, &values, &mut |row| {
        let attributes = [row.get(5)?, row.get(6)?, row.get(7)?];
        let test = StoredTest { id: row.get(0)?, attributes, seen_us: row.get(8)? };
        stored.insert(read::identity(row)?, test);
        Ok(())
    })?;
    Ok(stored)
}

/// Whether the attributes of a test are from a run after this time.
fn is_newer(database: &Database, stored: &StoredTest, seen_us: i64) -> Result<bool, DatabaseError> {
    let id = [stored.id.into()];
    let newest = database.rows(sql::NEWEST_START, &id, |row| row.get::<Option<i64>>(0))?;
    let newest = newest.into_iter().flatten().max().unwrap_or(i64::MIN);
    Ok(stored.seen_us.max(newest) > seen_us)
}

/// Adds results with their points.
fn insert_results(
    database: &Database,
    run_id: i64,
    results: &Results<'_>,
    columns: &mut Columns,
) -> Result<(), DatabaseError> {
    let series = series(database, results)?;
    let (mut rows, mut points): (Vec<Value<'_>>, Vec<Value<'_>>) = (Vec::new(), Vec::new());
    for (test, result) in results {
        rows.extend(result_row(*test, run_id, result));
        columns.results.add(PackedResult::new(*test, result), &result.robot);
        for (name, summary) in &result.numbers {
            let Some(series) = series.get(&(*test, name.clone())) else { continue };
            columns.points.add(*series, summary);
            points.extend::<[Value<'_>; 11]>([
                (*test).into(),
                run_id.into(),
                (*series).into(),
                summary.value.into(),
                summary.min.into(),
                summary.max.into(),
                summary.count.into(),
                summary.not_finite.into(),
                summary.outside.into(),
                summary.low.into(),
                summary.high.into(),
            ]);
        }
    }
    database.batch(&sql::INSERT_RESULTS, &rows, &mut |_| Ok(()))?;
    database.batch(&sql::INSERT_POINTS, &points, &mut |_| Ok(()))
}

fn result_row(test: i64, run: i64, result: &ResultEntry) -> [Value<'_>; 11] {
    [
        test.into(),
        run.into(),
        result.verdict.as_str().into(),
        result.is_flaky.into(),
        result.attempts.into(),
        result.problems.into(),
        result.duration_us.into(),
        result.reason.as_ref().into(),
        (&result.robot).into(),
        result.plugin_hash.as_ref().into(),
        result.source_hash.as_ref().into(),
    ]
}

/// The rows of series, by the row of their test and their name.
type SeriesRows = HashMap<(i64, SeriesName), i64>;

/// The rows of the series of the results; adds those that are new.
fn series(database: &Database, results: &Results<'_>) -> Result<SeriesRows, DatabaseError> {
    let with_numbers = results.iter().filter(|(_, result)| !result.numbers.is_empty());
    let tests: Vec<_> = with_numbers.map(|(test, _)| Value::Int(*test)).collect();
    let mut known = HashMap::new();
    database.batch(&sql::FIND_SERIES, &tests, &mut |row| remember(row, &mut known))?;
    let mut added = Vec::new();
    for (test, result) in results {
        for (name, _) in &result.numbers {
            if !known.contains_key(&(*test, name.clone())) {
                let SeriesName { kind, name, unit } = name;
                added.extend::<[Value<'_>; 4]>([
                    (*test).into(),
                    kind.as_str().into(),
                    name.into(),
                    unit.into(),
                ]);
            }
        }
    }
    database.batch(&sql::INSERT_SERIES, &added, &mut |row| remember(row, &mut known))?;
    Ok(known)
}

fn remember(row: &Row<'_>, series: &mut SeriesRows) -> Result<(), DatabaseError> {
    let (id, name) = read::series(row)?;
    series.insert((row.get(4)?, name), id);
    Ok(())
}
