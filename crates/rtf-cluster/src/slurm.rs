//! Job arrays of Slurm.
//!
//! The output of `squeue --json` differs between versions, that of `squeue --format` does not.

use std::fs::File;

use async_trait::async_trait;
use serde::{Deserialize, Serialize};

use super::command::{command, execute, run};
use super::{
    ClusterError, JOB, JobArray, JobState, OUTPUTS, SCRIPT, Scheduler, TaskState, create_dir,
    parse_job, stored_job, write,
};

/// Calls a program with the number and the attempt of the task, in the option `--array-task`.
const TASK: &str = r#"#!/bin/sh
# Arguments: the directory of the submission, a program, its verb, and further arguments.
dir=$1 program=$2 verb=$3
shift 3
attempt=${SLURM_RESTART_COUNT:-0}
mkdir -p "$dir/parts/$SLURM_ARRAY_TASK_ID/$attempt" || exit
exec "$program" "$verb" "--array-task=$SLURM_ARRAY_TASK_ID:$attempt:$dir" "$@"
"#;

/// Reasons for waiting that end without the user, as Slurm names them.
const USUAL_REASONS: [&str; 6] =
    ["None", "Resources", "Priority", "BeginTime", "Licenses", "JobArrayTaskLimit"];

/// How to submit job arrays.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Slurm {
    /// The path of `rtf`, on all nodes.
    pub program: String,
    /// Further arguments of `sbatch`.
    pub options: Vec<String>,
}

#[async_trait]
impl Scheduler for Slurm {
    fn name(&self) -> &'static str {
        "slurm"
    }

    fn install_hint(&self) -> &'static str {
        "run `rtf` on a machine with Slurm's commands on PATH"
    }

    async fn submit(
        &self,
        array: &JobArray<'_>,
        is_resumed: bool,
        lock: &File,
    ) -> Result<String, ClusterError> {
        if is_resumed && let Some(id) = find_job(array.name).await? {
            return Ok(id);
        }
        let script = array.dir.join(SCRIPT);
        write(script.clone(), TASK)?;
        let outputs = create_dir(array.dir.join(OUTPUTS))?;
        let job = array.dir.join(JOB);
        let job_file =
            File::create(&job).map_err(|source| ClusterError::File { path: job, source })?;
        // `%` begins a replacement symbol.
        let output = outputs.to_string_lossy().replace('%', "%%");
        let mut sbatch = command("sbatch");
        sbatch
            .args(["--parsable", "--requeue", "--open-mode=append"])
            .arg(format!("--array={}", ranges(array.tasks)))
            .arg(format!("--job-name={}", array.name))
            .arg(format!("--output={output}/%a.txt"))
            .args(licenses(array.resources))
            .arg("--chdir")
            .arg(array.working_dir)
            .args(&self.options)
            .arg(&script)
            .arg(array.dir)
            .arg(&self.program)
            .args(array.command)
            .stdin(lock.try_clone().map_err(|source| execute("sbatch", source))?)
            .stdout(job_file);
        run("sbatch", sbatch).await?;
        stored_job(array.dir)?.ok_or_else(|| ClusterError::Failed {
            command: "sbatch",
            message: "it printed no job id".to_owned(),
        })
    }

    async fn state(&self, job: &str, _: &[u32]) -> Result<JobState, ClusterError> {
        let mut squeue = command("squeue");
        squeue.args(["--noheader", "--array", "--format=%K %T %r"]).arg(format!("--jobs={job}"));
        match run("squeue", squeue).await {
            Ok(text) => {
                let mut state = JobState::default();
                text.lines().for_each(|line| _ = add_task(&mut state, line));
                Ok(state)
            }
            // Slurm forgets a job some minutes after its end.
            Err(ClusterError::Failed { message, .. }) if message.contains("Invalid job id") => {
                Ok(JobState::default())
            }
            Err(error) => Err(error),
        }
    }

    async fn cancel_waiting(&self, job: &str) -> Result<(), ClusterError> {
        scancel(["--state=PENDING", job]).await
    }

    /// Sends SIGTERM to the program of some tasks, and not to its children.
    async fn terminate(&self, job: &str, tasks: &[u32], _: bool) -> Result<(), ClusterError> {
        let tasks = format!("{job}_[{}]", ranges(tasks));
        scancel(["--batch", "--signal=TERM", &tasks]).await
    }

    async fn cancel(&self, job: &str) -> Result<(), ClusterError> {
        scancel([job]).await
    }
}

/// The job with a name, if Slurm has not forgotten it.
async fn find_job(name: &str) -> Result<Option<String>, ClusterError> {
    let mut squeue = command("squeue");
    squeue.args(["--noheader", "--states=all", "--format=%F"]).arg(format!("--name={name}"));
    Ok(parse_job(&run("squeue", squeue).await?))
}

/// Adds the task of a line of `squeue`.
fn add_task(state: &mut JobState, line: &str) -> Option<()> {
    let mut words = line.splitn(3, ' ');
    let number = words.next()?.parse().ok()?;
    let is_waiting = words.next()? == "PENDING";
    let reason = words.next().unwrap_or_default().trim();
    if is_waiting && !USUAL_REASONS.contains(&reason) {
        state.notices.insert(format!("task {number} waits: {reason}"));
    }
    state.tasks.push(TaskState { number, is_waiting });
    Some(())
}

async fn scancel<const N: usize>(args: [&str; N]) -> Result<(), ClusterError> {
    let mut scancel = command("scancel");
    scancel.args(args);
    run("scancel", scancel).await.map(drop)
}

/// The option that requests a licence of each resource, if there is any.
fn licenses(resources: &[String]) -> Option<String> {
    let licenses: Vec<_> = resources.iter().map(|name| format!("{name}:1")).collect();
    (!licenses.is_empty()).then(|| format!("--licenses={}", licenses.join(",")))
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
    fn tasks_wait_or_run() {
        let mut state = JobState::default();
        let lines =
            ["3 PENDING launch failed requeued held", "5 PENDING Resources", "12 RUNNING None"];
        // Removed tasks that waited have no number.
        for line in lines.into_iter().chain(["N/A CANCELLED Resources"]) {
            add_task(&mut state, line);
        }
        let waiting: Vec<_> = state.tasks.iter().map(|it| (it.number, it.is_waiting)).collect();
        assert_eq!(waiting, [(3, true), (5, true), (12, false)]);
        let notices: Vec<_> = state.notices.into_iter().collect();
        assert_eq!(notices, ["task 3 waits: launch failed requeued held"]);
    }
}
