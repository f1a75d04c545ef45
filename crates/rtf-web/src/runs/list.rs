//! The list of all runs. The summary of a run that has ended is cached, so that
//! its journal is read once.

use std::collections::{HashMap, HashSet};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant, SystemTime};

use super::{Run, RunFilter, Runs};
use crate::problem::Problem;
use crate::views::{RunInfo, RunList};

/// How long a response may be delayed by reading journals for the first time.
const BUDGET: Duration = Duration::from_millis(500);

/// The cached summaries of runs that have ended.
#[derive(Debug, Default)]
pub struct SummaryCache {
    known: Mutex<HashMap<String, (JournalStamp, RunInfo)>>,
    reading: AtomicBool,
}

/// Size and modification time: a journal with another stamp has to be read again.
type JournalStamp = Option<(u64, SystemTime)>;

impl SummaryCache {
    fn get(&self, name: &str, stamp: JournalStamp) -> Option<RunInfo> {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.get(name).filter(|(known, _)| *known == stamp).map(|(_, info)| info.clone())
    }

    fn keep(&self, stamp: JournalStamp, info: &RunInfo) {
        if info.state.is_over() {
            let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
            known.insert(info.run.clone(), (stamp, info.clone()));
        }
    }

    /// Forgets runs that were removed.
    fn retain(&self, names: &[String]) {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if known.len() > names.len() {
            let names: HashSet<_> = names.iter().map(String::as_str).collect();
            known.retain(|name, _| names.contains(name.as_str()));
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
    ) -> RunList {
        let mut names = self.names();
        self.listed.retain(&names);
        names.retain(|name| before.is_none_or(|before| name.as_str() < before));
        let until = Instant::now() + BUDGET;
        let (mut listing, mut unread) = (RunList::default(), Vec::new());
        for name in names {
            if listing.runs.len() >= limit {
                listing.next = listing.runs.last().map(|run| run.run.clone());
                break;
            }
            let info = match self.listed.get(&name, self.stamp(&name)) {
                Some(info) => info,
                None if Instant::now() < until => {
                    let info = self.info(&name);
                    info.unwrap_or_else(|problem| RunInfo::unreadable(&name, &problem))
                }
                None => {
                    if filter.is_empty() {
                        listing.runs.push(RunInfo::unread(&name));
                    } else {
                        listing.unread += 1;
                    }
                    unread.push(name);
                    continue;
                }
            };
            listing.runs.extend(Some(info).filter(|run| filter.matches(run)));
        }
        self.read_in_background(unread);
        listing
    }

    fn stamp(&self, name: &str) -> JournalStamp {
        let journal = self.results.join(super::journal_of(name)).metadata().ok()?;
        Some((journal.len(), journal.modified().ok()?))
    }

    fn info(&self, name: &str) -> Result<RunInfo, Problem> {
        let stamp = self.stamp(name);
        let info = match self.opened(name) {
            Some(run) => RunInfo::of(&run.name, &*run.read()?),
            None => {
                let run = Arc::new(Run::open(&self.results, name)?);
                let info = RunInfo::of(name, &*run.read()?);
                self.keep(run);
                info
            }
        };
        self.listed.keep(stamp, &info);
        Ok(info)
    }

    /// Keeps the index if there is room for it: a user usually opens the newest run next.
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

    /// Reads the remaining journals in the background, for later requests.
    fn read_in_background(self: &Arc<Self>, unread: Vec<String>) {
        if unread.is_empty() || self.listed.reading.swap(true, Ordering::AcqRel) {
            return;
        }
        let runs = self.clone();
        let read = std::thread::Builder::new().name("web-list".into()).spawn(move || {
            for name in unread {
                // A request for this run reports why it cannot be read.
                drop(runs.info(&name));
            }
            runs.listed.reading.store(false, Ordering::Release);
        });
        if read.is_err() {
            self.listed.reading.store(false, Ordering::Release);
        }
    }
}
