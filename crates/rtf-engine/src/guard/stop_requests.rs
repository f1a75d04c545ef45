//! Converts signals to requests to end the run.
//!
//! `timeout`, a shell and a logout each send several signals for one purpose. So all
//! signals within [`WINDOW`] of a request belong to it; a later signal is the next request.
//! The guard, which forwards requests, and the runner, which may receive other signals,
//! both follow this rule.

use std::time::{Duration, Instant};

/// The time after a request in which signals belong to it.
pub const WINDOW: Duration = Duration::from_millis(500);

#[derive(Debug, Default)]
pub struct StopRequests {
    last: Option<Instant>,
    count: u32,
}

impl StopRequests {
    /// Records a signal. Returns whether it is a new request.
    pub fn record(&mut self, at: Instant) -> bool {
        let same = self.last.is_some_and(|last| at.saturating_duration_since(last) < WINDOW);
        if !same {
            self.last = Some(at);
            self.count = self.count.saturating_add(1);
        }
        !same
    }

    pub fn count(&self) -> u32 {
        self.count
    }

    /// Lowers the number to `limit`: the runner did not handle the others.
    pub fn lower(&mut self, limit: u32) {
        self.count = self.count.min(limit);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number of requests after signals at these times, in milliseconds.
    fn count(times: &[u64]) -> u32 {
        let (start, mut requests) = (Instant::now(), StopRequests::default());
        for time in times {
            requests.record(start + Duration::from_millis(*time));
        }
        requests.count()
    }

    #[test]
    fn signals_within_the_window_of_a_request_are_that_request() {
        assert_eq!(count(&[]), 0);
        assert_eq!(count(&[0, 0, 1, 499]), 1);
        assert_eq!(count(&[0, 500]), 2);
        // The window starts with the request, not with each of its signals.
        assert_eq!(count(&[0, 300, 600, 900]), 2);
        assert_eq!(count(&[0, 600, 1200]), 3);
    }
}
