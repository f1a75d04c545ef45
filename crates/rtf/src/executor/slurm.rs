//! A job array of Slurm: submits it, lists its tasks, signals and cancels them. Knows neither
//! suites nor tests.
//!
//! Uses the commands of Slurm. The output of `squeue --json` differs between versions, that of
//! `squeue --format` does not.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};

use tokio::process::Command;

/// Calls a program with the number and the attempt of the task, see [`super::ArrayTask`].
const SCRIPT: &str = r#"#!/bin/sh
# Arguments: the directory of the submission, a program, its verb, and further arguments.
dir=$1 program=$2 verb=$3
shift 3
attempt=${SLURM_RESTART_COUNT:-0}
mkdir -p "$dir/parts/$SLURM_ARRAY_TASK_ID/$attempt" || exit
exec "$program" "$verb" "--array-task=$SLURM_ARRAY_TASK_ID:$attempt:$dir" "$@"
"#;

/// The file with the id of the job.
const JOB: &str = "job";

/// A command of Slurm failed.
#[derive(Debug, thiserror::Error)]
pub enum SlurmError {
    /// A command could not be started.
    #[error("cannot execute `{command}`")]
    Execute {
        /// The command.
        command: &'static str,
        /// The cause.
        #[source]
        source: io::Error,
    },
    /// A command reported an error.
    #[error("`{command}` failed: {message}")]
    Failed {
        /// The command.
        command: &'static str,
        /// Its standard error.
        message: String,
    },
    /// A file of the submission cannot be read or written.
    #[error("cannot access `{}`", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The cause.
        #[source]
        source: io::Error,
    },
}

impl SlurmError {
    /// What the user can do about it.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Execute { .. } => Some("run `rtf` on a machine with Slurm's commands on PATH"),
            Self::Failed { .. } | Self::File { .. } => None,
        }
    }
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
    /// Further arguments of `sbatch`.
    pub options: &'a [String],
    /// The program, its verb and its arguments.
    pub command: &'a [String],
}

/// The id of a job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JobId(String);

impl std::fmt::Display for JobId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

/// A task that Slurm has not finished.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TaskState {
    /// Its number.
    pub number: u32,
    /// Whether it waits for resources.
    pub is_waiting: bool,
    /// Why it waits.
    pub reason: String,
}

impl JobArray<'_> {
    /// The job that another process may have submitted: stored, or known to Slurm by its name.
    /// Otherwise the tasks are submitted now.
    pub async fn find_or_submit(&self, lock: &File) -> Result<JobId, SlurmError> {
        if let Some(job) = stored_job(self.dir)? {
            return Ok(job);
        }
        match find_job(self.name).await? {
            Some(job) => Ok(job),
            None => self.submit(lock).await,
        }
    }

    /// Submits the tasks. `lock` is locked until `sbatch` has ended, even if this process is
    /// killed.
    pub async fn submit(&self, lock: &File) -> Result<JobId, SlurmError> {
        let script = self.dir.join("task.sh");
        let outputs = self.dir.join("output");
        let job = self.dir.join(JOB);
        write(&script, |path| std::fs::write(path, SCRIPT))?;
        write(&outputs, |path| std::fs::create_dir_all(path))?;
        let job_file = write(&job, |path| File::create(path))?;
        // `%` begins a replacement symbol.
        let output = outputs.to_string_lossy().replace('%', "%%");
        let mut sbatch = command("sbatch");
        sbatch
            .args(["--parsable", "--requeue", "--open-mode=append"])
            .arg(format!("--array={}", ranges(self.tasks)))
            .arg(format!("--job-name={}", self.name))
            .arg(format!("--output={output}/%a.txt"))
            .arg("--chdir")
            .arg(self.working_dir)
            .args(self.options)
            .arg(&script)
            .arg(self.dir)
            .args(self.command)
            .stdin(lock.try_clone().map_err(|source| execute("sbatch", source))?)
            .stdout(job_file);
        run("sbatch", sbatch).await?;
        stored_job(self.dir)?.ok_or_else(|| SlurmError::Failed {
            command: "sbatch",
            message: "it printed no job id".to_owned(),
        })
    }
}

