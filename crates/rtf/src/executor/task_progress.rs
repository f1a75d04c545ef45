//! Prints the state of the tasks of a job.

use std::collections::BTreeSet;

use super::slurm::{JobId, TaskState};
use crate::diagnostics::count;
use crate::terminal;

/// Reasons for waiting that end without the user, as Slurm names them.
const USUAL_REASONS: [&str; 6] =
    ["None", "Resources", "Priority", "BeginTime", "Licenses", "JobArrayTaskLimit"];

/// Prints the state of the tasks when it has changed.
pub struct TaskProgress {
    job: JobId,
    /// The number of all tasks.
    all: usize,
    last: String,
    /// The tasks that wait for an unusual reason, and were reported.
    stuck: BTreeSet<(u32, String)>,
}

impl TaskProgress {
    /// Nothing is printed yet.
    pub fn new(job: &JobId, all: usize) -> Self {
        Self { job: job.clone(), all, last: String::new(), stuck: BTreeSet::new() }
    }

    /// Prints a line, which ends with `more`, if something has changed.
    pub fn print(&mut self, tasks: &[TaskState], more: &str) {
        let job = &self.job;
        for task in tasks.iter().filter(|task| task.is_waiting) {
            let TaskState { number, reason, .. } = task;
            let is_usual = USUAL_REASONS.contains(&reason.as_str());
            if !is_usual && self.stuck.insert((*number, reason.clone())) {
                terminal::notice(format!("slurm: job {job}: task {number} waits: {reason}"));
            }
        }
        let waiting = tasks.iter().filter(|task| task.is_waiting).count();
        let (running, ended) = (tasks.len() - waiting, self.all.saturating_sub(tasks.len()));
        let all = count(self.all, "task");
        let line = format!("{ended} of {all} ended, {running} running, {waiting} waiting{more}");
        if line != self.last {
            terminal::notice(format!("slurm: job {job}: {line}"));
            self.last = line;
        }
    }
}
