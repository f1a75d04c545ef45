//! Resolves `latest`, a run's name, a directory, or a journal to a journal.

use std::fs;
use std::path::{Path, PathBuf};

use super::{JOURNAL, LATEST};

/// How many names a [`ResolveError`] lists.
const LISTED: usize = 5;

/// No such run.
#[derive(Debug, thiserror::Error)]
pub enum ResolveError {
    #[error("there is no run `{run}`")]
    Unknown {
        run: String,
        /// Where it was looked for.
        looked: Vec<PathBuf>,
        /// The newest runs that there are, the newest first.
        newest: Vec<String>,
    },
    #[error("there are no runs in `{}`", results.display())]
    Empty { results: PathBuf },
}

impl ResolveError {
    /// What could be asked for instead.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::Unknown { newest, .. } if newest.len() == 1 => {
                Some(format!("the only run is {}", newest[0]))
            }
            Self::Unknown { newest, .. } if !newest.is_empty() => {
                Some(format!("the newest runs are {}", newest.join(", ")))
            }
            Self::Unknown { looked, .. } => {
                let looked: Vec<_> = looked.iter().map(|path| path.display().to_string()).collect();
                Some(format!("looked for {}", looked.join(", ")))
            }
            Self::Empty { .. } => Some("run something first, or name a run's directory".to_owned()),
        }
    }
}

/// Finds the journal of a run: `latest`, the name of a run in `results`, the
/// path of a run's directory or of a journal, or a results directory, for its newest run.
///
/// # Errors
/// There is none; the error says where it was looked for and what there is.
pub fn resolve(results: &Path, run: &str) -> Result<PathBuf, ResolveError> {
    let mut looked = Vec::new();
    let mut candidates = vec![results.join(run), PathBuf::from(run)];
    if run == LATEST {
        candidates.insert(1, newest(results));
    } else if Path::new(run).is_dir() {
        candidates.extend([Path::new(run).join(LATEST), newest(Path::new(run))]);
    }
    for candidate in candidates {
        if candidate.is_file() {
            return Ok(candidate);
        }
        let journal = candidate.join(JOURNAL);
        if journal.is_file() {
            return Ok(journal);
        }
        if !looked.contains(&journal) {
            looked.push(journal);
        }
    }
    let newest: Vec<_> = names(results).into_iter().rev().take(LISTED).collect();
    if run == LATEST && newest.is_empty() {
        return Err(ResolveError::Empty { results: results.to_owned() });
    }
    Err(ResolveError::Unknown { run: run.to_owned(), looked, newest })
}

/// The newest run by its name: the link may lead to a run that was deleted, or be missing where
/// there are no links.
fn newest(results: &Path) -> PathBuf {
    results.join(names(results).into_iter().next_back().unwrap_or_default())
}

/// The runs in the results directory, the oldest first.
fn names(results: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(results) else { return Vec::new() };
    let runs = entries.filter_map(Result::ok).filter(|entry| entry.path().join(JOURNAL).is_file());
    let names = runs.filter_map(|entry| entry.file_name().into_string().ok());
    let mut names: Vec<_> = names.filter(|name| name != LATEST).collect();
    names.sort();
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run_dir::create;

    fn run(results: &Path, name: &str) -> PathBuf {
        let folder = results.join(name);
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join(JOURNAL), "").unwrap();
        folder.join(JOURNAL)
    }

    #[test]
    fn a_run_is_found_by_name_folder_and_journal() {
        let results = tempfile::tempdir().unwrap();
        let journal = run(results.path(), "2026-01-01T00-00-00Z-0001");
        let elsewhere = Path::new("elsewhere");
        let found = |results: &Path, run: &Path| resolve(results, run.to_str().unwrap()).unwrap();
        assert_eq!(found(results.path(), Path::new("2026-01-01T00-00-00Z-0001")), journal);
        assert_eq!(found(elsewhere, journal.parent().unwrap()), journal);
        assert_eq!(found(elsewhere, &journal), journal);
    }

    #[test]
    fn a_results_directory_stands_for_its_newest_run() {
        let results = tempfile::tempdir().unwrap();
        let dir = results.path().to_str().unwrap();
        let elsewhere = Path::new("elsewhere");
        assert!(resolve(elsewhere, dir).is_err());
        run(results.path(), "2026-01-01T00-00-00Z-0001");
        let newest = run(results.path(), "2026-01-02T00-00-00Z-0001");
        assert_eq!(resolve(elsewhere, dir).unwrap(), newest);
    }

    #[test]
    fn latest_is_the_link_and_without_it_the_last_name() {
        let results = tempfile::tempdir().unwrap();
        let created = create(results.path()).unwrap();
        fs::write(created.journal(), "").unwrap();
        let other = run(results.path(), "9999-01-01T00-00-00Z-0001");
        let latest = resolve(results.path(), LATEST).unwrap();
        assert_eq!(latest, results.path().join(LATEST).join(JOURNAL));
        assert_eq!(fs::canonicalize(latest).unwrap(), fs::canonicalize(created.journal()).unwrap());
        fs::remove_file(results.path().join(LATEST)).unwrap();
        assert_eq!(resolve(results.path(), LATEST).unwrap(), other);
    }

    #[test]
    fn an_unknown_run_is_answered_with_those_that_there_are() {
        let results = tempfile::tempdir().unwrap();
        let empty = resolve(results.path(), LATEST).unwrap_err();
        assert!(matches!(empty, ResolveError::Empty { .. }), "{empty}");
        run(results.path(), "a");
        run(results.path(), "b");
        let Err(ResolveError::Unknown { looked, newest, .. }) = resolve(results.path(), "c") else {
            panic!("there is no run `c`")
        };
        assert_eq!(looked, [results.path().join("c").join(JOURNAL), Path::new("c").join(JOURNAL)]);
        assert_eq!(newest, ["b", "a"]);
        let error = resolve(results.path(), "c").unwrap_err();
        assert_eq!(error.hint().as_deref(), Some("the newest runs are b, a"));
    }
}
