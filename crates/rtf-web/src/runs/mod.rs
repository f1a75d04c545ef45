//! The runs of a results directory: finds runs by name, and keeps the
//! indexes of recently used ones.

mod filter;
mod list;

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rtf_report::journal;
use rtf_report::run_dir::{JOURNAL, LATEST};

pub use filter::RunFilter;

use crate::index::Index;
use crate::problem::Problem;
use crate::regular_file;

/// How many indexes are kept; one of 10 000 tests has about 10 MB.
const KEPT: usize = 4;

/// The current run is searched among this number of newest runs.
const CURRENT_AMONG: usize = 20;

/// A run with its index.
#[derive(Debug)]
pub struct Run {
    pub name: String,
    results: PathBuf,
    index: Mutex<Index>,
}

impl Run {
    fn open(results: &Path, name: &str) -> Result<Self, Problem> {
        let journal = regular_file::open(results, &journal_of(name)).map_err(unreadable)?;
        let index = Mutex::new(Index::new(journal));
        Ok(Self { name: name.to_owned(), results: results.to_owned(), index })
    }

    #[must_use]
    pub fn dir(&self) -> PathBuf {
        self.results.join(&self.name)
    }

    /// Whether a worker of a campaign made it: its tests run again with the command of an episode.
    #[must_use]
    pub fn is_of_worker(&self) -> bool {
        is_of_worker(&self.name)
    }

    /// Its index, read as far as the journal is written. Takes as long as that
    /// takes: not to be called from the threads that serve.
    ///
    /// # Errors
    /// The journal cannot be read.
    pub fn read(&self) -> Result<MutexGuard<'_, Index>, Problem> {
        let mut index = self.index.lock().unwrap_or_else(PoisonError::into_inner);
        let advanced = index.advance();
        advanced.map_err(unreadable)?;
        Ok(index)
    }

    /// A new handle of the journal.
    ///
    /// # Errors
    /// It cannot be opened.
    pub fn journal(&self) -> Result<File, Problem> {
        self.open_file(Path::new(JOURNAL)).map_err(unreadable)
    }

    /// Opens a regular file in the run's directory; no part of the path may be a link.
    ///
    /// # Errors
    /// There is no such file.
    pub fn open_file(&self, path: &Path) -> io::Result<File> {
        regular_file::open(&self.results, &Path::new(&self.name).join(path))
    }
}

/// The runs of a results directory.
#[derive(Debug)]
pub struct Runs {
    results: PathBuf,
    /// The run of this process.
    own: Option<String>,
    /// The one used last is the last.
    open: Mutex<Vec<Arc<Run>>>,
    listed: list::SummaryCache,
}

impl Runs {
    /// The runs in `results`; `own` is the name of the one that this process makes.
    #[must_use]
    pub fn new(results: &Path, own: Option<String>) -> Self {
        let results = results.to_owned();
        Self { results, own, open: Mutex::default(), listed: list::SummaryCache::default() }
    }

    /// The name of the current run, if there is one.
    #[must_use]
    pub fn current(&self) -> Option<String> {
        if let Some(own) = &self.own {
            return Some(own.clone());
        }
        let newest = self.names().into_iter().take(CURRENT_AMONG);
        newest.into_iter().find(|name| {
            let journal = regular_file::open(&self.results, &journal_of(name));
            journal.is_ok_and(|journal| journal::is_written(&journal))
        })
    }

    /// Whether this is the run that this process makes.
    #[must_use]
    pub fn is_own(&self, run: &Run) -> bool {
        self.own.as_ref() == Some(&run.name)
    }

    /// Finds a run by its name, `latest` or `current`.
    ///
    /// # Errors
    /// There is none.
    pub fn find(&self, asked: &str) -> Result<Arc<Run>, Problem> {
        let name = match asked {
            "current" => self.current().ok_or_else(|| Problem::not_found("no run goes on"))?,
            LATEST => self.latest().ok_or_else(|| Problem::not_found("there are no runs"))?,
            name => name.to_owned(),
        };
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(place) = open.iter().position(|run| run.name == name) {
            let run = open.remove(place);
            open.push(run.clone());
            return Ok(run);
        }
        if !self.is_run(&name) {
            return Err(Problem::not_found(format!("there is no run `{asked}`")));
        }
        let run = Arc::new(Run::open(&self.results, &name)?);
        open.push(run.clone());
        // The run that this process makes is needed until its end.
        while open.len() > KEPT {
            let oldest = open.iter().position(|run| !self.is_own(run)).unwrap_or(0);
            open.remove(oldest);
        }
        Ok(run)
    }

