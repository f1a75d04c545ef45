//! Finds and reads past runs.

use std::path::{Path, PathBuf};

use rtf_model::{Record, TestRecord};
use rtf_report::journal::{self, JournalError};
use rtf_report::run_dir;

use crate::error::Failure;

/// Finds the journal of a run, without the link `latest` in its path, which may
/// refer to another run tomorrow.
pub fn find_journal(results: &Path, run: &str) -> Result<PathBuf, Failure> {
    let journal = run_dir::resolve(results, run).map_err(|error| {
        let hint = error.hint();
        Failure::input(error).maybe_hint(hint)
    })?;
    Ok(without_link(&journal).unwrap_or(journal))
}

fn without_link(journal: &Path) -> Option<PathBuf> {
    let link = journal.parent()?;
    let dir = std::fs::read_link(link).ok()?;
    Some(link.parent()?.join(dir).join(journal.file_name()?))
}

/// Reads a run that must not be damaged.
pub fn read(results: &Path, run: &str) -> Result<Record, Failure> {
    let stored = journal::read(&find_journal(results, run)?).map_err(unreadable)?;
    refuse_damaged(run, &stored.record)?;
    Ok(stored.record)
}

/// An invalid journal is bad input; a report that cannot be written is not.
pub fn unreadable(error: JournalError) -> Failure {
    match error {
        JournalError::Report(error) => Failure::internal(error),
        error => Failure::input(error),
    }
}

/// Refuses a damaged journal, for verbs whose output would hide missing events.
pub fn refuse_damaged(run: &str, record: &Record) -> Result<(), Failure> {
    let Some(damage) = record.damages.first() else { return Ok(()) };
    let error = format!("the journal of `{run}` is damaged: {damage}");
    Err(Failure::input(error).hint(damage_hint(run)))
}

/// What to do about a damaged journal.
pub fn damage_hint(run: &str) -> String {
    format!("`rtf show {}` shows the readable part", shell_words::quote(run))
}

/// The names of a test's suite and of the test.
pub fn names(record: &Record, test: &TestRecord) -> Option<(String, String)> {
    let suite = record.suites.get(test.plan.suite.index())?;
    Some((suite.plan.name.clone(), test.plan.name.clone()))
}
