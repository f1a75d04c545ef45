//! Stores runs.

use rtf_model::Record;
use rusqlite::{OptionalExtension as _, Transaction, TransactionBehavior, params};

use super::columns::{PackedResult, PointPacker, ResultPacker};
use super::{Store, StoreError, sql};
use crate::TestIdentity;
use crate::entry::{NumberSummary, ResultEntry, RunEntry, SeriesName};

/// The effect of an import.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImportOutcome {
    /// The run is new.
    Imported,
    /// The run was stored before with fewer events, and is replaced.
    Replaced,
    /// The run is stored already.
    Known,
    /// The run was pruned, and was not imported.
    Pruned,
    /// The run was merged from others, which have its results. It was not imported.
    Merged,
}

/// Whether a run that was pruned is imported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PrunedRuns {
    /// It stays away.
    Keep,
    /// It is imported.
    Restore,
}

impl Store {
    /// Imports a run that has ended, unless it was pruned.
    ///
    /// # Errors
    /// The record is damaged, another run has its identity, or the store cannot be written;
    /// then nothing has changed.
    pub fn import(&mut self, record: &Record) -> Result<ImportOutcome, StoreError> {
        self.import_entry(&RunEntry::new(record)?, PrunedRuns::Keep)
    }

    /// Imports a run that has ended, even if it was pruned.
    ///
    /// # Errors
    /// As for [`Store::import`].
    pub fn restore(&mut self, record: &Record) -> Result<ImportOutcome, StoreError> {
        self.import_entry(&RunEntry::new(record)?, PrunedRuns::Restore)
    }

    /// Imports the entry of a run in one transaction.
    fn import_entry(
        &mut self,
        run: &RunEntry,
        pruned: PrunedRuns,
    ) -> Result<ImportOutcome, StoreError> {
        let path = self.path.clone();
        let failed = |source| StoreError::sqlite(&path, source);
        // At once for writing: two readers that both want to write would fail.
        let behavior = TransactionBehavior::Immediate;
        let transaction = self.connection.transaction_with_behavior(behavior).map_err(failed)?;
        if !run.started.manifest.parts.is_empty() {
            // Remembered, so that its journal is not read again.
            let values = [&run.id, &run.started.run];
            let remembered = transaction.execute(sql::INSERT_PRUNED, values);
            remembered.and_then(|_| transaction.commit()).map_err(failed)?;
            return Ok(ImportOutcome::Merged);
        }
        let outcome = match find(&transaction, run, pruned).map_err(failed)? {
            Found::Nothing => ImportOutcome::Imported,
            Found::Fewer(id) => {
                delete_run(&transaction, id).map_err(failed)?;
                ImportOutcome::Replaced
            }
            Found::Same => return Ok(ImportOutcome::Known),
            Found::Pruned => return Ok(ImportOutcome::Pruned),
            Found::Other => return Err(StoreError::Conflict { id: run.id.clone() }),
        };
        insert(&transaction, run).and_then(|()| transaction.commit()).map_err(failed)?;
        Ok(outcome)
    }
}

/// What is stored with the identity of a run.
enum Found {
    Nothing,
    /// The run, with fewer events.
    Fewer(i64),
    Same,
    Pruned,
    /// Another run.
    Other,
}

fn find(
    transaction: &Transaction<'_>,
    run: &RunEntry,
    pruned: PrunedRuns,
) -> rusqlite::Result<Found> {
    let is_pruned = transaction.query_row(sql::FIND_PRUNED, [&run.id], |_| Ok(())).optional()?;
    if is_pruned.is_some() && pruned == PrunedRuns::Keep {
        return Ok(Found::Pruned);
    }
    let row = |row: &rusqlite::Row<'_>| {
        Ok((row.get::<_, i64>(0)?, row.get::<_, i64>(1)?, row.get::<_, String>(2)?))
    };
    let stored = transaction.query_row(sql::FIND_RUN, [&run.id], row).optional()?;
    Ok(match stored {
        None => Found::Nothing,
        Some((_, _, started)) if started != started_text(run) => Found::Other,
        Some((id, events, _)) if events < number(run.events) => Found::Fewer(id),
        Some(_) => Found::Same,
    })
}

pub(super) fn delete_run(transaction: &Transaction<'_>, id: i64) -> rusqlite::Result<()> {
    sql::DELETE_RUN
        .iter()
        .try_for_each(|statement| transaction.prepare_cached(statement)?.execute([id]).map(drop))
}

