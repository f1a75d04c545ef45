//! Signals that end a run: the first request asks, the second insists, the third kills.
//!
//! They come through the [`crate::guard`], whose own death counts as one.

use std::io;
use std::time::Duration;

use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::sync::watch;
use tokio::time::Instant;

use crate::guard::{BEAT, Link, Requests};
use crate::run::{Stop, StopLevel};
use rtf_process::tree;

/// The signals that end a run, by number and name.
const ENDING: [(i32, &str); 3] = [(2, "SIGINT"), (15, "SIGTERM"), (1, "SIGHUP")];

/// After the third request, the runner may take this long to write how it ended.
const LAST_GRACE: Duration = Duration::from_secs(4);

/// Turns signals, and the guard's death, into stop requests, and shows the guard
/// that this process is alive, for as long as it is polled. By [`Requests`]:
///
/// 1. stop the test, hooks, tear down, report, all within `limit`;
/// 2. kill without tear-down, hooks, report;
/// 3. kill everything, report.
///
/// Returns a signal's number when the third request did not end the run: the
/// process should end.
///
/// # Errors
/// A signal's handler cannot be installed.
pub async fn forward(
    stops: &watch::Sender<Option<Stop>>,
    guard: &Link,
    limit: Duration,
) -> io::Result<i32> {
    let mut signals = Signals::install()?;
    let mut requests = Requests::default();
    let mut beats = tokio::time::interval(BEAT);
    let mut died = Box::pin(guard.guard_died());
    let (mut alive, mut last) = (true, None);
    loop {
        let (number, reason) = tokio::select! {
            biased;
            () = until(last.map(|(at, _)| at)) => {
                let _ = tree::kill_everything();
                return Ok(last.map_or(0, |(_, number)| number));
            }
            _ = beats.tick() => {
                guard.beat();
                continue;
            }
            (number, name) = signals.next() => (number, name),
            () = &mut died, if alive => {
                alive = false;
                if requests.made() > 0 {
                    continue;
                }
                (0, "the guard died")
            }
        };
        if requests.take(std::time::Instant::now()) {
            let level = level(requests.made());
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

/// The signals that end a run, as they come to this process.
#[derive(Debug)]
pub struct Signals([Signal; 3]);

impl Signals {
    /// Takes them from now on.
    ///
    /// # Errors
    /// A signal's handler cannot be installed.
    pub fn install() -> io::Result<Self> {
        let [int, term, hup] = ENDING.map(|(number, _)| signal(SignalKind::from_raw(number)));
        Ok(Self([int?, term?, hup?]))
    }

    /// Waits for the next one: its number and its name.
    pub async fn next(&mut self) -> (i32, &'static str) {
        let [int, term, hup] = &mut self.0;
        tokio::select! {
            _ = int.recv() => ENDING[0],
            _ = term.recv() => ENDING[1],
            _ = hup.recv() => ENDING[2],
        }
    }
}

/// The exit code of a run that this signal (by name) ended: 128 + its number.
#[must_use]
pub fn exit_code(name: &str) -> Option<u8> {
    let (number, _) = ENDING.iter().find(|(_, known)| *known == name)?;
    u8::try_from(128 + number).ok()
}
