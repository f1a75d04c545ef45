//! A job in a cluster whose tasks each execute a command: submitted, listed, stopped. Knows neither
//! suites nor tests. The [`Scheduler`] is Slurm ([`slurm`]) or Kubernetes ([`kubernetes`]), driven
//! by its commands.

mod command;
pub mod kubernetes;
pub mod slurm;

use std::collections::BTreeSet;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use async_trait::async_trait;
use serde::{Deserialize, Serialize};

pub use command::ClusterError;
use kubernetes::Kubernetes;
use slurm::Slurm;

/// The file with the id of the job.
const JOB: &str = "job";
/// The script that each task executes.
const SCRIPT: &str = "task.sh";
/// The directory with what each task printed.
const OUTPUTS: &str = "output";

/// The scheduler of a cluster, and how to submit to it. Stored with each submission.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "executor", rename_all = "kebab-case")]
pub enum Cluster {
    /// Job arrays of Slurm.
    Slurm(Slurm),
    /// Indexed Jobs of Kubernetes.
    Kubernetes(Kubernetes),
}

/// The tasks to submit.
pub struct JobArray<'a> {
    /// The directory of the submission, absolute.
    pub dir: &'a Path,
    /// The name of the job, unique in the cluster.
    pub name: &'a str,
    /// The numbers of the tasks, ascending.
    pub tasks: &'a [u32],
    /// The working directory of the tasks.
    pub working_dir: &'a Path,
    /// The verb of `rtf` and its arguments.
    pub command: &'a [String],
    /// The resources of which each task gets one: ASCII letters, digits, `_`, `-` and `.`.
    pub resources: &'a [String],
}

/// A job that was submitted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Job {
    cluster: Cluster,
    id: String,
    /// Its tasks, ascending.
    tasks: Vec<u32>,
}

/// What a scheduler reports about a job.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct JobState {
    /// The tasks that have not ended, by number.
    pub tasks: Vec<TaskState>,
    /// What the user should know: why tasks wait that need more than free resources, or why an
    /// attempt has failed.
    pub notices: BTreeSet<String>,
}

/// A task that has not ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TaskState {
    pub number: u32,
    /// Whether it has not started.
    pub is_waiting: bool,
}

/// Where the tasks of a job run.
#[async_trait]
trait Scheduler: Sync {
    /// The name of the executor, as on the command line.
    fn name(&self) -> &'static str;

    /// How the user gets the commands of the scheduler.
    fn install_hint(&self) -> &'static str;

    /// Submits the tasks, unless `is_resumed` and the scheduler knows the name of the job. Returns
    /// its id, which is also stored. `lock` is locked until the command of the scheduler has ended.
    async fn submit(
        &self,
        array: &JobArray<'_>,
        is_resumed: bool,
        lock: &File,
    ) -> Result<String, ClusterError>;

    /// Prepares the directory of a job that the user submits. Returns its manifest, if the scheduler
    /// has such a thing.
    async fn manifest(&self, _: &JobArray<'_>) -> Result<Option<String>, ClusterError> {
        Ok(None)
    }

    /// The tasks that have not ended.
    async fn state(&self, job: &str, tasks: &[u32]) -> Result<JobState, ClusterError>;

    /// Removes the tasks that wait.
    async fn cancel_waiting(&self, job: &str) -> Result<(), ClusterError>;

    /// Lets tasks that run tear down and end. A repeated request ends them without a tear-down.
    async fn terminate(
        &self,
        job: &str,
        tasks: &[u32],
        is_repeated: bool,
    ) -> Result<(), ClusterError>;

    /// Kills all tasks.
    async fn cancel(&self, job: &str) -> Result<(), ClusterError>;
}

impl Cluster {
    fn scheduler(&self) -> &dyn Scheduler {
        match self {
            Self::Slurm(slurm) => slurm,
            Self::Kubernetes(kubernetes) => kubernetes,
        }
    }

    /// The name of the executor, as on the command line.
    pub fn name(&self) -> &'static str {
        self.scheduler().name()
    }

    /// What the user can do about an error.
    pub fn hint(&self, error: &ClusterError) -> Option<&'static str> {
        matches!(error, ClusterError::Execute { .. }).then(|| self.scheduler().install_hint())
    }

    /// Submits a job, unless `is_resumed` and an earlier process has submitted it. `lock` is locked
    /// until the command of the scheduler has ended, even if this process is killed.
    pub async fn submit(
        &self,
        array: &JobArray<'_>,
        is_resumed: bool,
        lock: &File,
    ) -> Result<Job, ClusterError> {
        let stored = if is_resumed { stored_job(array.dir)? } else { None };
        let id = match stored {
            Some(id) => id,
            None => self.scheduler().submit(array, is_resumed, lock).await?,
        };
        Ok(Job { cluster: self.clone(), id, tasks: array.tasks.to_vec() })
    }

    /// Prepares the directory of a job that the user submits. Returns its manifest, if the scheduler
    /// has such a thing.
    pub async fn manifest(&self, array: &JobArray<'_>) -> Result<Option<String>, ClusterError> {
        self.scheduler().manifest(array).await
    }
}

impl Job {
    /// The tasks that have not ended.
    pub async fn state(&self) -> Result<JobState, ClusterError> {
        self.cluster.scheduler().state(&self.id, &self.tasks).await
    }

    /// Removes the tasks that wait.
    pub async fn cancel_waiting(&self) -> Result<(), ClusterError> {
        self.cluster.scheduler().cancel_waiting(&self.id).await
    }

    /// Lets tasks that run tear down and end. A repeated request ends them without a tear-down.
    pub async fn terminate(&self, tasks: &[u32], is_repeated: bool) -> Result<(), ClusterError> {
        self.cluster.scheduler().terminate(&self.id, tasks, is_repeated).await
    }

    /// Kills all tasks.
    pub async fn cancel(&self) -> Result<(), ClusterError> {
        self.cluster.scheduler().cancel(&self.id).await
    }
}

/// `slurm: job 17`.
impl std::fmt::Display for Job {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: job {}", self.cluster.name(), self.id)
    }
}

/// The job of a submission, from its file.
fn stored_job(dir: &Path) -> Result<Option<String>, ClusterError> {
    let path = dir.join(JOB);
    match std::fs::read_to_string(&path) {
        Ok(text) => Ok(parse_job(&text)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(source) => Err(ClusterError::File { path, source }),
    }
}

/// Parses `17`, `17;cluster` or the name of a job of Kubernetes.
fn parse_job(text: &str) -> Option<String> {
    let id = text.lines().next()?.split(';').next()?.trim();
    let is_id =
        !id.is_empty() && id.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'-');
    is_id.then(|| id.to_owned())
}

/// Writes a file of a submission.
fn write(path: PathBuf, content: impl AsRef<[u8]>) -> Result<(), ClusterError> {
    std::fs::write(&path, content).map_err(|source| ClusterError::File { path, source })
}

/// Creates a directory of a submission.
fn create_dir(path: PathBuf) -> Result<PathBuf, ClusterError> {
    match std::fs::create_dir_all(&path) {
        Ok(()) => Ok(path),
        Err(source) => Err(ClusterError::File { path, source }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_id_may_be_followed_by_its_cluster() {
        assert_eq!(parse_job("17\n"), Some("17".to_owned()));
        assert_eq!(parse_job("17;alpha\n"), Some("17".to_owned()));
        assert_eq!(parse_job("rtf-0c1"), Some("rtf-0c1".to_owned()));
        assert_eq!(parse_job(""), None);
        assert_eq!(parse_job("sbatch: error\n"), None);
    }
}
