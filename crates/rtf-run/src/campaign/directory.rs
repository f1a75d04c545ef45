//! The directory of a campaign's results, from which it can be resumed:
//!
//! ```text
//! campaign.json          what is run
//! episodes.jsonl         the list of episodes
//! workers/N/list.jsonl   the episodes of the Nth worker
//! workers/N/output.txt   what it printed
//! workers/N/RUN/         its run, with a journal and the results of the episodes
//! arrays/K/              the Kth job array of an executor
//! results.jsonl          the results, when the campaign has ended
//! judgement.json         how it ended
//! ```

use std::collections::BTreeSet;
use std::fs::{self, File, TryLockError};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use rtf_campaign::EpisodeList;
use rtf_cluster::Cluster;
use rtf_model::Episode;
use rtf_report::episode_results::{EPISODE_RESULTS, EpisodeLine};
use rtf_report::journal;
use rtf_report::run_dir::{self, JOURNAL};
use serde::{Deserialize, Serialize};

use super::judged::{JUDGEMENT, Judged};
use super::read_list;
use super::start::CampaignStart;
use crate::error::Failure;

pub const DESCRIPTION: &str = "campaign.json";
const EPISODES: &str = "episodes.jsonl";
const RESULTS: &str = "results.jsonl";
const WORKERS: &str = "workers";
const LIST: &str = "list.jsonl";
/// How long a lock is waited for: a process that was killed may have a child that does not execute
/// its program yet, and has the lock, too.
const LOCK_WAIT: Duration = Duration::from_millis(500);
const LOCK_POLL: Duration = Duration::from_millis(20);

/// What a campaign runs. Paths are absolute.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Description {
    pub name: String,
    /// The campaign file.
    pub file: PathBuf,
    /// The suite file.
    pub suite: PathBuf,
    /// The directory in which the campaign was started.
    pub working_dir: PathBuf,
    /// How often an episode is repeated whose result is the bench's.
    pub repeats: u32,
    /// Further options of `rtf run`: the profile and parameters.
    pub options: Vec<String>,
    /// Further variables of the workers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub variables: Vec<(String, String)>,
    /// Whether its episodes were asked for one after the other, by a search: then there is no claim.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_search: bool,
    /// The jobs that run the workers, unless they run on this machine.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub jobs: Option<CampaignJobs>,
    /// Which campaign it is, and where and when it was started.
    #[serde(flatten)]
    pub start: Option<CampaignStart>,
}

/// How a campaign runs in jobs of a cluster.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CampaignJobs {
    /// The largest number of tasks of a job.
    pub shards: u32,
    /// The resources that are requested for each task.
    #[serde(default)]
    pub resources: Vec<String>,
    /// Where they are submitted, and how.
    pub cluster: Cluster,
}

/// The directory of a campaign.
#[derive(Clone, Debug)]
pub struct CampaignDir {
    pub path: PathBuf,
    pub description: Description,
}

impl CampaignDir {
    /// Creates the directory of a new campaign in the directory `parent`. Without `episodes`, these
    /// are not known yet.
    pub fn create(
        parent: &Path,
        description: Description,
        episodes: Option<&EpisodeList>,
    ) -> Result<Self, Failure> {
        let dir = run_dir::create(parent).map_err(|error| {
            Failure::input(error).hint("choose another directory with `--results DIR`")
        })?;
        let json = serde_json::to_string_pretty(&description).map_err(Failure::internal)?;
        write(&dir.path.join(DESCRIPTION), &(json + "\n"))?;
        let list = episodes.map(EpisodeList::to_json_lines).unwrap_or_default();
        write(&dir.path.join(EPISODES), &list)?;
        Ok(Self { path: dir.path, description })
    }

    /// Opens the directory of an earlier campaign, whose claim can be judged.
    pub fn open_judged(path: &Path) -> Result<Self, Failure> {
        let dir = Self::open(path)?;
        if dir.description.is_search {
            let error =
                format!("`{}` is the directory of a search, without a claim", path.display());
            return Err(Failure::input(error).hint("`rtf run --episode N DIR` repeats an episode"));
        }
        Ok(dir)
    }

