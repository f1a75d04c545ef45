//! Follows the tasks of a job until none is left, and stops them on signals.

use std::collections::BTreeSet;
use std::time::{Duration, Instant};

use rtf_engine::guard::StopRequests;
use rtf_engine::signal::SignalListener;

use super::progress::Progress;
use super::slurm::{self, JobId, SlurmError, TaskState};
use super::submission::Submission;
use crate::error::Failure;
use crate::terminal;

/// How often Slurm is asked for the tasks.
const POLL_INTERVAL: Duration = Duration::from_secs(2);

/// How much longer than their own limit tasks may take to stop.
const STOP_GRACE: Duration = Duration::from_secs(30);

/// Follows a job; returns the first signal that stopped it.
pub async fn follow(
    job: &JobId,
    submission: &Submission,
    shutdown_timeout: Duration,
) -> Result<Option<i32>, Failure> {
    let mut signals = SignalListener::install().map_err(Failure::internal)?;
    let mut stop = Stop::new(job, shutdown_timeout + STOP_GRACE);
    let mut progress = Progress::new(job, submission);
    let mut interval = tokio::time::interval(POLL_INTERVAL);
    let mut is_warned = false;
    progress.print_start();
    loop {
        tokio::select! {
            biased;
            (number, _) = signals.next() => stop.request(number, submission).await,
            _ = interval.tick() => {}
        }
        let tasks = match slurm::active_tasks(job).await {
            Ok(tasks) => tasks,
            Err(error) => {
                warn_once(&mut is_warned, &error);
                continue;
            }
        };
        is_warned = false;
        stop.stop_tasks(&tasks).await;
        progress.print(&tasks);
        if tasks.is_empty() {
            return Ok(stop.signal);
        }
    }
}

fn warn_once(is_warned: &mut bool, error: &SlurmError) {
    if !std::mem::replace(is_warned, true) {
        terminal::notice(format!("warning: {error}; trying again"));
    }
}

/// The requests of the user to stop.
struct Stop<'a> {
    job: &'a JobId,
    /// How long tasks may take to stop.
    limit: Duration,
    requests: StopRequests,
    signal: Option<i32>,
    first_at: Option<Instant>,
    /// The tasks that got SIGTERM after the last request.
    terminated: BTreeSet<u32>,
    is_cancelled: bool,
}

impl<'a> Stop<'a> {
    fn new(job: &'a JobId, limit: Duration) -> Self {
        Self {
            job,
            limit,
            requests: StopRequests::default(),
            signal: None,
            first_at: None,
            terminated: BTreeSet::new(),
            is_cancelled: false,
        }
    }

    /// Records a signal.
    async fn request(&mut self, signal: i32, submission: &Submission) {
        if !self.requests.record(Instant::now()) {
            return;
        }
        self.terminated.clear();
        if self.signal.is_none() {
            self.signal = Some(signal);
            self.first_at = Some(Instant::now());
            terminal::notice(format!("slurm: job {}: stopping", self.job));
            if let Err(error) = submission.cancel() {
                terminal::notice(format!("warning: cannot mark the submission: {error}"));
            }
        }
        if self.requests.count() > 2 {
            self.cancel().await;
        }
    }

    /// Stops the tasks that have not been stopped since the last request, also those that have
    /// just started.
    async fn stop_tasks(&mut self, tasks: &[TaskState]) {
        let Some(first_at) = self.first_at else { return };
        if first_at.elapsed() > self.limit {
            self.cancel().await;
        }
        if tasks.iter().any(|task| task.is_waiting) {
            report(slurm::cancel_waiting(self.job).await);
        }
        let running = tasks.iter().filter(|task| !task.is_waiting).map(|task| task.number);
        let new: Vec<u32> = running.filter(|number| self.terminated.insert(*number)).collect();
        if !new.is_empty() && !self.is_cancelled {
            report(slurm::terminate(self.job, &new).await);
        }
    }

    async fn cancel(&mut self) {
        if !std::mem::replace(&mut self.is_cancelled, true) {
            report(slurm::cancel(self.job).await);
        }
    }
}

/// A task may have ended before the command.
fn report(result: Result<(), SlurmError>) {
    if let Err(error) = result {
        terminal::notice(format!("warning: {error}"));
    }
}
