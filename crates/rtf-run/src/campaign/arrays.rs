//! The job arrays of a campaign, from which they are followed after the submitting process was
//! killed:
//!
//! ```text
//! arrays/K/array.json             the Kth job
//! arrays/K/parts/I/A/exit-code    the exit code of attempt A of task I
//! arrays/K/ended                  no task is left, and the results have been read
//! ```

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use uuid::Uuid;

use super::directory::{CampaignDir, unwritable, write};
use crate::error::Failure;

const ARRAYS: &str = "arrays";
const ARRAY: &str = "array.json";
const ENDED: &str = "ended";

/// A job array of a campaign.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CampaignArray {
    /// Its directory.
    pub dir: PathBuf,
    /// The content of its file.
    pub stored: StoredArray,
}

/// What a process needs to submit or find the job.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StoredArray {
    /// The name of the job.
    pub name: String,
    /// The worker that is task 1.
    pub first_worker: u32,
    /// The number of tasks.
    pub tasks: u32,
}

impl CampaignArray {
    /// Creates the next array, whose tasks are workers that have been created.
    pub fn create(campaign: &CampaignDir, first_worker: u32, tasks: u32) -> Result<Self, Failure> {
        let number = numbers(campaign).last().map_or(1, |last| last + 1);
        let name = format!("rtf-{}", Uuid::now_v7().simple());
        let stored = StoredArray { name, first_worker, tasks };
        let dir = campaign.path.join(ARRAYS).join(number.to_string());
        let dir = std::path::absolute(dir).map_err(Failure::internal)?;
        fs::create_dir_all(&dir).map_err(|error| unwritable(&dir, &error))?;
        let json = serde_json::to_string_pretty(&stored).map_err(Failure::internal)?;
        // Complete or absent: an incomplete one could not be resumed.
        let temporary = dir.join("array.new");
        write(&temporary, &(json + "\n"))?;
        let file = dir.join(ARRAY);
        fs::rename(temporary, &file).map_err(|error| unwritable(&file, &error))?;
        Ok(Self { dir, stored })
    }

    /// Reads an array.
    pub fn open(dir: &Path) -> Result<Self, Failure> {
        let file = dir.join(ARRAY);
        let text = fs::read_to_string(&file).map_err(|error| {
            Failure::input(format!("cannot read `{}`: {error}", file.display()))
        })?;
        let stored = serde_json::from_str(&text)
            .map_err(|error| Failure::input(format!("{}: {error}", file.display())))?;
        let dir = std::path::absolute(dir).map_err(Failure::internal)?;
        Ok(Self { dir, stored })
    }

    /// The newest array of a campaign, if it has not ended.
    pub fn find_active(campaign: &CampaignDir) -> Result<Option<Self>, Failure> {
        let Some(last) = numbers(campaign).pop() else { return Ok(None) };
        let dir = campaign.path.join(ARRAYS).join(last.to_string());
        // Without its file, nothing was submitted.
        match dir.join(ARRAY).exists() && !dir.join(ENDED).exists() {
            true => Self::open(&dir).map(Some),
            false => Ok(None),
        }
    }

    /// The directory of the campaign.
    pub fn campaign(&self) -> Result<CampaignDir, Failure> {
        let dir = self.dir.parent().and_then(Path::parent);
        CampaignDir::open(dir.unwrap_or(Path::new("")))
    }

    pub fn worker(&self, task: u32) -> u32 {
        self.stored.first_worker + task - 1
    }

    pub fn tasks(&self) -> impl Iterator<Item = u32> + use<> {
        1..=self.stored.tasks
    }

    /// Stores that the results of all tasks have been read.
    pub fn end(&self) -> Result<(), Failure> {
        write(&self.dir.join(ENDED), "")
    }
}

/// The numbers of the arrays, ascending.
fn numbers(campaign: &CampaignDir) -> Vec<u32> {
    let entries = fs::read_dir(campaign.path.join(ARRAYS)).into_iter().flatten().flatten();
    let number = |entry: fs::DirEntry| entry.file_name().to_str()?.parse().ok();
    let mut numbers: Vec<u32> = entries.filter_map(number).collect();
    numbers.sort_unstable();
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::directory::tests::campaign_dir;

    #[test]
    fn the_newest_array_is_followed_until_its_results_have_been_read() {
        let (_guard, campaign) = campaign_dir();
        assert_eq!(CampaignArray::find_active(&campaign).expect("none"), None);
        let first = CampaignArray::create(&campaign, 1, 3).expect("an array");
        assert_eq!(CampaignArray::find_active(&campaign).expect("one"), Some(first.clone()));
        first.end().expect("an end");
        assert_eq!(CampaignArray::find_active(&campaign).expect("none"), None);
        let second = CampaignArray::create(&campaign, 4, 2).expect("an array");
        assert_eq!(CampaignArray::find_active(&campaign).expect("one"), Some(second.clone()));
        assert!(second.dir.ends_with("arrays/2") && second.stored.name != first.stored.name);
        let workers: Vec<_> = second.tasks().map(|task| second.worker(task)).collect();
        assert_eq!(workers, [4, 5]);
        assert_eq!(second.campaign().expect("its campaign").path, campaign.path);
        // The process was killed before it stored what to submit.
        fs::create_dir(campaign.path.join("arrays/3")).expect("a directory");
        assert_eq!(CampaignArray::find_active(&campaign).expect("none"), None);
    }
}
