//! Stores runs.

use rtf_model::Record;

use super::database::{Database, DatabaseError, Value};
use super::json::json;
use super::{Store, StoreError, rows, sql};
use crate::entry::RunEntry;

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
        let failed = |error| StoreError::new(&self.location, error);
        let transaction = self.database.begin().map_err(failed)?;
        let outcome = if run.started.manifest.parts.is_empty() {
            match find(&transaction, run, pruned).map_err(failed)? {
                Found::Nothing => ImportOutcome::Imported,
                Found::Fewer(id) => {
                    delete_run(&transaction, id).map_err(failed)?;
                    ImportOutcome::Replaced
                }
                Found::Same => return Ok(ImportOutcome::Known),
                Found::Pruned => return Ok(ImportOutcome::Pruned),
                Found::Other => return Err(StoreError::Conflict { id: run.id.clone() }),
            }
        } else {
            ImportOutcome::Merged
        };
        let stored = match outcome {
            // Remembered, so that its journal is not read again.
            ImportOutcome::Merged => {
                let values = [(&run.id).into(), (&run.started.run).into()];
                transaction.execute(sql::INSERT_PRUNED, &values)
            }
            _ => insert(&transaction, run),
        };
        stored.and_then(|()| transaction.commit()).map_err(failed)?;
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
    Other,
}

fn find(database: &Database, run: &RunEntry, pruned: PrunedRuns) -> Result<Found, DatabaseError> {
    let id = [(&run.id).into()];
    let is_pruned = !database.rows(sql::FIND_PRUNED, &id, |_| Ok(()))?.is_empty();
    if is_pruned && pruned == PrunedRuns::Keep {
        return Ok(Found::Pruned);
    }
    let stored = database.rows(sql::FIND_RUN, &id, |row| {
        Ok((row.get::<i64>(0)?, row.get::<u64>(1)?, row.get::<String>(2)?))
    })?;
    Ok(match stored.into_iter().next() {
        None => Found::Nothing,
        Some((_, _, started)) if started != started_text(run) => Found::Other,
        Some((id, events, _)) if events < run.events => Found::Fewer(id),
        Some(_) => Found::Same,
    })
}

pub(super) fn delete_run(database: &Database, id: i64) -> Result<(), DatabaseError> {
    sql::DELETE_RUN.iter().try_for_each(|statement| database.execute(statement, &[id.into()]))
}

fn insert(database: &Database, run: &RunEntry) -> Result<(), DatabaseError> {
    database.execute(sql::DELETE_PRUNED, &[(&run.id).into()])?;
    let run_id = insert_run(database, run)?;
    rows::insert(database, run_id, run)
}

fn insert_run(database: &Database, run: &RunEntry) -> Result<i64, DatabaseError> {
    let manifest = &run.started.manifest;
    let (revision, origin) = (manifest.revision.as_ref(), manifest.origin.as_ref());
    let (set, started) = (json(&manifest.set), started_text(run));
    let mut values: Vec<Value<'_>> = vec![
        (&run.id).into(),
        (&run.started.run).into(),
        run.started_at.as_microsecond().into(),
        run.duration_us.into(),
        run.end.as_str().into(),
        run.is_green.into(),
    ];
    values.extend(run.counts.iter().map(|count| Value::from(*count)));
    values.extend::<[Value<'_>; 13]>([
        revision.map(|it| &it.commit).into(),
        revision.and_then(|it| it.branch.as_ref()).into(),
        revision.and_then(|it| it.dirty).into(),
        revision.and_then(|it| it.author_time.as_ref()).into(),
        origin.and_then(|it| it.ci_job.as_ref()).into(),
        origin.map(|it| &it.host).into(),
        origin.map(|it| it.cpus).into(),
        origin.and_then(|it| it.load_percent).into(),
        manifest.profile.as_ref().into(),
        (&set).into(),
        (&run.started.rtf).into(),
        run.events.into(),
        (&started).into(),
    ]);
    let ids = database.rows(sql::INSERT_RUN, &values, |row| row.get(0))?;
    Ok(ids.into_iter().next().unwrap_or_default())
}

/// The first event as text: equal for journals of the same run only.
fn started_text(run: &RunEntry) -> String {
    json(&run.started)
}