    /// Reads the journal of the newest run, unless this process makes one.
    pub fn read_ahead(&self) {
        if self.own.is_none()
            && let Ok(run) = self.find(LATEST)
        {
            // An error is reported to the client that requests the run.
            drop(run.read());
        }
    }

    /// The newest run: where the link leads, or the last name.
    fn latest(&self) -> Option<String> {
        let linked = fs::read_link(self.results.join(LATEST)).ok();
        let linked = linked.and_then(|path| path.to_str().map(str::to_owned));
        linked.filter(|name| self.is_run(name)).or_else(|| self.names().into_iter().next())
    }

    /// Whether there is a run of this name, also of the worker of a campaign.
    fn is_run(&self, name: &str) -> bool {
        let is_named = (name != LATEST && is_plain(name)) || is_of_worker(name);
        is_named && regular_file::is_file(&self.results, &journal_of(name))
    }

    /// The names of all runs, the newest first.
    fn names(&self) -> Vec<String> {
        let Ok(entries) = fs::read_dir(&self.results) else { return Vec::new() };
        let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
        let mut names: Vec<_> = names.filter(|name| self.is_run(name)).collect();
        names.sort_unstable_by(|a, b| b.cmp(a));
        names
    }
}

/// A run's journal, relative to the results directory.
fn journal_of(name: &str) -> PathBuf {
    Path::new(name).join(JOURNAL)
}

/// A journal that cannot be read.
pub fn unreadable(error: io::Error) -> Problem {
    Problem::unreadable(Path::new(JOURNAL), &error)
}

/// Whether this is the name of a run of a worker: `campaigns/NAME/workers/N/RUN`.
fn is_of_worker(name: &str) -> bool {
    let parts: Vec<_> = name.split('/').collect();
    let [campaigns, campaign, workers, worker, run] = parts[..] else { return false };
    campaigns == "campaigns"
        && workers == "workers"
        && is_plain(campaign)
        && worker.parse::<u32>().is_ok()
        && is_plain(run)
}

/// Whether this is a valid name of a run's directory in the results directory.
fn is_plain(name: &str) -> bool {
    !name.is_empty() && !name.starts_with('.') && !name.contains(['/', '\\', '\0'])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_workers_are_found_but_not_listed() {
        let results = tempfile::tempdir().unwrap();
        let of_worker = "campaigns/grasp/workers/2/1";
        for name in ["1", of_worker, "campaigns/grasp/2", "other/grasp/workers/2/1"] {
            fs::create_dir_all(results.path().join(name)).unwrap();
            fs::write(results.path().join(name).join(JOURNAL), "").unwrap();
        }
        let runs = Runs::new(results.path(), None);
        assert_eq!(runs.find(of_worker).unwrap().name, of_worker);
        assert_eq!(runs.names(), ["1"]);
        for other in [
            "campaigns/grasp/2",
            "other/grasp/workers/2/1",
            "campaigns/../grasp/workers/2/1",
            "campaigns/grasp/workers/2/../2/1",
            "campaigns/grasp/workers/x/1",
            "/campaigns/grasp/workers/2/1",
        ] {
            assert!(runs.find(other).is_err(), "{other}");
        }
    }

    #[test]
    fn the_newest_run_is_read_ahead() {
        let results = tempfile::tempdir().unwrap();
        for name in ["1", "2"] {
            fs::create_dir(results.path().join(name)).unwrap();
            let line = r#"{"seq":0,"us":0,"kind":"run-finished","exit_code":0}"#;
            fs::write(results.path().join(name).join(JOURNAL), format!("{line}\n")).unwrap();
        }
        for (own, expected) in [(None, vec!["2"]), (Some("2".to_owned()), vec![])] {
            let runs = Runs::new(results.path(), own);
            runs.read_ahead();
            let open = runs.open.lock().unwrap();
            let read = open.iter().filter(|run| run.index.lock().unwrap().offset > 0);
            assert_eq!(read.map(|run| run.name.as_str()).collect::<Vec<_>>(), expected);
        }
    }
}
