//! The manifest of a Job.

use serde_json::{Map, Value, json};

use super::super::{JobArray, SCRIPT};
use super::Kubernetes;
use rtf_model::exit_code;

/// The label of a Job and of its pods; its value is the name of the Job.
pub const LABEL: &str = "app.kubernetes.io/instance";

/// The container, and the volume with the results.
pub const CONTAINER: &str = "rtf";
const VOLUME: &str = "results";

/// How often the pod of an index may fail before the index has failed. Disruptions do not count.
const PER_INDEX_LIMIT: u32 = 3;

/// The exit codes of a pod that another one would repeat: those of `rtf`, and those of a shell that
/// cannot execute a program.
pub const FINAL_CODES: [u8; 6] =
    [exit_code::FAILED, exit_code::BAD_INPUT, exit_code::BROKEN, exit_code::UNDECIDED, 126, 127];

/// The domain of the extended resources.
const RESOURCE_DOMAIN: &str = "rtf";

/// How long Kubernetes keeps a Job that has ended, in seconds: one day.
const KEPT_SECS: u32 = 86_400;

/// The manifest of a Job with an index for each task.
pub fn manifest(kubernetes: &Kubernetes, array: &JobArray<'_>) -> Value {
    let labels = json!({ "app.kubernetes.io/name": "rtf", LABEL: array.name });
    let count = array.tasks.len();
    json!({
        "apiVersion": "batch/v1",
        "kind": "Job",
        "metadata": { "name": array.name, "labels": labels },
        "spec": {
            "completionMode": "Indexed",
            "completions": count,
            "parallelism": count,
            "backoffLimitPerIndex": PER_INDEX_LIMIT,
            "podReplacementPolicy": "Failed",
            "podFailurePolicy": { "rules": failure_rules() },
            "ttlSecondsAfterFinished": KEPT_SECS,
            "template": { "metadata": { "labels": labels }, "spec": pod(kubernetes, array) },
        },
    })
}

/// A failed hook ends everything: the robot may not be in a safe state, even if the pod was
/// disrupted.
fn failure_rules() -> Value {
    let codes = |action: &str, codes: &[u8]| {
        let codes = json!({ "containerName": CONTAINER, "operator": "In", "values": codes });
        json!({ "action": action, "onExitCodes": codes })
    };
    let disrupted = json!([{ "type": "DisruptionTarget", "status": "True" }]);
    json!([
        codes("FailJob", &[exit_code::HOOK_FAILED]),
        { "action": "Ignore", "onPodConditions": disrupted },
        codes("FailIndex", &FINAL_CODES),
    ])
}

fn pod(kubernetes: &Kubernetes, array: &JobArray<'_>) -> Value {
    let mut container = json!({
        "name": CONTAINER,
        "image": kubernetes.image,
        "workingDir": array.working_dir.to_string_lossy(),
        "command": command(array),
        "terminationMessagePolicy": "FallbackToLogsOnError",
    });
    if !array.resources.is_empty() {
        let resources = array.resources.iter();
        let limits = resources.map(|name| (format!("{RESOURCE_DOMAIN}/{name}"), json!("1")));
        container["resources"] = json!({ "limits": Map::from_iter(limits) });
    }
    let mut pod = json!({
        "restartPolicy": "Never",
        "automountServiceAccountToken": false,
        "enableServiceLinks": false,
        "terminationGracePeriodSeconds": kubernetes.grace_secs,
    });
    if let Some(claim) = &kubernetes.claim {
        container["volumeMounts"] = json!([{ "name": VOLUME, "mountPath": kubernetes.mount }]);
        let claim = json!({ "claimName": claim });
        pod["volumes"] = json!([{ "name": VOLUME, "persistentVolumeClaim": claim }]);
    }
    pod["containers"] = json!([container]);
    pod
}

/// The command of the container. Kubernetes replaces `$(NAME)` by a variable.
fn command(array: &JobArray<'_>) -> Vec<String> {
    let dir = array.dir.to_string_lossy();
    let script = array.dir.join(SCRIPT);
    let words = ["/bin/sh".into(), script.to_string_lossy(), dir, "rtf".into()].into_iter();
    let words = words.chain(array.command.iter().map(Into::into));
    words.map(|word| word.replace('$', "$$")).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn variables_in_arguments_are_not_replaced() {
        let array = JobArray {
            dir: Path::new("/r/$(HOME)"),
            name: "rtf-1",
            tasks: &[1],
            working_dir: Path::new("/w"),
            command: &["run".to_owned(), "--set=a=$(HOME)".to_owned()],
            resources: &[],
        };
        let expected =
            ["/bin/sh", "/r/$$(HOME)/task.sh", "/r/$$(HOME)", "rtf", "run", "--set=a=$$(HOME)"];
        assert_eq!(command(&array), expected);
    }
}
