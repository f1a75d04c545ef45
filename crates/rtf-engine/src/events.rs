//! Assigns numbers and times to the events of a run.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use rtf_model::{Event, EventKind, Micros, Source};

/// Receives the events of a run.
pub trait EventSink: Send + Sync + std::fmt::Debug {
    /// Must not block.
    fn emit(&self, event: Event);

    /// Approximately how many bytes of a source's events wait to be reported.
    fn backlog(&self, source: Source) -> usize {
        let _ = source;
        0
    }
}

/// The source of all events of a run.
#[derive(Debug)]
pub struct Events {
    start: Instant,
    token: String,
    next: Mutex<u64>,
    sink: Arc<dyn EventSink>,
}

impl Events {
    /// Starts the run's clock. `token` is unique on this machine.
    pub fn new(token: String, sink: Arc<dyn EventSink>) -> Self {
        Self { start: Instant::now(), token, next: Mutex::new(0), sink }
    }

    /// When the run started.
    pub fn start(&self) -> Instant {
        self.start
    }

    /// The time since the run started.
    pub fn now(&self) -> Duration {
        self.start.elapsed()
    }

    /// Returns the token that identifies the processes of this run.
    pub fn run_token(&self) -> &str {
        &self.token
    }

    pub fn emit(&self, kind: EventKind) {
        // The lock keeps numbers, times and the order of the sink consistent.
        let mut next = self.next.lock().unwrap_or_else(PoisonError::into_inner);
        let event = Event { seq: *next, at: Micros::from(self.now()), kind };
        *next += 1;
        self.sink.emit(event);
    }
}
