//! The options of an executor: what is submitted where.

use std::path::{Path, PathBuf};
use std::time::Duration;

use rtf_cluster::Cluster;
use rtf_cluster::kubernetes::Kubernetes;
use rtf_cluster::slurm::Slurm;
use rtf_plan::plan::Plan;
use rtf_run::error::Failure;

use crate::stop::STOP_GRACE;
use crate::submission::text;

/// Where tests and episodes run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Executor {
    /// This machine.
    Local,
    /// A Slurm cluster.
    Slurm,
    /// A Kubernetes cluster.
    Kubernetes,
}

impl std::fmt::Display for Executor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Local => "local",
            Self::Slurm => "slurm",
            Self::Kubernetes => "kubernetes",
        })
    }
}

/// The executor, and its tasks.
pub struct ClusterOptions {
    pub executor: Executor,
    /// The number of tasks, from 1.
    pub shards: Option<u32>,
    /// Arguments of `sbatch` or `kubectl`.
    pub args: Vec<String>,
    /// Whether a licence or an extended resource is requested for each resource that a suite requires.
    pub licenses: bool,
    pub kubernetes: KubernetesOptions,
}

/// What a Job of Kubernetes needs.
pub struct KubernetesOptions {
    /// The image with `rtf` and the suites.
    pub image: Option<String>,
    /// The PersistentVolumeClaim of the results directory.
    pub claim: Option<String>,
    /// The file that is merged into the Job.
    pub patch: Option<PathBuf>,
    /// Whether the Job is printed instead of submitted.
    pub print: bool,
}

/// The domain of extended resources of Kubernetes.
const RESOURCE_DOMAIN: &str = "rtf";

/// The number of tasks.
pub fn shards(args: &ClusterOptions) -> Result<u32, Failure> {
    args.shards.ok_or_else(|| {
        let error = format!("`--executor {}` needs the number of shards", args.executor);
        Failure::input(error).hint("add `--shards N`")
    })
}

/// The cluster, unless everything runs on this machine. Tasks write into `results`, and end within
/// `shutdown_timeout`.
pub fn cluster(
    args: &ClusterOptions,
    plan: &Plan,
    results: &Path,
    shutdown_timeout: Duration,
) -> Result<Option<Cluster>, Failure> {
    match args.executor {
        Executor::Local => Ok(None),
        Executor::Slurm => {
            let mut options = args.args.clone();
            let licenses = required(args, plan).map(|it| format!("{it}:1")).collect::<Vec<_>>();
            if !licenses.is_empty() {
                options.push(format!("--licenses={}", licenses.join(",")));
            }
            let program = std::env::current_exe().map_err(Failure::internal)?;
            Ok(Some(Cluster::Slurm(Slurm { program: text(program.into())?, options })))
        }
        Executor::Kubernetes => {
            let resources = required(args, plan).map(|it| format!("{RESOURCE_DOMAIN}/{it}"));
            let resources = resources.collect();
            let mount = std::path::absolute(results).map_err(Failure::internal)?;
            Ok(Some(Cluster::Kubernetes(Kubernetes {
                image: image(args)?,
                claim: args.kubernetes.claim.clone(),
                mount: text(mount.into())?,
                grace_secs: (shutdown_timeout + STOP_GRACE).as_secs(),
                resources,
                patch: patch(args)?,
                options: args.args.clone(),
            })))
        }
    }
}

fn image(args: &ClusterOptions) -> Result<String, Failure> {
    let image = args.kubernetes.image.clone();
    image.ok_or_else(|| {
        Failure::input("`--executor kubernetes` needs an image with `rtf` and the suites")
            .hint("add `--executor-image IMAGE`")
    })
}

/// The text of the patch. Without one, the results need a claim.
fn patch(args: &ClusterOptions) -> Result<Option<String>, Failure> {
    let Some(path) = &args.kubernetes.patch else {
        if args.kubernetes.claim.is_some() {
            return Ok(None);
        }
        let error = "`--executor kubernetes` needs a shared volume for the results";
        let hint = "add `--executor-claim CLAIM`, or mount one with `--executor-patch FILE`";
        return Err(Failure::input(error).hint(hint));
    };
    let text = std::fs::read_to_string(path)
        .map_err(|error| Failure::input(format!("cannot read `{}`: {error}", path.display())))?;
    Ok(Some(text))
}

/// The names of the resources that the suites require, if they are to be requested.
fn required<'a>(args: &ClusterOptions, plan: &'a Plan) -> impl Iterator<Item = String> + use<'a> {
    let suites = plan.suites.iter().filter(|_| args.licenses);
    let required = suites.flat_map(|suite| &suite.settings.requires);
    let names: std::collections::BTreeSet<_> = required.map(|it| plain_name(&it.name)).collect();
    names.into_iter()
}

/// The name of a resource for a scheduler: `:` and other characters have a meaning.
fn plain_name(resource: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
    resource.chars().map(|c| if is_plain(c) { c } else { '_' }).collect()
}

/// Refuses options that have no effect with the executor.
pub fn refuse_unused(args: &ClusterOptions) -> Result<(), Failure> {
    let is_cluster = args.executor != Executor::Local;
    let is_kubernetes = args.executor == Executor::Kubernetes;
    let kubernetes = &args.kubernetes;
    let given = [
        ("--shards", args.shards.is_some(), is_cluster),
        ("--executor-arg", !args.args.is_empty(), is_cluster),
        ("--executor-licenses", args.licenses, is_cluster),
        ("--executor-image", kubernetes.image.is_some(), is_kubernetes),
        ("--executor-claim", kubernetes.claim.is_some(), is_kubernetes),
        ("--executor-patch", kubernetes.patch.is_some(), is_kubernetes),
        ("--executor-print", kubernetes.print, is_kubernetes),
    ];
    let unused = given.iter().find(|(_, is_given, has_effect)| *is_given && !has_effect);
    let Some((option, ..)) = unused else { return Ok(()) };
    let executors = match *option {
        "--shards" | "--executor-arg" | "--executor-licenses" => {
            "`--executor slurm` or `--executor kubernetes`"
        }
        _ => "`--executor kubernetes`",
    };
    let error = format!("`{option}` has no effect without {executors}");
    Err(Failure::input(error).hint(format!("add {executors}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resources_have_plain_names() {
        assert_eq!(plain_name("robot:left-arm"), "robot_left-arm");
        assert_eq!(plain_name("a,b c"), "a_b_c");
    }
}
