//! Follows the tasks of a job until none is left, and stops them on signals.

use std::time::{Duration, Instant};

use rtf_cluster::{ClusterError, Job};
use rtf_engine::signal::SignalListener;
use rtf_run::error::Failure;
use rtf_run::terminal;

use crate::progress::Progress;
use crate::stop::Stop;
use crate::submission::Submission;

/// How often the scheduler is asked for the tasks, at most.
const POLL_INTERVAL: Duration = Duration::from_secs(2);

/// The pause after an answer, in multiples of the time that it took: `kubectl` needs most of a
/// second of a processor for 1000 tasks.
const PAUSE_FACTOR: u32 = 9;

/// When the scheduler is asked for the tasks.
#[derive(Clone, Copy, Debug)]
pub struct PollTimer(Instant);

impl PollTimer {
    /// It is asked now.
    pub fn now() -> Self {
        Self(Instant::now())
    }

    /// It has answered, and was asked at `begin`.
    pub fn after(begin: Instant) -> Self {
        let now = Instant::now();
        Self(now + POLL_INTERVAL.max((now - begin) * PAUSE_FACTOR))
    }

    /// Whether it should be asked.
    pub fn is_due(self) -> bool {
        Instant::now() >= self.0
    }
}

/// Follows a job; returns the first signal that stopped it.
pub async fn follow(
    job: &Job,
    submission: &Submission,
    shutdown_timeout: Duration,
) -> Result<Option<i32>, Failure> {
    let mut signals = SignalListener::install().map_err(Failure::internal)?;
    let mut stop = Stop::new(job, &submission.dir, shutdown_timeout);
    let mut progress = Progress::new(job, submission);
    let mut timer = PollTimer::now();
    let mut is_warned = false;
    progress.print_start();
    loop {
        tokio::select! {
            biased;
            (number, _) = signals.next() => stop.request(number).await,
            () = tokio::time::sleep_until(timer.0.into()) => {}
        }
        let begin = Instant::now();
        let state = job.state().await;
        timer = PollTimer::after(begin);
        let state = match state {
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
