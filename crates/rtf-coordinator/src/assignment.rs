//! The episodes of a worker, and its results as they arrive.

use std::collections::{BTreeSet, HashMap};
use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};

use rtf_model::EpisodeOutcome;
use rtf_report::episode_results::{EPISODE_RESULTS, EpisodeLine};
use rtf_run::campaign::directory::{self, CampaignDir};

/// The episodes of a worker.
#[derive(Debug)]
pub struct Assignment {
    /// The number of the worker.
    pub worker: u32,
    /// Its episodes without a result.
    pub left: BTreeSet<u64>,
    /// The episodes that have started and not finished.
    pub running: BTreeSet<u64>,
    /// Whether an episode has finished.
    pub has_results: bool,
    /// Whether one of them did not pass.
    pub any_problem: bool,
    results: ResultFollower,
}

impl Assignment {
    /// No result has been read.
    pub fn new(dir: &CampaignDir, worker: u32, episodes: impl IntoIterator<Item = u64>) -> Self {
        Self {
            worker,
            left: episodes.into_iter().collect(),
            running: BTreeSet::new(),
            has_results: false,
            any_problem: false,
            results: ResultFollower::of_worker(dir, worker),
        }
    }

    /// The results that have arrived since the last call: one for each episode of this worker.
    pub fn new_results(&mut self) -> Vec<EpisodeLine> {
        let mut results = Vec::new();
        for line in self.results.read() {
            if line.outcome.is_none() {
                self.running.insert(line.episode);
                continue;
            }
            self.running.remove(&line.episode);
            if self.left.remove(&line.episode) {
                self.has_results = true;
                self.any_problem |= line.outcome != Some(EpisodeOutcome::Passed);
                results.push(line);
            }
        }
        // An earlier run of the worker may have finished it late.
        self.running.retain(|episode| self.left.contains(episode));
        results
    }
}

/// Reads the growing results of a worker.
#[derive(Debug)]
pub struct ResultFollower {
    worker: PathBuf,
    /// How many bytes have been read of each file. An executor may run a worker several times:
    /// each run has a file.
    offsets: HashMap<PathBuf, u64>,
}

impl ResultFollower {
    /// Follows the results of a worker.
    pub fn of_worker(dir: &CampaignDir, number: u32) -> Self {
        Self { worker: dir.worker(number), offsets: HashMap::new() }
    }

    /// The complete lines that were added since the last call.
    pub fn read(&mut self) -> Vec<EpisodeLine> {
        let mut lines = Vec::new();
        for run in directory::runs(&self.worker) {
            let file = run.join(EPISODE_RESULTS);
            // After an error, the next call continues where this one has stopped.
            let _ = read_new(&file, self.offsets.entry(file.clone()).or_default(), &mut lines);
        }
        lines
    }
}

/// Reads the complete lines after `offset`.
fn read_new(path: &Path, offset: &mut u64, lines: &mut Vec<EpisodeLine>) -> io::Result<()> {
    let mut file = File::open(path)?;
    file.seek(SeekFrom::Start(*offset))?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)?;
    if let Some(end) = bytes.iter().rposition(|byte| *byte == b'\n') {
        *offset += end as u64 + 1;
        let new = bytes[..end].split(|byte| *byte == b'\n');
        lines.extend(new.filter_map(|line| serde_json::from_slice(line).ok()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use rtf_run::campaign::directory::Description;

    use super::*;

    fn campaign_dir() -> (tempfile::TempDir, CampaignDir) {
        let parent = tempfile::tempdir().expect("a directory");
        let description = Description { name: "grasp".to_owned(), ..Description::default() };
        let dir = CampaignDir::create(parent.path(), description, None).expect("a campaign");
        (parent, dir)
    }

    const STARTS: &str = "{\"episode\":1}\n";

    fn result(episode: u64, outcome: &str) -> String {
        format!("{{\"episode\":{episode},\"outcome\":\"{outcome}\"}}\n")
    }

    fn write(dir: &CampaignDir, run: &str, text: &str) {
        let run = dir.worker(1).join(run);
        fs::create_dir_all(&run).expect("a directory");
        fs::write(run.join(EPISODE_RESULTS), text).expect("a file");
    }

    fn episodes(assignment: &mut Assignment) -> Vec<u64> {
        assignment.new_results().iter().map(|line| line.episode).collect()
    }

    #[test]
    fn lines_are_read_once_they_are_complete() {
        let (_guard, dir) = campaign_dir();
        let mut assignment = Assignment::new(&dir, 1, [1, 2]);
        assert!(episodes(&mut assignment).is_empty() && assignment.running.is_empty());
        let text = format!("{STARTS}{}", result(1, "passed"));
        write(&dir, "1", &text[..text.len() - 3]);
        assert!(episodes(&mut assignment).is_empty());
        assert_eq!((&assignment.running, assignment.has_results), (&BTreeSet::from([1]), false));
        write(&dir, "1", &text);
        assert_eq!(episodes(&mut assignment), [1]);
        assert_eq!((assignment.running.len(), assignment.left.len()), (0, 1));
        assert!(episodes(&mut assignment).is_empty());
    }

    #[test]
    fn a_worker_that_ran_twice_has_one_result_for_each_episode() {
        let (_guard, dir) = campaign_dir();
        let mut assignment = Assignment::new(&dir, 1, [1, 2]);
        write(&dir, "1", STARTS);
        write(&dir, "2", &(STARTS.to_owned() + &result(1, "passed")));
        assert_eq!(episodes(&mut assignment), [1]);
        // The first run still writes.
        write(&dir, "1", &(STARTS.to_owned() + &result(1, "failed") + &result(3, "failed")));
        assert!(episodes(&mut assignment).is_empty());
        assert_eq!(assignment.left, BTreeSet::from([2]));
        assert_eq!(dir.recorded_by(1).len(), 2, "1 and 3");
    }
}
