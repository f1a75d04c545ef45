//! `rtf history import`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_history::{ImportOutcome, Store, StoreError};
use rtf_report::format_count;
use serde::Serialize;

use super::{failure, print, resolve};
use crate::cli::HistoryImportArgs;
use crate::command::VerbResult;
use crate::error::Failure;
use crate::exit;
use crate::history::journals::{self, JournalImport};

/// What was imported.
#[derive(Debug, Default, Serialize)]
struct ImportSummary {
    imported: u64,
    replaced: u64,
    known: u64,
    merged: u64,
    active: Vec<String>,
    failed: Vec<FailedJournal>,
}

/// A journal that was not imported.
#[derive(Debug, Serialize)]
struct FailedJournal {
    journal: String,
    reason: String,
}

/// Imports journals.
pub fn run(mut args: HistoryImportArgs, matches: &ArgMatches) -> VerbResult {
    let path = resolve(&mut args.history.results, &mut args.history.file, matches)?;
    let journals = find_journals(&args)?;
    let mut store = Store::open(&path).map_err(failure)?;
    let mut summary = ImportSummary::default();
    for journal in journals {
        let imported = journals::import(&journal, |record| store.restore(record));
        summary.add(&journal, imported)?;
    }
    print(args.history.format, "imported", &summary, |out| {
        write!(out, "{} imported", format_count(summary.imported, "run"))?;
        if summary.replaced > 0 {
            write!(out, ", {} replaced", summary.replaced)?;
        }
        if summary.known > 0 {
            write!(out, ", {} already there", summary.known)?;
        }
        if summary.merged > 0 {
            write!(out, ", {} left out (merged from others)", summary.merged)?;
        }
        if !summary.active.is_empty() {
            write!(out, ", {} still active", summary.active.len())?;
        }
        writeln!(out)
    })?;
    Ok(ExitCode::from(if summary.failed.is_empty() { exit::PASSED } else { exit::FAILED }))
}

fn find_journals(args: &HistoryImportArgs) -> Result<Vec<PathBuf>, Failure> {
    let dirs = match args.dirs.as_slice() {
        [] => std::slice::from_ref(&args.history.results.results),
        dirs => dirs,
    };
    let mut journals = Vec::new();
    for dir in dirs {
        let found = journals::below(dir);
        if found.is_empty() {
            let error = format!("there are no runs in `{}`", dir.display());
            return Err(Failure::input(error)
                .hint("name a results directory, a run's directory, or a journal"));
        }
        journals.extend(found);
    }
    Ok(journals)
}

impl ImportSummary {
    /// Counts an import; reports one that failed. Stops if the database cannot be written.
    fn add(&mut self, journal: &Path, imported: JournalImport) -> Result<(), Failure> {
        let name = journal.display().to_string();
        let failed = match imported {
            JournalImport::Done(ImportOutcome::Imported) => {
                self.imported += 1;
                return Ok(());
            }
            JournalImport::Done(ImportOutcome::Replaced) => {
                self.replaced += 1;
                return Ok(());
            }
            JournalImport::Done(ImportOutcome::Known | ImportOutcome::Pruned) => {
                self.known += 1;
                return Ok(());
            }
            JournalImport::Done(ImportOutcome::Merged) => {
                self.merged += 1;
                return Ok(());
            }
            JournalImport::Active => {
                self.active.push(name);
                return Ok(());
            }
            JournalImport::Store(
                error @ (StoreError::Io { .. }
                | StoreError::Locked { .. }
                | StoreError::Corrupt { .. }),
            ) => return Err(failure(error)),
            JournalImport::Store(error) => (error.to_string(), error.hint()),
            JournalImport::Unreadable(error) => (error.to_string(), None),
            JournalImport::Empty => ("it has no first event".to_owned(), None),
        };
        let (reason, hint) = failed;
        let error = format!("`{name}` was not imported: {reason}");
        Failure::input(error).maybe_hint(hint).print();
        self.failed.push(FailedJournal { journal: name, reason });
        Ok(())
    }
}
