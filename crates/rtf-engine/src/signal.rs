//! Signals that end a run. The [`crate::guard`] forwards them; its death counts as one.

use std::io;
use std::time::Duration;

use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::sync::watch;
use tokio::time::Instant;

use crate::control::{Stop, StopLevel};
use crate::guard::{HEARTBEAT_INTERVAL, Link, StopRequests};
use rtf_process::tree;

/// The signals that end a run: numbers and names.
const STOP_SIGNALS: [(i32, &str); 3] = [(2, "SIGINT"), (15, "SIGTERM"), (1, "SIGHUP")];

/// How long the runner may take to write its reports after the third request.
const LAST_GRACE: Duration = Duration::from_secs(4);

/// Converts signals, and the guard's death, to stop requests, and sends heartbeats while it is
/// polled. By the number of requests (see [`StopRequests`]):
///
/// 1. stop the test, run hooks, tear down, report, all within `limit`;
/// 2. kill without tear-down, run hooks, report;
/// 3. kill everything, report.
///
/// Returns a signal's number if the third request did not end the run: the process should
/// end.
///
/// # Errors
/// A handler cannot be installed.
pub async fn forward(
    stops: &watch::Sender<Option<Stop>>,
    guard: &Link,
    limit: Duration,
) -> io::Result<i32> {
    let mut signals = SignalListener::install()?;
    let mut requests = StopRequests::default();
    let mut heartbeats = tokio::time::interval(HEARTBEAT_INTERVAL);
    let mut died = Box::pin(guard.guard_died());
    let (mut is_guard_alive, mut last) = (true, None);
    loop {
        let (number, reason) = tokio::select! {
            biased;
            () = until(last.map(|(at, _)| at)) => {
                let _ = tree::kill_everything();
                return Ok(last.map_or(0, |(_, number)| number));
            }
            _ = heartbeats.tick() => {
                guard.send_heartbeat();
                continue;
            }
            (number, name) = signals.next() => (number, name),
            () = &mut died, if is_guard_alive => {
                is_guard_alive = false;
                if requests.count() > 0 {
                    continue;
                }
                (0, "the death of the guard")
            }
        };
        if requests.record(std::time::Instant::now()) {
            let level = level(requests.count());
            stops.send_replace(Some(Stop { level, reason: reason.to_owned(), limit }));
            if level == StopLevel::KillHooks && last.is_none() {
                last = Some((Instant::now() + LAST_GRACE, number));
            }
        }
    }
}

fn level(requests: u32) -> StopLevel {
    match requests {
        0 | 1 => StopLevel::TearDown,
        2 => StopLevel::Kill,
        _ => StopLevel::KillHooks,
    }
}

async fn until(moment: Option<Instant>) {
    match moment {
        Some(moment) => tokio::time::sleep_until(moment).await,
        None => std::future::pending().await,
    }
}

/// The received signals that end a run.
#[derive(Debug)]
pub struct SignalListener([Signal; 3]);

impl SignalListener {
    /// Installs the handlers.
    ///
    /// # Errors
    /// A handler cannot be installed.
    pub fn install() -> io::Result<Self> {
        let [int, term, hup] = STOP_SIGNALS.map(|(number, _)| signal(SignalKind::from_raw(number)));
        Ok(Self([int?, term?, hup?]))
    }

    /// Waits for the next signal; returns its number and name.
    pub async fn next(&mut self) -> (i32, &'static str) {
        let [int, term, hup] = &mut self.0;
        tokio::select! {
            _ = int.recv() => STOP_SIGNALS[0],
            _ = term.recv() => STOP_SIGNALS[1],
            _ = hup.recv() => STOP_SIGNALS[2],
        }
    }
}

/// Returns the exit code of a run that this signal ended: 128 + its number.
pub fn exit_code(name: &str) -> Option<u8> {
    let (number, _) = STOP_SIGNALS.iter().find(|(_, known)| *known == name)?;
    u8::try_from(128 + number).ok()
}