    /// Opens the directory of an earlier campaign or search.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let file = path.join(DESCRIPTION);
        let text = fs::read_to_string(&file).map_err(|error| {
            let error = format!("`{}` is not a campaign's directory: {error}", path.display());
            Failure::input(error).hint("`rtf campaign run` prints the directory of its results")
        })?;
        let description = serde_json::from_str(&text)
            .map_err(|error| Failure::input(format!("{}: {error}", file.display())))?;
        Ok(Self { path: path.to_owned(), description })
    }

    /// Locks the directory until the file is closed: a campaign is run by one process only.
    pub fn lock(&self) -> Result<File, Failure> {
        let path = self.path.join(DESCRIPTION);
        let file = File::open(&path).map_err(|error| unwritable(&path, &error))?;
        let end = Instant::now() + LOCK_WAIT;
        loop {
            match file.try_lock() {
                Ok(()) => return Ok(file),
                Err(TryLockError::WouldBlock) if Instant::now() < end => thread::sleep(LOCK_POLL),
                Err(TryLockError::WouldBlock) => {
                    let error =
                        format!("the campaign in `{}` is still running", self.path.display());
                    return Err(Failure::input(error).hint("wait until it has ended"));
                }
                Err(TryLockError::Error(error)) => return Err(unwritable(&path, &error)),
            }
        }
    }

    /// Whether a worker still runs, whose campaign was killed.
    pub fn any_worker_runs(&self) -> bool {
        let is_written = |run: &PathBuf| {
            File::open(run.join(JOURNAL)).is_ok_and(|journal| journal::is_written(&journal))
        };
        self.workers().iter().any(|worker| self.runs(*worker).iter().any(is_written))
    }

    /// The directories of the runs of a worker, the oldest first.
    fn runs(&self, worker: u32) -> Vec<PathBuf> {
        runs(&self.worker(worker))
    }

    pub fn episodes(&self) -> Result<EpisodeList, Failure> {
        read_list(&self.path.join(EPISODES))
    }

    /// The workers so far, by their numbers.
    pub fn workers(&self) -> Vec<u32> {
        let entries = fs::read_dir(self.path.join(WORKERS)).into_iter().flatten().flatten();
        let number = |entry: fs::DirEntry| entry.file_name().to_str()?.parse().ok();
        let mut workers: Vec<u32> = entries.filter_map(number).collect();
        workers.sort_unstable();
        workers
    }

    /// The number of the next worker.
    pub fn next_worker(&self) -> u32 {
        self.workers().last().map_or(1, |last| last + 1)
    }

    /// The directory of a worker.
    pub fn worker(&self, number: u32) -> PathBuf {
        self.path.join(WORKERS).join(number.to_string())
    }

    /// The file with the episodes of a worker.
    pub fn worker_list(&self, number: u32) -> PathBuf {
        self.worker(number).join(LIST)
    }

    /// Creates the directory of a worker with its list of episodes, and returns the list's file.
    pub fn create_worker(&self, number: u32, episodes: &[Episode]) -> Result<PathBuf, Failure> {
        let dir = self.worker(number);
        fs::create_dir_all(&dir).map_err(|error| unwritable(&dir, &error))?;
        let list = self.worker_list(number);
        write(&list, &EpisodeList { episodes: episodes.to_vec() }.to_json_lines())?;
        Ok(list)
    }

    /// Writes the final results.
    pub fn write_results(&self, lines: &[EpisodeLine]) -> Result<(), Failure> {
        let mut text = String::new();
        for line in lines {
            text += &serde_json::to_string(line).map_err(Failure::internal)?;
            text.push('\n');
        }
        write(&self.path.join(RESULTS), &text)
    }

    /// The list of episodes, to add further ones.
    pub fn append_to_episodes(&self) -> Result<File, Failure> {
        append(&self.path.join(EPISODES))
    }

    /// The final results, to add further ones.
    pub fn append_to_results(&self) -> Result<File, Failure> {
        append(&self.path.join(RESULTS))
    }

    /// The final results.
    pub fn results(&self) -> Result<Vec<EpisodeLine>, Failure> {
        let path = self.path.join(RESULTS);
        let text = fs::read_to_string(&path).map_err(|error| {
            Failure::input(format!("cannot read `{}`: {error}", path.display()))
        })?;
        Ok(text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect())
    }

    /// Writes how the campaign ended, or, when it continues, removes that.
    pub fn write_judgement(&self, judged: Option<&Judged>) -> Result<(), Failure> {
        let path = self.path.join(JUDGEMENT);
        let Some(judged) = judged else {
            return match fs::remove_file(&path) {
                Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                    Err(unwritable(&path, &error))
                }
                _ => Ok(()),
            };
        };
        let json = serde_json::to_string_pretty(judged).map_err(Failure::internal)?;
        write(&path, &(json + "\n"))
    }

    /// The results of all workers so far, the first worker first.
    pub fn recorded(&self) -> Vec<EpisodeLine> {
        self.recorded_in_runs().into_iter().map(|(_, line)| line).collect()
    }

    /// The results of all workers so far, each with the directory of its run.
    pub fn recorded_in_runs(&self) -> Vec<(PathBuf, EpisodeLine)> {
        self.workers().into_iter().flat_map(|worker| self.lines_of(worker)).collect()
    }

    /// The results of a worker so far, the first one of each episode.
    pub fn recorded_by(&self, worker: u32) -> Vec<EpisodeLine> {
        self.lines_of(worker).into_iter().map(|(_, line)| line).collect()
    }

    fn lines_of(&self, worker: u32) -> Vec<(PathBuf, EpisodeLine)> {
        let mut known = BTreeSet::new();
        let mut lines = Vec::new();
        for run in self.runs(worker) {
            let Ok(text) = fs::read_to_string(run.join(EPISODE_RESULTS)) else { continue };
            let parsed = text.lines().filter_map(|line| serde_json::from_str(line).ok());
            let is_new = |line: &EpisodeLine| line.outcome.is_some() && known.insert(line.episode);
            lines.extend(parsed.filter(is_new).map(|line| (run.clone(), line)));
        }
        lines
    }
}

