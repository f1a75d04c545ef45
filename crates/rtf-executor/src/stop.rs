//! Stops the tasks of a job: first with tear-downs, then without, then by the scheduler itself.

use std::collections::BTreeSet;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rtf_cluster::{ClusterError, Job, TaskState};
use rtf_engine::guard::StopRequests;
use rtf_run::terminal;

/// The file that exists when the user has cancelled the tasks.
pub const CANCELLED: &str = "cancelled";

/// How much longer than their limit tasks may take to stop.
pub const STOP_GRACE: Duration = Duration::from_secs(30);

/// The requests of the user to stop.
pub struct Stop {
    job: Job,
    /// The directory with the mark of cancelled tasks.
    dir: PathBuf,
    /// How long tasks may take to stop.
    limit: Duration,
    requests: StopRequests,
    signal: Option<i32>,
    first_at: Option<Instant>,
    /// The tasks that got SIGTERM after the last request.
    terminated: BTreeSet<u32>,
    is_cancelled: bool,
}

impl Stop {
    /// Nothing is stopped yet. The tasks may take `shutdown_timeout` to stop.
    pub fn new(job: &Job, dir: &Path, shutdown_timeout: Duration) -> Self {
        Self {
            job: job.clone(),
            dir: dir.to_owned(),
            limit: shutdown_timeout + STOP_GRACE,
            requests: StopRequests::default(),
            signal: None,
            first_at: None,
            terminated: BTreeSet::new(),
            is_cancelled: false,
        }
    }

    /// The first signal.
    pub fn signal(&self) -> Option<i32> {
        self.signal
    }

    /// Records a signal.
    pub async fn request(&mut self, signal: i32) {
        if !self.requests.record(Instant::now()) {
            return;
        }
        self.terminated.clear();
        if self.signal.is_none() {
            self.signal = Some(signal);
            self.first_at = Some(Instant::now());
            terminal::notice(format!("{}: stopping", self.job));
            if let Err(error) = File::create(self.dir.join(CANCELLED)) {
                terminal::notice(format!("warning: cannot mark the tasks as cancelled: {error}"));
            }
        }
        if self.requests.count() > 2 {
            self.cancel().await;
        }
    }

    /// Stops the tasks that have not been stopped since the last request, also those that have
    /// just started.
    pub async fn stop_tasks(&mut self, tasks: &[TaskState]) {
        let Some(first_at) = self.first_at else { return };
        if first_at.elapsed() > self.limit {
            self.cancel().await;
        }
        if tasks.iter().any(|task| task.is_waiting) {
            report(self.job.cancel_waiting().await);
        }
        let running = tasks.iter().filter(|task| !task.is_waiting).map(|task| task.number);
        let new: Vec<u32> = running.filter(|number| self.terminated.insert(*number)).collect();
        if !new.is_empty() && !self.is_cancelled {
            report(self.job.terminate(&new, self.requests.count() > 1).await);
        }
    }

    async fn cancel(&mut self) {
        if !std::mem::replace(&mut self.is_cancelled, true) {
            report(self.job.cancel().await);
        }
    }
}

/// A task may have ended before the command.
fn report(result: Result<(), ClusterError>) {
    if let Err(error) = result {
        terminal::notice(format!("warning: {error}"));
    }
}
