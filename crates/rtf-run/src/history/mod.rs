//! The history of a run: which database, and the import when the run has ended. Nothing here
//! changes the verdict or the exit code of a run.

pub mod campaigns;
pub mod journals;
mod learned;
mod past_tests;
mod source;
mod test_filter;
pub mod time;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rtf_history::{Location, RunSelection, Store, StoreError};
use rtf_model::Record;
use rtf_report::run_dir::JOURNAL;

pub use source::ServedHistory;
pub use test_filter::TestFilter;

use crate::error::Failure;
use crate::{revision, terminal};
use journals::JournalImport;

pub use learned::{OpenChange, is_learning, learn, open_changes};
pub use past_tests::PastTests;

/// The name of the database in the results directory.
const FILE_NAME: &str = "history.db";

/// How long the end of a run may be delayed by imports of earlier runs.
const CATCH_UP_LIMIT: Duration = Duration::from_secs(1);

/// The usual names of default branches.
const DEFAULT_BRANCHES: [&str; 2] = ["main", "master"];

/// The default branch of a directory's repository, or else that of the history: the first one
/// of which it has runs.
pub fn default_branch(store: &Store, dir: &Path) -> Result<Option<String>, StoreError> {
    let runs = store.runs(&RunSelection::default())?;
    let here = revision::default_branch(dir);
    let mut candidates = here.iter().map(String::as_str).chain(DEFAULT_BRANCHES);
    let has_runs = |branch: &&str| runs.iter().any(|run| run.branch.as_deref() == Some(*branch));
    Ok(candidates.find(has_runs).map(str::to_owned))
}

/// Where runs are imported when they end.
#[derive(Clone, Debug)]
pub struct HistoryTarget {
    pub database: Location,
    /// The results directory, in which earlier runs may be missing in the database.
    pub results: PathBuf,
}

impl HistoryTarget {
    /// The database of a results directory, or another one.
    pub fn resolve(url: Option<&str>, results: &Path) -> Result<Self, Failure> {
        Ok(Self { database: resolve(url, results)?, results: results.to_owned() })
    }
}

/// Whether this is the database in a results directory, or its write-ahead log or index.
pub fn is_database(path: &Path) -> bool {
    let name = path.file_name().and_then(OsStr::to_str);
    let rest = name.and_then(|name| name.strip_prefix(FILE_NAME));
    matches!(rest, Some("" | "-wal" | "-shm")) && path.is_file()
}

/// The database in a results directory.
pub fn default_database(results: &Path) -> PathBuf {
    results.join(FILE_NAME)
}

/// Resolves the database: a path, a `file:` URL or an address of PostgreSQL; by default a file
/// in the results directory.
pub fn resolve(url: Option<&str>, results: &Path) -> Result<Location, Failure> {
    let Some(url) = url else { return Ok(default_database(results).into()) };
    match url.split_once("://") {
        _ if url.is_empty() => Err(Failure::input("the path of the history is empty")),
        Some(("file", path)) => Ok(PathBuf::from(path).into()),
        Some(("postgres" | "postgresql", _)) => Location::postgres(url).map_err(Failure::input),
        // The rest may contain a password.
        Some((scheme, _)) => {
            let error = format!("a history of the type `{scheme}://` is not supported");
            Err(Failure::input(error)
                .hint("give the path of a SQLite database, or `postgres://USER@HOST/DATABASE`"))
        }
        None => Ok(PathBuf::from(url.strip_prefix("file:").unwrap_or(url)).into()),
    }
}

/// Replaces the password in an argument that is, or ends with, an address. A user name alone may
/// be a key of a web service, and is replaced, too.
pub fn without_password(argument: &str) -> String {
    let masked = || {
        let (scheme, rest) = argument.split_once("://")?;
        let (user, host) = rest.rsplit_once('@')?;
        let is_web = scheme.ends_with("http") || scheme.ends_with("https");
        let secret = match user.split_once(':') {
            Some((user, _)) => format!("{user}:***"),
            None if is_web => "***".to_owned(),
            None => return None,
        };
        Some(format!("{scheme}://{secret}@{host}"))
    };
    masked().unwrap_or_else(|| argument.to_owned())
}

/// Imports a run that has ended, and earlier ones that are not in the history. Prints one
/// warning if that fails.
pub fn import_run(target: &HistoryTarget, record: &Record) {
    let dir = record.run.as_ref().map(|run| target.results.join(&run.run));
    // Without its journal, the run cannot be shown, and an error was printed.
    if !dir.is_some_and(|dir| dir.join(JOURNAL).is_file()) {
        return;
    }
    let imported = Store::open(&target.database).and_then(|mut store| {
        store.keep_log()?;
        store.import(record)?;
        catch_up(&mut store, &target.results)
    });
    if let Err(error) = imported {
        terminal::notice(format!("warning: {}", warning("run", &error)));
    }
}

fn warning(what: &str, error: &StoreError) -> String {
    let mut text = format!("the {what} was not imported into the history: {error}");
    if let Some(cause) = std::error::Error::source(error) {
        text += &format!(": {cause}");
    }
    match error.hint() {
        Some(hint) => format!("{text} ({hint})"),
        None => format!("{text} (the next {what} imports it)"),
    }
}

/// Imports earlier runs whose runner and guard were killed, or that could not be imported.
/// `rtf history import` reports the journals that cannot be imported.
fn catch_up(store: &mut Store, results: &Path) -> Result<(), StoreError> {
    let started = Instant::now();
    let known = store.run_names()?.into_iter().collect();
    for journal in journals::missing(results, &known) {
        if started.elapsed() > CATCH_UP_LIMIT {
            break;
        }
        let imported = journals::import(&journal, |record| store.import(record));
        if let JournalImport::Store(error @ (StoreError::Locked { .. } | StoreError::Io { .. })) =
            imported
        {
            return Err(error);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passwords_of_addresses_are_masked() {
        let mask = |argument, expected: &str| assert_eq!(without_password(argument), expected);
        mask("postgres://me:p@s:s@db/x", "postgres://me:***@db/x");
        mask("--history=postgres://me:pass@db/x", "--history=postgres://me:***@db/x");
        mask("postgres://me@db/x", "postgres://me@db/x");
        mask("otlp=https://key@host:4318", "otlp=https://***@host:4318");
        mask("https://example.org/a:b", "https://example.org/a:b");
        mask("arm.xml", "arm.xml");
    }
}