/// The directories of the runs of a worker, whose directory is `worker`, the oldest first.
pub fn runs(worker: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(worker).into_iter().flatten().flatten();
    let is_dir = |entry: &fs::DirEntry| entry.file_type().is_ok_and(|kind| kind.is_dir());
    let mut runs: Vec<_> = entries.filter(is_dir).map(|entry| entry.path()).collect();
    runs.sort();
    runs
}

fn append(path: &Path) -> Result<File, Failure> {
    let file = File::options().create(true).append(true).open(path);
    file.map_err(|error| unwritable(path, &error))
}

/// Writes a file of a campaign to the disk.
pub fn write(path: &Path, text: &str) -> Result<(), Failure> {
    let written = File::create(path).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.sync_all()
    });
    written.map_err(|error| unwritable(path, &error))
}

/// A file of a campaign cannot be written.
pub fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::internal(format!("cannot write `{}`: {error}", path.display()))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A campaign without episodes, in a temporary directory.
    pub fn campaign_dir() -> (tempfile::TempDir, CampaignDir) {
        let parent = tempfile::tempdir().expect("a directory");
        let description = Description {
            name: "grasp".to_owned(),
            file: "campaign.xml".into(),
            suite: "grasp.xml".into(),
            working_dir: "/".into(),
            repeats: 2,
            variables: Vec::new(),
            options: Vec::new(),
            is_search: false,
            jobs: None,
            start: None,
        };
        let dir = CampaignDir::create(parent.path(), description, None).expect("a campaign");
        (parent, dir)
    }
}
