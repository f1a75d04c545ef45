//! Finds journals and imports them.

use std::collections::HashSet;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

use rtf_history::{ImportOutcome, StoreError};
use rtf_model::{Record, RunState};
use rtf_report::journal::{self, JournalError};
use rtf_report::run_dir::{JOURNAL, LATEST};

/// The result of the import of a journal.
#[derive(Debug)]
pub enum JournalImport {
    /// It was read.
    Done(ImportOutcome),
    /// Its runner is still active.
    Active,
    /// It has no first event yet: its runner was killed at once.
    Empty,
    /// It cannot be read.
    Unreadable(JournalError),
    /// It cannot be stored.
    Store(StoreError),
}

/// The journals in a results directory whose runs are not `known` by name, the newest first.
pub fn missing(results: &Path, known: &HashSet<String>) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(results) else { return Vec::new() };
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<_> = names.filter(|name| name != LATEST && !known.contains(name)).collect();
    names.sort_unstable_by(|a, b| b.cmp(a));
    let journals = names.into_iter().map(|name| results.join(name).join(JOURNAL));
    journals.filter(|journal| journal.is_file()).collect()
}

/// The journals of a results directory, a run directory, or a journal itself, the oldest
/// first.
pub fn below(path: &Path) -> Vec<PathBuf> {
    if path.is_file() {
        return vec![path.to_owned()];
    }
    let journal = path.join(JOURNAL);
    if journal.is_file() {
        return vec![journal];
    }
    let mut journals = missing(path, &HashSet::new());
    journals.reverse();
    journals
}

/// Imports a journal.
pub fn import(
    journal: &Path,
    import: impl FnOnce(&Record) -> Result<ImportOutcome, StoreError>,
) -> JournalImport {
    let record = match journal::read(journal) {
        Ok(stored) => stored.record,
        Err(error) => return JournalImport::Unreadable(error),
    };
    let is_active = record.state == RunState::Running
        && File::open(journal).is_ok_and(|journal| journal::is_written(&journal));
    match record.run {
        _ if is_active => JournalImport::Active,
        None if !record.is_damaged() => JournalImport::Empty,
        _ => import(&record).map_or_else(JournalImport::Store, JournalImport::Done),
    }
}
