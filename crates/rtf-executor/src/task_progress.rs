//! Prints the state of the tasks of a job.

use std::collections::BTreeSet;

use rtf_cluster::{Job, JobState};
use rtf_report::escape;
use rtf_run::diagnostics::count;
use rtf_run::terminal;

/// Prints the state of the tasks when it has changed.
pub struct TaskProgress {
    job: Job,
    /// The number of all tasks.
    all: usize,
    last: String,
    /// The notices that were printed.
    notices: BTreeSet<String>,
}

impl TaskProgress {
    /// Nothing is printed yet.
    pub fn new(job: &Job, all: usize) -> Self {
        Self { job: job.clone(), all, last: String::new(), notices: BTreeSet::new() }
    }

    /// Prints a line, which ends with `more`, if something has changed.
    pub fn print(&mut self, state: &JobState, more: &str) {
        let job = &self.job;
        for notice in &state.notices {
            if self.notices.insert(notice.clone()) {
                terminal::notice(format!("{job}: {}", escape::line(notice)));
            }
        }
        let tasks = &state.tasks;
        let waiting = tasks.iter().filter(|task| task.is_waiting).count();
        let (running, ended) = (tasks.len() - waiting, self.all.saturating_sub(tasks.len()));
        let all = count(self.all, "task");
        let line = format!("{ended} of {all} ended, {running} running, {waiting} waiting{more}");
        if line != self.last {
            terminal::notice(format!("{job}: {line}"));
            self.last = line;
        }
    }
}
