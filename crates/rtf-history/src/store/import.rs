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

impl Store {
    /// Imports a run that has ended, unless it was pruned.
    ///
    /// # Errors
    /// The record is damaged, another run has its identity, or the store cannot be written;
    /// then nothing has changed.
    pub fn import(&mut self, record: &Record) -> Result<ImportOutcome, StoreError> {
        self.import_entry(&RunEntry::new(record)?, false)
    }

    /// Imports a run that has ended, even if it was pruned.
    ///
    /// # Errors
    /// As for [`Store::import`].
    pub fn restore(&mut self, record: &Record) -> Result<ImportOutcome, StoreError> {
        self.import_entry(&RunEntry::new(record)?, true)
    }

    /// Imports the entry of a run in one transaction.
    fn import_entry(
        &mut self,
        run: &RunEntry,
        restores: bool,
    ) -> Result<ImportOutcome, StoreError> {
        let failed = |error| StoreError::new(&self.location, error);
        let transaction = self.database.begin().map_err(failed)?;
        if !run.started.manifest.parts.is_empty() {
            // Remembered, so that its journal is not read again.
            let values = [(&run.id).into(), (&run.started.run).into()];
            let remembered = transaction.execute(sql::INSERT_PRUNED, &values);
            remembered.and_then(|()| transaction.commit()).map_err(failed)?;
            return Ok(ImportOutcome::Merged);
        }
        let id = [(&run.id).into()];
        let pruned = transaction.rows(sql::FIND_PRUNED, &id, |_| Ok(())).map_err(failed)?;
        if !pruned.is_empty() && !restores {
            return Ok(ImportOutcome::Pruned);
        }
        let stored = transaction.rows(sql::FIND_RUN, &id, |row| {
            Ok((row.get::<i64>(0)?, row.get::<u64>(1)?, row.get::<String>(2)?))
        });
        let outcome = match stored.map_err(failed)?.pop() {
            None => ImportOutcome::Imported,
            Some((_, _, started)) if started != started_text(run) => {
                return Err(StoreError::Conflict { id: run.id.clone() });
            }
            Some((id, events, _)) if events < run.events => {
                transaction.delete(&sql::DELETE_RUN, id).map_err(failed)?;
                ImportOutcome::Replaced
            }
            Some(_) => return Ok(ImportOutcome::Known),
        };
        insert(&transaction, run).and_then(|()| transaction.commit()).map_err(failed)?;
        Ok(outcome)
    }
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
