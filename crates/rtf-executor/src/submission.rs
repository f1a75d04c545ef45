//! The directory of a submission, from which it is resumed.

use std::ffi::OsString;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use rtf_cluster::Cluster;
use rtf_plan::plan::Plan;
use rtf_run::error::Failure;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

use crate::{ClusterOptions, last_attempt};

/// The directory of all submissions in a results directory: hidden, so that `rtf-results/*` names
/// runs only.
const DIR: &str = ".submissions";
/// The file with [`Stored`].
const STORED: &str = "submission.json";

#[derive(Debug)]
pub struct Submission {
    /// Its directory, absolute.
    pub dir: PathBuf,
    /// The content of its file.
    pub stored: Stored,
    /// Whether another process created it.
    pub is_resumed: bool,
}

/// What a process needs to submit, or to follow and merge.
#[derive(Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stored {
    /// The name of the job.
    pub name: String,
    /// The arguments of `rtf run`, as the user typed them: `--resume` and each task, on its machine,
    /// resolve them, and the scheduler shows them.
    pub args: Vec<String>,
    /// The working directory of `rtf run`.
    pub working_dir: String,
    /// The number of shards.
    pub shards: u32,
    /// The shards that contain tests.
    pub tasks: Vec<u32>,
    /// The number of tests of all shards.
    pub tests: u32,
    /// The resources that are requested for each task.
    #[serde(default)]
    pub resources: Vec<String>,
    /// Where it is submitted, and how.
    pub cluster: Cluster,
}

impl Submission {
    /// Creates the directory, below `results`, of a submission of this process.
    pub fn create(
        results: &Path,
        options: ClusterOptions,
        plan: &Plan,
        tasks: Vec<u32>,
    ) -> Result<Self, Failure> {
        let name = format!("rtf-{}", &Uuid::now_v7().simple().to_string());
        let dir = std::path::absolute(results.join(DIR).join(&name));
        let dir = dir.map_err(Failure::internal)?;
        let working_dir = std::env::current_dir().map_err(Failure::internal)?;
        let stored = Stored {
            name,
            args: run_arguments(std::env::args_os().skip(1))?,
            working_dir: utf8_text(working_dir.into())?,
            shards: options.shards,
            tasks,
            tests: plan.tests,
            resources: options.resources(plan),
            cluster: options.cluster,
        };
        utf8_text(dir.clone().into())?;
        let file = dir.join(STORED);
        let json = serde_json::to_vec_pretty(&stored).map_err(Failure::internal)?;
        let written = fs::create_dir_all(&dir).and_then(|()| replace(&file, &json));
        written.map_err(|error| cannot("write", &file, &error))?;
        Ok(Self { dir, stored, is_resumed: false })
    }

    /// Opens the directory of a submission of another process.
    pub fn open(dir: &Path) -> Result<Self, Failure> {
        let file = dir.join(STORED);
        let hint = "give the directory that `rtf run --executor …` printed";
        let dir = std::path::absolute(dir).map_err(Failure::internal)?;
        let json = fs::read(&file).map_err(|error| cannot("read", &file, &error).hint(hint))?;
        let stored = serde_json::from_slice(&json)
            .map_err(|error| Failure::input(format!("`{}` is invalid: {error}", file.display())))?;
        Ok(Self { dir, stored, is_resumed: true })
    }

    /// Locks the submission against other processes, until the file is closed.
    pub fn lock(&self) -> Result<File, Failure> {
        let path = self.dir.join("lock");
        let file = File::options().create(true).append(true).open(&path);
        let file = file.map_err(|error| cannot("write", &path, &error))?;
        match file.try_lock() {
            Ok(()) => Ok(file),
            Err(TryLockError::WouldBlock) => {
                Err(Failure::input("another process follows this submission"))
            }
            Err(TryLockError::Error(error)) => Err(cannot("lock", &path, &error)),
        }
    }

    /// Removes the directory, unless another process created it: nothing was submitted.
    pub fn discard(&self) {
        if !self.is_resumed {
            let _ = fs::remove_dir_all(&self.dir);
        }
    }

    /// The file with the output of a task.
    pub fn output(&self, task: u32) -> PathBuf {
        self.dir.join(format!("output/{task}.txt"))
    }

    /// The directory of the run of the last attempt of a task.
    pub fn last_run(&self, task: u32) -> Option<PathBuf> {
        last_attempt(&self.dir, task)?.join("latest").canonicalize().ok()
    }
}

/// The arguments after the verb.
fn run_arguments(args: impl Iterator<Item = OsString>) -> Result<Vec<String>, Failure> {
    let mut args = args;
    while let Some(arg) = args.next() {
        if arg == "--color" {
            args.next();
        } else if !arg.to_string_lossy().starts_with('-') {
            break;
        }
    }
    args.map(utf8_text).collect()
}

/// A text as it can be stored.
///
/// # Errors
/// It is not valid UTF-8.
pub fn utf8_text(text: OsString) -> Result<String, Failure> {
    text.into_string().map_err(|text| {
        let error = format!("`{}` is not valid UTF-8", text.to_string_lossy());
        Failure::input(error).hint("`--executor` needs arguments and paths in UTF-8")
    })
}

/// Writes a file that is complete or absent.
fn replace(file: &Path, content: &[u8]) -> io::Result<()> {
    let temporary = file.with_extension("new");
    fs::write(&temporary, content)?;
    fs::rename(temporary, file)
}

fn cannot(action: &str, path: &Path, error: &io::Error) -> Failure {
    Failure::input(format!("cannot {action} `{}`: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rtf_cluster::slurm::Slurm;

    #[test]
    fn the_arguments_follow_the_verb() {
        let args = |text: &str| {
            run_arguments(text.split(' ').map(OsString::from)).expect("they are texts").join(" ")
        };
        assert_eq!(args("run a.xml --shards 2"), "a.xml --shards 2");
        assert_eq!(args("--color never run run --color always"), "run --color always");
        assert_eq!(args("--color=never run -- -x"), "-- -x");
    }

    #[test]
    fn the_last_attempt_counts_even_without_a_run() {
        let dir = tempfile::tempdir().expect("a directory");
        let stored = Stored {
            name: "rtf-1".to_owned(),
            args: Vec::new(),
            working_dir: "/".to_owned(),
            shards: 1,
            tasks: vec![1],
            tests: 1,
            resources: Vec::new(),
            cluster: Cluster::Slurm(Slurm { program: "rtf".to_owned(), options: Vec::new() }),
        };
        let path = dir.path().canonicalize().expect("a path");
        let submission = Submission { dir: path.clone(), stored, is_resumed: false };
        assert_eq!(submission.last_run(1), None);
        for attempt in ["0", "2", "10"] {
            let parts = path.join("parts/1").join(attempt);
            fs::create_dir_all(parts.join("run")).expect("a directory");
            std::os::unix::fs::symlink("run", parts.join("latest")).expect("a link");
        }
        assert_eq!(submission.last_run(1), Some(path.join("parts/1/10/run")));
        fs::create_dir_all(path.join("parts/1/11")).expect("a directory");
        assert_eq!(submission.last_run(1), None);
    }
}
