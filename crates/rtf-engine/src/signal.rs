//! Signals that end a run: the first asks, the second insists, the third kills.
//!
//! They come through the [`crate::guard`], whose own death counts as one.

use std::io;
use std::time::Duration;

use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::sync::watch;

use crate::guard::Link;
use crate::host::tree;
use crate::run::{Stop, StopLevel};

/// The signals that end a run, by number and name.
const ENDING: [(i32, &str); 3] = [(2, "SIGINT"), (15, "SIGTERM"), (1, "SIGHUP")];

/// Turns signals, and the guard's death, into stop requests, for as long as it
/// is polled:
///
/// 1. stop the test, tear down, report, all within `limit`;
/// 2. kill everything, report;
/// 3. kill everything and return the signal's number: the process should end.
///
/// # Errors
/// A signal's handler cannot be installed.
pub async fn forward(
    stops: &watch::Sender<Option<Stop>>,
    guard: &Link,
    limit: Duration,
) -> io::Result<i32> {
    let mut signals = Signals::install()?;
    let died = async {
        guard.guard_died().await;
        "the guard died"
    };
    let mut died = Box::pin(died);
    let mut alive = true;
    for level in [StopLevel::TearDown, StopLevel::Kill] {
        let reason = tokio::select! {
            (_, name) = signals.next() => name,
            reason = &mut died, if alive => {
                alive = false;
                reason
            }
        };
        stops.send_replace(Some(Stop { level, reason: reason.to_owned(), limit }));
    }
    let (number, _) = signals.next().await;
    let _ = tree::kill_everything();
    Ok(number)
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
