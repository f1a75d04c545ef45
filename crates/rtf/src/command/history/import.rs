//! `rtf history import`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_history::{ImportOutcome, Store, StoreError};
use rtf_report::format_count;
use rtf_run::error::Failure;
use rtf_run::exit;
use rtf_run::history::campaigns::{self, CampaignImport};
use rtf_run::history::journals::{self, JournalImport};
use serde::Serialize;

use super::{failure, print, resolve};
use crate::cli::HistoryImportArgs;
use crate::command::VerbResult;

/// What was imported.
#[derive(Debug, Default, Serialize)]
struct ImportSummary {
    imported: u64,
    replaced: u64,
    known: u64,
    merged: u64,
    /// Campaigns that were imported or replaced.
    campaigns: u64,
    active: Vec<String>,
    failed: Vec<FailedJournal>,
}

/// A journal, or a directory of a campaign, that was not imported.
#[derive(Debug, Serialize)]
struct FailedJournal {
    journal: String,
    reason: String,
}

/// Imports runs and campaigns.
pub fn run(mut args: HistoryImportArgs, matches: &ArgMatches) -> VerbResult {
    let path = resolve(&mut args.history.results, &mut args.history.file, matches)?;
    let (journals, directories) = find_sources(&args)?;
    let mut store = Store::open(&path).map_err(failure)?;
    let mut summary = ImportSummary::default();
    for journal in journals {
        let imported = journals::import(&journal, |record| store.restore(record));
        summary.add(&journal, imported)?;
    }
    for dir in directories {
        let imported = campaigns::import(&dir, |entry| store.restore_campaign(entry));
        summary.add_campaign(&dir, imported)?;
    }
    print(args.history.format, "imported", &summary, |out| {
        write!(out, "{} imported", format_count(summary.imported, "run"))?;
        if summary.campaigns > 0 {
            write!(out, ", {} imported", format_count(summary.campaigns, "campaign"))?;
        }
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

/// The journals, and the directories of campaigns.
fn find_sources(args: &HistoryImportArgs) -> Result<(Vec<PathBuf>, Vec<PathBuf>), Failure> {
    let dirs = match args.dirs.as_slice() {
        [] => std::slice::from_ref(&args.history.results.results),
        dirs => dirs,
    };
    let (mut journals, mut directories) = (Vec::new(), Vec::new());
    for dir in dirs {
        let (found, campaigns) = (journals::below(dir), campaigns::below(dir));
        if found.is_empty() && campaigns.is_empty() {
            let error = format!("there are no runs and no campaigns in `{}`", dir.display());
            return Err(Failure::input(error)
                .hint("name a results directory, a directory of a run or campaign, or a journal"));
        }
        journals.extend(found);
        directories.extend(campaigns);
    }
    Ok((journals, directories))
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
        self.fail(name, failed);
        Ok(())
    }

    /// Counts the import of a campaign; as [`ImportSummary::add`].
    fn add_campaign(&mut self, dir: &Path, imported: CampaignImport) -> Result<(), Failure> {
        let name = dir.display().to_string();
        match imported {
            CampaignImport::Done(ImportOutcome::Imported | ImportOutcome::Replaced) => {
                self.campaigns += 1;
            }
            CampaignImport::Done(_) => self.known += 1,
            CampaignImport::Active => self.active.push(name),
            CampaignImport::Store(
                error @ (StoreError::Io { .. }
                | StoreError::Locked { .. }
                | StoreError::Corrupt { .. }),
            ) => return Err(failure(error)),
            CampaignImport::Store(error) => self.fail(name, (error.to_string(), error.hint())),
            CampaignImport::Unreadable(reason) => self.fail(name, (reason, None)),
        }
        Ok(())
    }

    /// Reports what was not imported.
    fn fail(&mut self, name: String, (reason, hint): (String, Option<&'static str>)) {
        let error = format!("`{name}` was not imported: {reason}");
        Failure::input(error).maybe_hint(hint).print();
        self.failed.push(FailedJournal { journal: name, reason });
    }
}
