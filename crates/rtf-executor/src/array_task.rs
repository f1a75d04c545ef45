//! `rtf run` as a task of a submission.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::stop::CANCELLED;

/// A task of a submission: `3:0:/shared/submission`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ArrayTask {
    pub number: u32,
    /// How often it was run before.
    attempt: u32,
    /// The directory of the submission, or of the array of a campaign.
    pub dir: PathBuf,
}

impl FromStr for ArrayTask {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut parts = text.splitn(3, ':');
        let number = parts.next().and_then(|number| number.parse().ok());
        let attempt = parts.next().and_then(|number| number.parse().ok());
        match (number, attempt, parts.next()) {
            (Some(number), Some(attempt), Some(dir)) => {
                Ok(Self { number, attempt, dir: dir.into() })
            }
            _ => Err("expected `NUMBER:ATTEMPT:DIRECTORY`".to_owned()),
        }
    }
}

impl ArrayTask {
    /// Whether the user has cancelled the tasks.
    pub fn is_cancelled(&self) -> bool {
        self.dir.join(CANCELLED).exists()
    }

    /// The directory of this attempt.
    pub fn attempt_dir(&self) -> PathBuf {
        self.dir.join(format!("parts/{}/{}", self.number, self.attempt))
    }
}

/// The directory of the last attempt of a task.
pub fn last_attempt(dir: &Path, task: u32) -> Option<PathBuf> {
    let attempts = std::fs::read_dir(dir.join(format!("parts/{task}"))).ok()?;
    let number = |entry: std::fs::DirEntry| entry.file_name().to_str()?.parse::<u32>().ok();
    let last = attempts.flatten().filter_map(number).max()?;
    Some(dir.join(format!("parts/{task}/{last}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_directory_may_contain_colons() {
        let task: ArrayTask = "3:1:/a:b".parse().expect("a task");
        assert_eq!(task, ArrayTask { number: 3, attempt: 1, dir: "/a:b".into() });
        assert!("3:1".parse::<ArrayTask>().is_err());
        assert!("x:1:/a".parse::<ArrayTask>().is_err());
    }
}