/// The job of a submission, from its file.
fn stored_job(dir: &Path) -> Result<Option<JobId>, SlurmError> {
    let path = dir.join(JOB);
    match std::fs::read_to_string(&path) {
        Ok(text) => Ok(parse_job(&text)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(source) => Err(SlurmError::File { path, source }),
    }
}

/// The job with a name, if Slurm has not forgotten it.
async fn find_job(name: &str) -> Result<Option<JobId>, SlurmError> {
    let mut squeue = command("squeue");
    squeue.args(["--noheader", "--states=all", "--format=%F"]).arg(format!("--name={name}"));
    Ok(parse_job(&run("squeue", squeue).await?))
}

/// Parses `17` or `17;cluster`.
fn parse_job(text: &str) -> Option<JobId> {
    let id = text.lines().next()?.split(';').next()?.trim();
    let is_id = !id.is_empty() && id.bytes().all(|byte| byte.is_ascii_digit());
    is_id.then(|| JobId(id.to_owned()))
}

/// The tasks that have not ended.
pub async fn active_tasks(job: &JobId) -> Result<Vec<TaskState>, SlurmError> {
    let mut squeue = command("squeue");
    squeue.args(["--noheader", "--array", "--format=%K %T %r"]).arg(format!("--jobs={job}"));
    match run("squeue", squeue).await {
        Ok(text) => Ok(text.lines().filter_map(parse_task).collect()),
        // Slurm forgets a job some minutes after its end.
        Err(SlurmError::Failed { message, .. }) if message.contains("Invalid job id") => {
            Ok(Vec::new())
        }
        Err(error) => Err(error),
    }
}

fn parse_task(line: &str) -> Option<TaskState> {
    let mut words = line.splitn(3, ' ');
    let number = words.next()?.parse().ok()?;
    let state = words.next()?;
    let reason = words.next().unwrap_or_default().trim().to_owned();
    Some(TaskState { number, is_waiting: state == "PENDING", reason })
}

/// Removes the tasks that wait.
pub async fn cancel_waiting(job: &JobId) -> Result<(), SlurmError> {
    let mut scancel = command("scancel");
    scancel.args(["--state=PENDING", &job.0]);
    run("scancel", scancel).await.map(drop)
}

/// Sends SIGTERM to the program of some tasks, and not to its children.
pub async fn terminate(job: &JobId, tasks: &[u32]) -> Result<(), SlurmError> {
    let mut scancel = command("scancel");
    scancel.args(["--batch", "--signal=TERM"]).arg(format!("{job}_[{}]", ranges(tasks)));
    run("scancel", scancel).await.map(drop)
}

/// Kills all tasks.
pub async fn cancel(job: &JobId) -> Result<(), SlurmError> {
    let mut scancel = command("scancel");
    scancel.arg(&job.0);
    run("scancel", scancel).await.map(drop)
}

/// A command that a terminal's signals do not reach.
fn command(name: &'static str) -> Command {
    let mut command = Command::new(name);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).process_group(0);
    command
}

/// Runs a command and returns its standard output.
async fn run(name: &'static str, mut command: Command) -> Result<String, SlurmError> {
    let child = command.spawn().map_err(|source| execute(name, source))?;
    let Output { status, stdout, stderr } =
        child.wait_with_output().await.map_err(|source| execute(name, source))?;
    if status.success() {
        return Ok(String::from_utf8_lossy(&stdout).into_owned());
    }
    let message = String::from_utf8_lossy(&stderr);
    let message = match message.trim() {
        "" => status.to_string(),
        text => text.lines().collect::<Vec<_>>().join("; "),
    };
    Err(SlurmError::Failed { command: name, message })
}

fn execute(command: &'static str, source: io::Error) -> SlurmError {
    SlurmError::Execute { command, source }
}

fn write<T>(path: &Path, write: impl FnOnce(&Path) -> io::Result<T>) -> Result<T, SlurmError> {
    write(path).map_err(|source| SlurmError::File { path: path.to_owned(), source })
}

/// Formats ascending numbers as `1-3,7`.
fn ranges(numbers: &[u32]) -> String {
    let mut ranges: Vec<(u32, u32)> = Vec::new();
    for number in numbers {
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 == *number => *last = *number,
            _ => ranges.push((*number, *number)),
        }
    }
    let words = ranges.iter().map(|(first, last)| match first == last {
        true => first.to_string(),
        false => format!("{first}-{last}"),
    });
    words.collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn consecutive_numbers_are_ranges() {
        assert_eq!(ranges(&[]), "");
        assert_eq!(ranges(&[4]), "4");
        assert_eq!(ranges(&[1, 2, 3, 7, 9, 10]), "1-3,7,9-10");
    }

    #[test]
    fn a_job_id_may_be_followed_by_its_cluster() {
        let id = |text| parse_job(text).map(|id| id.to_string());
        assert_eq!(id("17\n"), Some("17".to_owned()));
        assert_eq!(id("17;alpha\n"), Some("17".to_owned()));
        assert_eq!(id(""), None);
        assert_eq!(id("sbatch: error\n"), None);
    }

    #[test]
    fn tasks_wait_or_run() {
        let task = parse_task("3 PENDING launch failed requeued held").expect("a task");
        let reason = "launch failed requeued held".to_owned();
        assert_eq!(task, TaskState { number: 3, is_waiting: true, reason });
        let task = parse_task("12 RUNNING None").expect("a task");
        assert!(!task.is_waiting);
        // Removed tasks that waited have no number.
        assert_eq!(parse_task("N/A CANCELLED Resources"), None);
    }
}