fn insert(transaction: &Transaction<'_>, run: &RunEntry) -> rusqlite::Result<()> {
    transaction.execute(sql::DELETE_PRUNED, [&run.id])?;
    let run_id = insert_run(transaction, run)?;
    let started_us = run.started_at.as_microsecond();
    let mut columns = (ResultPacker::default(), PointPacker::default());
    run.results.iter().try_for_each(|result| {
        let test_id = upsert_test(transaction, &result.identity, result, started_us)?;
        if let Some(was) = result.was.as_ref().filter(|was| **was != result.identity.test) {
            let former = TestIdentity { test: was.clone(), ..result.identity.clone() };
            let former = upsert_test(transaction, &former, result, i64::MIN)?;
            transaction.prepare_cached(sql::RENAME_TEST)?.execute([test_id, former])?;
        }
        insert_result(transaction, (test_id, run_id), result, &mut columns)
    })?;
    let values = params![run_id, columns.0.finish(), columns.1.finish()];
    transaction.prepare_cached(sql::INSERT_RUN_COLUMNS)?.execute(values).map(drop)
}

fn insert_run(transaction: &Transaction<'_>, run: &RunEntry) -> rusqlite::Result<i64> {
    let manifest = &run.started.manifest;
    let (revision, origin) = (manifest.revision.as_ref(), manifest.origin.as_ref());
    let counts = &run.counts;
    let parameters = [
        &run.id as &dyn rusqlite::ToSql,
        &run.started.run,
        &run.started_at.as_microsecond(),
        &run.duration_us,
        &run.end.as_str(),
        &run.is_green,
        &counts[0],
        &counts[1],
        &counts[2],
        &counts[3],
        &counts[4],
        &counts[5],
        &counts[6],
        &counts[7],
        &revision.map(|it| &it.commit),
        &revision.and_then(|it| it.branch.as_ref()),
        &revision.and_then(|it| it.dirty),
        &revision.and_then(|it| it.author_time.as_ref()),
        &origin.and_then(|it| it.ci_job.as_ref()),
        &origin.map(|it| &it.host),
        &origin.map(|it| it.cpus),
        &origin.and_then(|it| it.load_percent),
        &manifest.profile,
        &json(&manifest.set),
        &run.started.rtf,
        &number(run.events),
        &started_text(run),
    ];
    transaction.prepare_cached(sql::INSERT_RUN)?.query_row(&parameters[..], |row| row.get(0))
}

fn upsert_test(
    transaction: &Transaction<'_>,
    identity: &TestIdentity,
    result: &ResultEntry,
    seen_us: i64,
) -> rusqlite::Result<i64> {
    let TestIdentity { suite_file, suite, test, case } = identity;
    let (tags, parameters) = (json(&result.tags), json(&result.parameters));
    let values =
        params![suite_file, suite, test, case, result.plugin_type, tags, parameters, seen_us];
    transaction.prepare_cached(sql::UPSERT_TEST)?.query_row(values, |row| row.get(0))
}

fn insert_result(
    transaction: &Transaction<'_>,
    (test_id, run_id): (i64, i64),
    result: &ResultEntry,
    columns: &mut (ResultPacker, PointPacker),
) -> rusqlite::Result<()> {
    let packed = PackedResult {
        test: test_id,
        verdict: result.verdict,
        is_flaky: result.is_flaky,
        robot: 0,
        duration_us: result.duration_us,
    };
    columns.0.add(packed, &result.robot);
    transaction.prepare_cached(sql::INSERT_RESULT)?.execute(params![
        test_id,
        run_id,
        result.verdict.as_str(),
        result.is_flaky,
        result.attempts,
        result.problems,
        result.duration_us,
        result.reason,
        result.robot,
        result.plugin_hash,
    ])?;
    result.numbers.iter().try_for_each(|(series, summary)| {
        let series_id = find_series(transaction, test_id, series)?;
        columns.1.add(series_id, summary);
        insert_point(transaction, (test_id, run_id, series_id), summary)
    })
}

fn find_series(
    transaction: &Transaction<'_>,
    test_id: i64,
    series: &SeriesName,
) -> rusqlite::Result<i64> {
    let values = params![test_id, series.kind.as_str(), series.name, series.unit];
    let mut find = transaction.prepare_cached(sql::FIND_SERIES)?;
    match find.query_row(values, |row| row.get(0)).optional()? {
        Some(id) => Ok(id),
        None => transaction.prepare_cached(sql::INSERT_SERIES)?.query_row(values, |row| row.get(0)),
    }
}

fn insert_point(
    transaction: &Transaction<'_>,
    (test_id, run_id, series_id): (i64, i64, i64),
    summary: &NumberSummary,
) -> rusqlite::Result<()> {
    let values = params![
        test_id,
        run_id,
        series_id,
        summary.value,
        summary.min,
        summary.max,
        number(summary.count),
        number(summary.not_finite),
        number(summary.outside),
        summary.low,
        summary.high,
    ];
    transaction.prepare_cached(sql::INSERT_POINT)?.execute(values).map(drop)
}

/// The first event as text: equal for journals of the same run only.
fn started_text(run: &RunEntry) -> String {
    json(&run.started)
}

fn json(value: &impl serde::Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

fn number(number: u64) -> i64 {
    i64::try_from(number).unwrap_or(i64::MAX)
}
