//! How signals become requests to end the run.
//!
//! `timeout`, a shell and a logout each send several signals for one purpose.
//! So what comes within [`WINDOW`] of a request is that same request, whatever
//! its number, and a later one raises the level. The guard and the runner follow
//! this one rule, each for what reaches it: the guard passes requests on, and the
//! runner may get signals from elsewhere, too.

use std::time::{Duration, Instant};

/// Signals within this time of a request belong to it.
pub const WINDOW: Duration = Duration::from_millis(500);

/// The requests that were made until now.
#[derive(Debug, Default)]
pub struct Requests {
    last: Option<Instant>,
    made: u32,
}

impl Requests {
    /// Takes in a signal; whether it is a new request.
    pub fn take(&mut self, at: Instant) -> bool {
        let same = self.last.is_some_and(|last| at.saturating_duration_since(last) < WINDOW);
        if !same {
            self.last = Some(at);
            self.made = self.made.saturating_add(1);
        }
        !same
    }

    /// How many there are.
    #[must_use]
    pub fn made(&self) -> u32 {
        self.made
    }

    /// Lowers the count to `most`: what nobody acted upon does not count.
    pub fn lower(&mut self, most: u32) {
        self.made = self.made.min(most);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The count after signals at these times, in milliseconds.
    fn made(times: &[u64]) -> u32 {
        let (start, mut requests) = (Instant::now(), Requests::default());
        for time in times {
            requests.take(start + Duration::from_millis(*time));
        }
        requests.made()
    }

    #[test]
    fn signals_within_the_window_of_a_request_are_that_request() {
        assert_eq!(made(&[]), 0);
        assert_eq!(made(&[0, 0, 1, 499]), 1);
        assert_eq!(made(&[0, 500]), 2);
        // The window begins with the request, not with each of its signals.
        assert_eq!(made(&[0, 300, 600, 900]), 2);
        assert_eq!(made(&[0, 600, 1200]), 3);
    }
}
