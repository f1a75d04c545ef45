//! The server's own budget of connections, so that no client can use up the file
//! descriptors of the process that runs the tests.
//!
//! [`Listener`] refuses a connection at once when there is no room for it;
//! [`stream::Limited`] closes one on which nothing moves.

mod budget;
mod stream;

use std::io;
use std::net::SocketAddr;
use std::time::Duration;

use axum::extract::connect_info::Connected;
use axum_server::{AddrListener, Address};
use tokio::net::TcpListener;

pub use stream::Limited;

use budget::Budget;

/// What a client gets that there is no room for. A client that speaks TLS sees
/// its connection closed.
const REFUSAL: &[u8] = b"HTTP/1.1 503 Service Unavailable\r\nRetry-After: 5\r\n\
                         Connection: close\r\nContent-Length: 0\r\n\r\n";

/// How much of the process's descriptors all connections may use: this part.
const SHARE: u64 = 8;
/// The fewest and the most connections.
const CONNECTIONS: (u64, u64) = (16, 256);

/// How many connections there may be, and how long one may do nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    pub connections: usize,
    pub per_address: usize,
    /// How long a client may take to send the head of a request.
    pub head: Duration,
    /// How long nothing may be sent or received while an answer is under way.
    pub idle: Duration,
}

impl Limits {
    /// The limits in a process that may have this many open files.
    #[must_use]
    pub fn of_files(open_files: u64) -> Self {
        let (fewest, most) = CONNECTIONS;
        let connections = (open_files / SHARE).clamp(fewest, most);
        let connections = usize::try_from(connections).unwrap_or(usize::MAX);
        Self {
            connections,
            per_address: connections - connections / 4,
            head: Duration::from_secs(10),
            idle: Duration::from_secs(60),
        }
    }

    /// How many files may be sent at the same time.
    #[must_use]
    pub fn files(&self) -> usize {
        (self.connections / 2).max(1)
    }
}

impl Default for Limits {
    /// The limits in this process.
    fn default() -> Self {
        let limit = rustix::process::getrlimit(rustix::process::Resource::Nofile);
        Self::of_files(limit.current.unwrap_or(u64::MAX))
    }
}

/// Accepts connections within the limits, and refuses the others.
#[derive(Debug)]
pub struct Listener {
    listener: TcpListener,
    budget: Budget,
    limits: Limits,
}

impl Listener {
    /// Accepts from this socket.
    ///
    /// # Errors
    /// The socket cannot be used.
    pub fn new(listener: std::net::TcpListener, limits: Limits) -> io::Result<Self> {
        listener.set_nonblocking(true)?;
        let budget = Budget::new(limits.connections, limits.per_address);
        Ok(Self { listener: TcpListener::from_std(listener)?, budget, limits })
    }
}

/// The address of a client.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Peer(pub SocketAddr);

impl Address for Peer {
    type Stream = Limited;
    type Listener = Listener;
}

impl Connected<Peer> for Peer {
    fn connect_info(peer: Peer) -> Self {
        peer
    }
}

impl AddrListener<Limited, Peer> for Listener {
    async fn bind_to(address: Peer) -> io::Result<Self> {
        Self::new(std::net::TcpListener::bind(address.0)?, Limits::default())
    }

    async fn accept_stream(&self) -> io::Result<(Limited, Peer)> {
        loop {
            let (stream, address) = self.listener.accept().await?;
            if let Some(place) = self.budget.take(address.ip()) {
                return Ok((Limited::new(stream, place, &self.limits), Peer(address)));
            }
            // It is refused either way; the words are a courtesy.
            let _ = stream.try_write(REFUSAL);
        }
    }

    fn get_local_addr(&self) -> io::Result<Peer> {
        self.listener.local_addr().map(Peer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn most_descriptors_are_left_to_the_run() {
        for open_files in [256, 1024, 4096, 1 << 20, u64::MAX] {
            let limits = Limits::of_files(open_files);
            let used = limits.connections + limits.files();
            assert!(used as u64 <= open_files / 4, "{open_files}: {limits:?}");
            assert!(limits.per_address < limits.connections, "others have room, too");
        }
        assert!(Limits::of_files(64).connections > 6, "one browser has room in any case");
    }
}
