//! The list of all runs. What is known of a run that is over is kept, so that
//! its journal is read once.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::{Run, RunFilter, Runs};
use crate::api::RunInfo;
use crate::problem::Problem;

/// How long an answer may wait for journals that were never read.
const BUDGET: Duration = Duration::from_millis(500);

/// A page of the list.
#[derive(Debug, Default)]
pub struct Listing {
    /// The runs, the newest first.
    pub runs: Vec<RunInfo>,
    /// The name with which it goes on.
    pub next: Option<String>,
    /// How many runs were left out because nobody knows yet whether they match.
    pub unread: usize,
}

/// What is known of runs that are over.
#[derive(Debug, Default)]
pub struct Listed {
    known: Mutex<HashMap<String, RunInfo>>,
    reading: AtomicBool,
}

impl Listed {
    fn get(&self, name: &str) -> Option<RunInfo> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner).get(name).cloned()
    }

    fn keep(&self, info: &RunInfo) {
        if info.state.is_over() {
            let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
            known.insert(info.run.clone(), info.clone());
        }
    }
}

impl Runs {
    /// A page of the list, the newest first.
    #[must_use]
    pub fn list(
        self: &Arc<Self>,
        before: Option<&str>,
        limit: usize,
        filter: &RunFilter,
    ) -> Listing {
        let mut names = self.names();
        names.retain(|name| before.is_none_or(|before| name.as_str() < before));
        let until = Instant::now() + BUDGET;
        let (mut listing, mut unread) = (Listing::default(), Vec::new());
        for name in names {
            if listing.runs.len() >= limit {
                listing.next = listing.runs.last().map(|run| run.run.clone());
                break;
            }
            match self.listed.get(&name) {
                Some(info) => listing.runs.extend(Some(info).filter(|run| filter.matches(run))),
                None if Instant::now() < until => {
                    let info = self.info(&name);
                    let info = info.unwrap_or_else(|problem| RunInfo::unreadable(&name, &problem));
                    listing.runs.extend(Some(info).filter(|run| filter.matches(run)));
                }
                None => {
                    if filter.is_empty() {
                        listing.runs.push(RunInfo::unread(&name));
                    } else {
                        listing.unread += 1;
                    }
                    unread.push(name);
                }
            }
        }
        self.read_on(unread);
        listing
    }

    fn info(&self, name: &str) -> Result<RunInfo, Problem> {
        let info = match self.opened(name) {
            Some(run) => RunInfo::of(&run.name, &*run.read()?),
            None => {
                let run = Arc::new(Run::open(&self.results, name)?);
                let info = RunInfo::of(name, &*run.read()?);
                self.keep(run);
                info
            }
        };
        self.listed.keep(&info);
        Ok(info)
    }

    /// Keeps what was read, where there is a place for it: the newest run is
    /// looked at next, more often than not.
    fn keep(&self, run: Arc<Run>) {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        if open.len() < super::KEPT && open.iter().all(|other| other.name != run.name) {
            open.insert(0, run);
        }
    }

    fn opened(&self, name: &str) -> Option<Arc<Run>> {
        let open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        open.iter().find(|run| run.name == name).cloned()
    }

    /// Reads what there was no time for, for those who ask again.
    fn read_on(self: &Arc<Self>, unread: Vec<String>) {
        if unread.is_empty() || self.listed.reading.swap(true, Ordering::AcqRel) {
            return;
        }
        let runs = self.clone();
        let read = std::thread::Builder::new().name("web-list".into()).spawn(move || {
            for name in unread {
                // Whoever asks for this run gets to know why it cannot be read.
                drop(runs.info(&name));
            }
            runs.listed.reading.store(false, Ordering::Release);
        });
        if read.is_err() {
            self.listed.reading.store(false, Ordering::Release);
        }
    }
}
