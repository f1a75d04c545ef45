//! Measures how long the runner has been silent.

use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use rustix::net::{RecvFlags, recv};

pub(super) const CHECK_INTERVAL: Duration = Duration::from_secs(1);

/// The guard's end of the heartbeat socket. The runner notices when it is closed.
#[derive(Debug)]
pub(super) struct Heartbeat {
    socket: UnixStream,
    is_closed: bool,
    checked_at: Instant,
    silence: Duration,
}

impl Heartbeat {
    pub fn new(socket: UnixStream) -> Self {
        Self { socket, is_closed: false, checked_at: Instant::now(), silence: Duration::ZERO }
    }

    /// Returns the socket, unless the runner has closed it.
    pub fn socket(&self) -> Option<&UnixStream> {
        (!self.is_closed).then_some(&self.socket)
    }

    /// For how long the runner has been silent. The time in which this process was suspended
    /// does not count.
    pub fn silence(&self) -> Duration {
        self.silence
    }

    /// Receives heartbeats. `is_alive` means that the runner has shown otherwise that it is
    /// alive.
    pub fn receive(&mut self, mut is_alive: bool) {
        let mut bytes = [0; 1024];
        while !self.is_closed {
            match recv(&self.socket, &mut bytes[..], RecvFlags::DONTWAIT) {
                Ok((0, _)) => self.is_closed = true,
                Ok(_) => is_alive = true,
                Err(rustix::io::Errno::INTR) => {}
                Err(rustix::io::Errno::AGAIN) => break,
                Err(_) => self.is_closed = true,
            }
        }
        let now = Instant::now();
        let elapsed = now.saturating_duration_since(self.checked_at).min(2 * CHECK_INTERVAL);
        self.checked_at = now;
        self.silence = if is_alive { Duration::ZERO } else { self.silence + elapsed };
    }
}
