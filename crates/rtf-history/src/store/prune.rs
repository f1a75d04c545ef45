//! Removes old runs.

use std::collections::HashSet;

use jiff::Timestamp;

use super::database::{DatabaseError, Value};
use super::{Store, StoreError, sql};
use crate::answers::RunInfo;

/// Which runs to keep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    Newest(usize),
    /// Runs that started at this time or later.
    Since(Timestamp),
}

impl Keep {
    /// Whether to keep one that started at this time and has `newer` ones after it.
    pub(super) fn keeps(self, newer: usize, started: Timestamp) -> bool {
        match self {
            Self::Newest(number) => newer < number,
            Self::Since(time) => started >= time,
        }
    }
}

impl Store {
    /// The runs that [`Store::prune`] would remove, the oldest first. A run stays if a test
    /// has passed in it and in no later run.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn prunable(&self, keep: Keep) -> Result<Vec<RunInfo>, StoreError> {
        Ok(self.find_prunable(keep)?.into_iter().map(|(_, run)| run).collect())
    }

    /// Removes runs, and remembers their identities.
    ///
    /// # Errors
    /// The database cannot be written; then nothing has changed.
    pub fn prune(&mut self, keep: Keep) -> Result<Vec<RunInfo>, StoreError> {
        let removed = self.find_prunable(keep)?;
        let names = removed.iter().map(|(id, run)| (*id, [&run.id, &run.name]));
        self.remove(names, &sql::DELETE_RUN, sql::INSERT_PRUNED, &sql::DELETE_UNUSED)?;
        Ok(removed.into_iter().map(|(_, run)| run).collect())
    }

    /// Deletes rows with everything that belongs to them, and remembers their names. Then executes
    /// `finish`.
    pub(super) fn remove<'a>(
        &self,
        rows: impl Iterator<Item = (i64, [&'a String; 2])>,
        delete: &[&str],
        remember: &str,
        finish: &[&str],
    ) -> Result<(), StoreError> {
        let remove = || {
            let transaction = self.database.begin()?;
            for (id, names) in rows {
                transaction.delete(delete, id)?;
                transaction.execute(remember, &names.map(Value::from))?;
            }
            finish.iter().try_for_each(|statement| transaction.execute(statement, &[]))?;
            transaction.commit()
        };
        remove().map_err(|error: DatabaseError| self.error(error))
    }

    fn find_prunable(&self, keep: Keep) -> Result<Vec<(i64, RunInfo)>, StoreError> {
        let mut passed_later = HashSet::new();
        let mut prunable = Vec::new();
        for (newer, (id, run)) in self.all_runs()?.into_iter().rev().enumerate() {
            let passed: Vec<i64> =
                self.rows(sql::PASSED_TESTS_OF_RUN, &[id.into()], |row| row.get(0))?;
            let has_last_pass = passed.iter().any(|test| !passed_later.contains(test));
            passed_later.extend(passed);
            if !has_last_pass && !keep.keeps(newer, run.started) {
                prunable.push((id, run));
            }
        }
        prunable.reverse();
        Ok(prunable)
    }
}
