//! What Kubernetes reports about a Job and its pods.

use std::collections::BTreeSet;

use serde::Deserialize;

use super::super::{JobState, TaskState};
use super::manifest::FINAL_CODES;
use rtf_model::exit_code;

/// The index of a pod.
const INDEX: &str = "batch.kubernetes.io/job-completion-index";

/// Why a container waits before it starts, usually for a short time.
const USUAL_REASONS: [&str; 2] = ["ContainerCreating", "PodInitializing"];

/// The longest message of a container in a notice, in bytes.
const MAX_MESSAGE: usize = 300;

#[derive(Deserialize)]
struct List {
    items: Vec<Object>,
}

/// A Job or a pod.
#[derive(Deserialize)]
struct Object {
    kind: String,
    metadata: Metadata,
    #[serde(default)]
    status: Status,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Metadata {
    name: String,
    #[serde(default)]
    annotations: std::collections::BTreeMap<String, String>,
    deletion_timestamp: Option<String>,
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Status {
    /// Of a pod.
    phase: String,
    conditions: Vec<Condition>,
    container_statuses: Vec<ContainerStatus>,
    init_container_statuses: Vec<ContainerStatus>,
    /// Of a Job: `1,3-5`.
    completed_indexes: String,
    failed_indexes: String,
}

#[derive(Deserialize)]
struct Condition {
    r#type: String,
    status: String,
    #[serde(default)]
    reason: String,
    #[serde(default)]
    message: String,
}

#[derive(Deserialize)]
struct ContainerStatus {
    #[serde(default)]
    state: ContainerState,
}

#[derive(Default, Deserialize)]
struct ContainerState {
    waiting: Option<Waiting>,
    terminated: Option<Terminated>,
}

#[derive(Deserialize)]
struct Waiting {
    #[serde(default)]
    reason: String,
    #[serde(default)]
    message: String,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Terminated {
    exit_code: i64,
    #[serde(default)]
    reason: String,
    #[serde(default)]
    message: String,
}

/// The tasks that have not ended, from the list of a Job and its pods. Without the Job, all have
/// ended: it was deleted.
pub fn parse(json: &str, tasks: &[u32]) -> Result<JobState, serde_json::Error> {
    let list: List = serde_json::from_str(json)?;
    let Some(job) = list.items.iter().find(|object| object.kind == "Job") else {
        return Ok(JobState::default());
    };
    let pods = list.items.iter().filter(|object| object.kind == "Pod");
    let pods: Vec<_> = pods.filter_map(|pod| Some((pod.index()?, pod))).collect();
    let mut state = JobState::default();
    // The pods of a Job that is deleted end with failures.
    if job.metadata.deletion_timestamp.is_none() {
        for (index, pod) in &pods {
            if let Some(reason) = pod.waits_for() {
                // Without its number: many tasks may wait for the same.
                state.notices.insert(format!("a task waits: {reason}"));
            }
            if let (Some(task), Some(problem)) = (tasks.get(*index), pod.problem()) {
                state.notices.insert(format!("task {task}: {problem}"));
            }
        }
        state
            .notices
            .extend(job.condition("Failed").filter(|it| it.is_notable()).map(Condition::text));
    }
    if job.condition("Complete").or(job.condition("Failed")).is_some() {
        return Ok(state);
    }
    let mut ended = indexes(&job.status.completed_indexes);
    ended.append(&mut indexes(&job.status.failed_indexes));
    let running: BTreeSet<usize> = pods
        .iter()
        .filter(|(_, pod)| pod.status.phase == "Running")
        .map(|(index, _)| *index)
        .collect();
    let active = tasks.iter().enumerate().filter(|(index, _)| !ended.contains(index));
    state.tasks = active
        .map(|(index, task)| TaskState { number: *task, is_waiting: !running.contains(&index) })
        .collect();
    Ok(state)
}

impl Object {
    fn index(&self) -> Option<usize> {
        self.metadata.annotations.get(INDEX)?.parse().ok()
    }

    fn condition(&self, kind: &str) -> Option<&Condition> {
        self.status.conditions.iter().find(|it| it.r#type == kind && it.status == "True")
    }

    /// Why a pod has not run to its end.
    fn problem(&self) -> Option<String> {
        if self.status.phase != "Failed" {
            return None;
        }
        let name = &self.metadata.name;
        match self.condition("DisruptionTarget") {
            Some(disruption) => Some(format!("pod {name} was ended: {}", disruption.text())),
            None => Some(format!("pod {name} failed{}", self.failure()?)),
        }
    }

    /// Why a pod cannot start.
    fn waits_for(&self) -> Option<String> {
        let status = &self.status;
        if status.phase != "Pending" {
            return None;
        }
        let containers = status.init_container_statuses.iter().chain(&status.container_statuses);
        let waiting = containers.filter_map(|container| container.state.waiting.as_ref());
        let unusual = waiting.filter(|it| !USUAL_REASONS.contains(&it.reason.as_str()));
        let unusual = unusual.map(|it| join(&it.reason, &it.message)).next();
        let is_unscheduled = |it: &&Condition| it.r#type == "PodScheduled" && it.status == "False";
        let unscheduled = status.conditions.iter().find(is_unscheduled);
        unusual.or_else(|| unscheduled.map(Condition::text))
    }

    /// How the container has ended, unless tests or episodes failed.
    fn failure(&self) -> Option<String> {
        let status = &self.status;
        let containers = status.init_container_statuses.iter().chain(&status.container_statuses);
        let mut ended = containers.filter_map(|container| container.state.terminated.as_ref());
        let Some(ended) = ended.rfind(|it| it.exit_code != 0) else {
            return Some(String::new());
        };
        let Terminated { exit_code, reason, message } = ended;
        if *exit_code == i64::from(exit_code::FAILED) {
            return None;
        }
        let reason = if reason == "Error" { "" } else { reason };
        let message = message.trim().lines().next_back().unwrap_or_default();
        let text = join(reason, message);
        let separator = if text.is_empty() { "" } else { ": " };
        let repeats = FINAL_CODES.iter().any(|code| i64::from(*code) == *exit_code);
        let again = if repeats { ", and is not repeated" } else { "" };
        Some(format!(" with exit code {exit_code}{again}{separator}{text}"))
    }
}

impl Condition {
    /// Whether it is not only that tests or episodes failed.
    fn is_notable(&self) -> bool {
        self.reason != "FailedIndexes"
    }

    fn text(&self) -> String {
        join(&self.reason, &self.message)
    }
}

/// `reason: message`, either of which may be empty.
fn join(reason: &str, message: &str) -> String {
    let end = message.char_indices().map(|(at, _)| at).find(|at| *at >= MAX_MESSAGE);
    let message = &message[..end.unwrap_or(message.len())];
    match (reason, message) {
        ("", text) | (text, "") => text.to_owned(),
        _ => format!("{reason}: {message}"),
    }
}

/// Parses `1,3-5`.
fn indexes(text: &str) -> BTreeSet<usize> {
    let mut indexes = BTreeSet::new();
    for word in text.split(',') {
        let (first, last) = word.split_once('-').unwrap_or((word, word));
        if let (Ok(first), Ok(last)) = (first.parse::<usize>(), last.parse()) {
            indexes.extend(first..=last);
        }
    }
    indexes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indexes_are_numbers_and_ranges() {
        assert_eq!(indexes(""), BTreeSet::new());
        assert_eq!(indexes("1,3-5,9"), BTreeSet::from([1, 3, 4, 5, 9]));
    }

    fn list(job: &str, pods: &[&str]) -> String {
        let job = format!(r#"{{"kind":"Job","metadata":{{"name":"j"}},"status":{{{job}}}}}"#);
        let pod = |(index, status): (usize, &&str)| {
            format!(
                r#"{{"kind":"Pod","metadata":{{"name":"p{index}","annotations":{{"{INDEX}":"{index}"}}}},"status":{{{status}}}}}"#
            )
        };
        let objects = std::iter::once(job).chain(pods.iter().enumerate().map(pod));
        format!(r#"{{"items":[{}]}}"#, objects.collect::<Vec<_>>().join(","))
    }

    #[test]
    fn tasks_wait_run_or_have_ended() {
        let pods = [
            r#""phase":"Succeeded""#,
            r#""phase":"Failed","containerStatuses":[{"state":{"terminated":{"exitCode":1,"reason":"Error"}}}]"#,
            r#""phase":"Running""#,
            r#""phase":"Pending","containerStatuses":[{"state":{"waiting":{"reason":"ErrImagePull","message":"no such image"}}}]"#,
            r#""phase":"Failed","containerStatuses":[{"state":{"terminated":{"exitCode":137,"reason":"OOMKilled"}}}]"#,
        ];
        let json = list(r#""completedIndexes":"0","failedIndexes":"1""#, &pods);
        let state = parse(&json, &[2, 3, 5, 7, 11]).expect("it is valid");
        let tasks: Vec<_> = state.tasks.iter().map(|it| (it.number, it.is_waiting)).collect();
        assert_eq!(tasks, [(5, false), (7, true), (11, true)]);
        let notices: Vec<_> = state.notices.into_iter().collect();
        let expected = [
            "a task waits: ErrImagePull: no such image",
            "task 11: pod p4 failed with exit code 137: OOMKilled",
        ];
        assert_eq!(notices, expected);
    }

    #[test]
    fn a_job_that_has_ended_or_was_deleted_has_no_tasks() {
        let ended = r#""conditions":[{"type":"Failed","status":"True","reason":"PodFailurePolicy","message":"exit code 4"}]"#;
        let state = parse(&list(ended, &[]), &[1, 2]).expect("it is valid");
        assert!(state.tasks.is_empty());
        assert_eq!(state.notices, BTreeSet::from(["PodFailurePolicy: exit code 4".to_owned()]));
        assert_eq!(parse(r#"{"items":[]}"#, &[1]).expect("it is valid"), JobState::default());
    }
}
