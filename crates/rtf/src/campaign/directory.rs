//! The directory of a campaign's results, from which it can be resumed:
//!
//! ```text
//! campaign.json          what is run
//! episodes.jsonl         the list of episodes
//! workers/N/list.jsonl   the episodes of the Nth worker
//! workers/N/output.txt   what it printed
//! workers/N/RUN/         its run, with a journal and the results of the episodes
//! results.jsonl          the results, when the campaign has ended
//! ```

use std::fs::{self, File, TryLockError};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use rtf_campaign::EpisodeList;
use rtf_model::Episode;
use rtf_report::episode_results::{EPISODE_RESULTS, EpisodeLine};
use rtf_report::journal;
use rtf_report::run_dir::{self, JOURNAL};
use serde::{Deserialize, Serialize};

use super::read_list;
use crate::error::Failure;

const DESCRIPTION: &str = "campaign.json";
const EPISODES: &str = "episodes.jsonl";
const WORKERS: &str = "workers";
const LIST: &str = "list.jsonl";

/// What a campaign runs. Paths are absolute.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Description {
    /// The name.
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
}

/// The directory of a campaign.
#[derive(Clone, Debug)]
pub struct CampaignDir {
    pub path: PathBuf,
    pub description: Description,
}

impl CampaignDir {
    /// Creates the directory of a new campaign in the results directory.
    pub fn create(
        results: &Path,
        description: Description,
        episodes: &EpisodeList,
    ) -> Result<Self, Failure> {
        let dir = run_dir::create(&results.join("campaigns")).map_err(|error| {
            Failure::input(error).hint("choose another directory with `--results DIR`")
        })?;
        let json = serde_json::to_string_pretty(&description).map_err(Failure::internal)?;
        write(&dir.path.join(DESCRIPTION), &(json + "\n"))?;
        write(&dir.path.join(EPISODES), &episodes.to_json_lines())?;
        Ok(Self { path: dir.path, description })
    }

    /// Opens the directory of an earlier campaign.
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
        match file.try_lock() {
            Ok(()) => Ok(file),
            Err(TryLockError::WouldBlock) => {
                let error = format!("the campaign in `{}` is still running", self.path.display());
                Err(Failure::input(error).hint("wait until it has ended"))
            }
            Err(TryLockError::Error(error)) => Err(unwritable(&path, &error)),
        }
    }

    /// Whether a worker still runs, whose campaign was killed.
    pub fn any_worker_runs(&self) -> bool {
        let is_written = |run: &PathBuf| {
            File::open(run.join(JOURNAL)).is_ok_and(|journal| journal::is_written(&journal))
        };
        self.workers().iter().any(|worker| self.runs(*worker).iter().any(is_written))
    }

    /// The directories of the runs of a worker.
    fn runs(&self, worker: u32) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.worker(worker)).into_iter().flatten().flatten();
        let is_dir = |entry: &fs::DirEntry| entry.file_type().is_ok_and(|kind| kind.is_dir());
        let mut runs: Vec<_> = entries.filter(is_dir).map(|entry| entry.path()).collect();
        runs.sort();
        runs
    }

    /// The list of episodes.
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

    /// The directory of a worker.
    pub fn worker(&self, number: u32) -> PathBuf {
        self.path.join(WORKERS).join(number.to_string())
    }

    /// Creates the directory of a worker with its list of episodes, and returns the list's file.
    pub fn create_worker(&self, number: u32, episodes: &[Episode]) -> Result<PathBuf, Failure> {
        let dir = self.worker(number);
        fs::create_dir_all(&dir).map_err(|error| unwritable(&dir, &error))?;
        let list = dir.join(LIST);
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
        write(&self.path.join("results.jsonl"), &text)
    }

    /// The lines of all workers so far, the first worker first.
    pub fn recorded(&self) -> Vec<EpisodeLine> {
        let mut lines = Vec::new();
        for worker in self.workers() {
            let files = self.runs(worker).into_iter().map(|run| run.join(EPISODE_RESULTS));
            for text in files.filter_map(|file| fs::read_to_string(file).ok()) {
                lines.extend(text.lines().filter_map(|line| serde_json::from_str(line).ok()));
            }
        }
        lines
    }
}

fn write(path: &Path, text: &str) -> Result<(), Failure> {
    let written = File::create(path).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.sync_all()
    });
    written.map_err(|error| unwritable(path, &error))
}

fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::internal(format!("cannot write `{}`: {error}", path.display()))
}
