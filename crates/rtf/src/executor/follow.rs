//! Follows the tasks of a job until none is left, and stops them on signals.

use std::time::Duration;

use rtf_engine::signal::SignalListener;

use super::cluster::{ClusterError, Job};
use super::progress::Progress;
use super::stop::Stop;
use super::submission::Submission;
use crate::error::Failure;
use crate::terminal;

/// How often the scheduler is asked for the tasks.
pub const POLL_INTERVAL: Duration = Duration::from_secs(2);

/// Follows a job; returns the first signal that stopped it.
pub async fn follow(
    job: &Job,
    submission: &Submission,
    shutdown_timeout: Duration,
) -> Result<Option<i32>, Failure> {
    let mut signals = SignalListener::install().map_err(Failure::internal)?;
    let mut stop = Stop::new(job, &submission.dir, shutdown_timeout);
    let mut progress = Progress::new(job, submission);
    let mut interval = tokio::time::interval(POLL_INTERVAL);
    let mut is_warned = false;
    progress.print_start();
    loop {
        tokio::select! {
            biased;
            (number, _) = signals.next() => stop.request(number).await,
            _ = interval.tick() => {}
        }
        let state = match job.state().await {
            Ok(state) => state,
            Err(error) => {
                warn_once(&mut is_warned, &error);
                continue;
            }
        };
        is_warned = false;
        stop.stop_tasks(&state.tasks).await;
        progress.print(&state);
        if state.tasks.is_empty() {
            return Ok(stop.signal());
        }
    }
}

/// Warns that a command of the scheduler failed, which is tried again.
pub fn warn_once(is_warned: &mut bool, error: &ClusterError) {
    if !std::mem::replace(is_warned, true) {
        terminal::notice(format!("warning: {error}; trying again"));
    }
}
