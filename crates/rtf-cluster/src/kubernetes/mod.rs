//! Indexed Jobs of Kubernetes, with `kubectl`: [`manifest`] is what is submitted, [`status`] what the
//! cluster reports.

mod manifest;
mod status;

use std::fs::File;

use async_trait::async_trait;
use serde::{Deserialize, Serialize};
use tokio::process::Command;

use super::command::{command, execute, run};
use super::{ClusterError, JOB, JobArray, JobState, OUTPUTS, SCRIPT, Scheduler, create_dir, write};

const KUBECTL: &str = "kubectl";

const MANIFEST: &str = "job.json";

/// The numbers of the tasks, one a line: that of an index is in the line with its number.
const TASKS: &str = "tasks";

/// Calls a program with the number of the task and a new attempt, in the option `--array-task`. An
/// attempt is a directory that did not exist before: Kubernetes does not number the pods of an index.
const TASK: &str = r#"# Arguments: the directory of the submission, a program, its verb, and further arguments.
dir=$1 program=$2 verb=$3
shift 3
fail() {
  echo "$1" >&2
  exit 2
}
command -v "$program" >/dev/null || fail "the image has no \`$program\` on PATH"
task=$(sed -n "$((JOB_COMPLETION_INDEX + 1))p" "$dir/tasks")
mkdir -p "$dir/parts/$task" || fail "cannot write to $dir"
attempt=0
until mkdir "$dir/parts/$task/$attempt" 2>/dev/null; do
  [ -d "$dir/parts/$task/$attempt" ] || fail "cannot write to $dir/parts/$task"
  attempt=$((attempt + 1))
done
exec "$program" "$verb" "--array-task=$task:$attempt:$dir" "$@" >>"$dir/output/$task.txt" 2>&1
"#;

/// How to submit Jobs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Kubernetes {
    /// The image of the container.
    pub image: String,
    /// The claim of the volume with the results, unless the patch mounts them.
    pub claim: Option<String>,
    /// Where it is mounted: the directory of the results, absolute.
    pub mount: String,
    /// How long a pod may take to end after SIGTERM, in seconds.
    pub grace_secs: u64,
    /// A patch of the manifest, in YAML or JSON.
    pub patch: Option<String>,
    /// Further arguments of `kubectl`.
    pub options: Vec<String>,
}

#[async_trait]
impl Scheduler for Kubernetes {
    fn name(&self) -> &'static str {
        "kubernetes"
    }

    fn install_hint(&self) -> &'static str {
        "install `kubectl`, and let its configuration name the cluster"
    }

    async fn submit(
        &self,
        array: &JobArray<'_>,
        is_resumed: bool,
        lock: &File,
    ) -> Result<String, ClusterError> {
        if !is_resumed || !self.exists(array.name).await? {
            self.prepare(array).await?;
            let mut create = self.kubectl("create");
            create
                .arg("--filename")
                .arg(array.dir.join(MANIFEST))
                .stdin(lock.try_clone().map_err(|source| execute(KUBECTL, source))?);
            run("kubectl create", create).await?;
        }
        write(array.dir.join(JOB), format!("{}\n", array.name))?;
        Ok(array.name.to_owned())
    }

    async fn manifest(&self, array: &JobArray<'_>) -> Result<Option<String>, ClusterError> {
        self.prepare(array).await.map(Some)
    }

    async fn state(&self, job: &str, tasks: &[u32]) -> Result<JobState, ClusterError> {
        let mut get = self.kubectl("get");
        get.args(["jobs.batch,pods", "--output=json"]).arg(selector(job));
        let json = run("kubectl get", get).await?;
        status::parse(&json, tasks)
            .map_err(|source| ClusterError::Invalid { command: "kubectl get", source })
    }

    /// Also ends the pods that run: they get SIGTERM, and the Job vanishes when none is left.
    async fn cancel_waiting(&self, job: &str) -> Result<(), ClusterError> {
        let mut delete = self.kubectl("delete");
        delete.args(["--cascade=foreground", "--wait=false", "--ignore-not-found"]);
        delete.arg(format!("jobs.batch/{job}"));
        run("kubectl delete", delete).await.map(drop)
    }

    async fn terminate(&self, job: &str, _: &[u32], is_repeated: bool) -> Result<(), ClusterError> {
        match is_repeated {
            true => self.cancel(job).await,
            false => self.cancel_waiting(job).await,
        }
    }

    /// Lets the pods be killed after one second. A shorter time would not wait until they are.
    async fn cancel(&self, job: &str) -> Result<(), ClusterError> {
        self.cancel_waiting(job).await?;
        let mut delete = self.kubectl("delete");
        delete.args(["pods", "--grace-period=1", "--wait=false", "--ignore-not-found"]);
        delete.arg(selector(job));
        run("kubectl delete", delete).await.map(drop)
    }
}

impl Kubernetes {
    /// Writes what the Job needs, and its manifest, which is returned.
    async fn prepare(&self, array: &JobArray<'_>) -> Result<String, ClusterError> {
        write(array.dir.join(SCRIPT), TASK)?;
        let lines: String = array.tasks.iter().map(|task| format!("{task}\n")).collect();
        write(array.dir.join(TASKS), lines)?;
        create_dir(array.dir.join(OUTPUTS))?;
        let path = array.dir.join(MANIFEST);
        let mut manifest = format!("{:#}\n", manifest::manifest(self, array));
        write(path.clone(), &manifest)?;
        if let Some(patch) = &self.patch {
            // Merges as Kubernetes does: containers and volumes by their names.
            let mut command = command(KUBECTL);
            command.args(["patch", "--local", "--output=json", "--type=strategic"]);
            command.arg("--filename").arg(&path).arg("--patch").arg(patch);
            manifest = run("kubectl patch", command).await?;
            write(path, &manifest)?;
        }
        Ok(manifest)
    }

    async fn exists(&self, job: &str) -> Result<bool, ClusterError> {
        let mut get = self.kubectl("get");
        get.args(["--ignore-not-found", "--output=name", &format!("jobs.batch/{job}")]);
        Ok(!run("kubectl get", get).await?.trim().is_empty())
    }

    fn kubectl(&self, verb: &str) -> Command {
        let mut command = command(KUBECTL);
        command.arg(verb).args(&self.options);
        command
    }
}

/// Selects a Job and its pods.
fn selector(job: &str) -> String {
    format!("--selector={}={job}", manifest::LABEL)
}
