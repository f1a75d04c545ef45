//! Removes old runs.

use std::collections::HashSet;

use jiff::Timestamp;

use super::{Store, StoreError, import, sql};
use crate::answers::RunInfo;

/// Which runs to keep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    Newest(usize),
    /// Runs that started at this time or later.
    Since(Timestamp),
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
        let remove = || {
            let transaction = self.database.begin()?;
            for (id, run) in &removed {
                import::delete_run(&transaction, *id)?;
                let values = [(&run.id).into(), (&run.name).into()];
                transaction.execute(sql::INSERT_PRUNED, &values)?;
            }
            for statement in sql::DELETE_UNUSED {
                transaction.execute(statement, &[])?;
            }
            transaction.commit()
        };
        remove().map_err(|error| self.error(error))?;
        Ok(removed.into_iter().map(|(_, run)| run).collect())
    }

    fn find_prunable(&self, keep: Keep) -> Result<Vec<(i64, RunInfo)>, StoreError> {
        let runs = self.all_runs()?;
        let is_kept = |index: usize, run: &RunInfo| match keep {
            Keep::Newest(number) => index + number >= runs.len(),
            Keep::Since(time) => run.started >= time,
        };
        let mut passed_later = HashSet::new();
        let mut prunable = Vec::new();
        for (index, (id, run)) in runs.iter().enumerate().rev() {
            let passed: Vec<i64> =
                self.rows(sql::PASSED_TESTS_OF_RUN, &[(*id).into()], |row| row.get(0))?;
            let has_last_pass = passed.iter().any(|test| !passed_later.contains(test));
            passed_later.extend(passed);
            if !has_last_pass && !is_kept(index, run) {
                prunable.push((*id, run.clone()));
            }
        }
        prunable.reverse();
        Ok(prunable)
    }
}
