//! Lines for a process that may not read them now: each is written whole, after those
//! before it, whenever there is room.

use rustix::net::{Shutdown, shutdown};
use tokio::net::UnixStream;

/// What waits to be written.
#[derive(Debug, Default)]
pub(super) struct Outgoing {
    bytes: Vec<u8>,
    written: usize,
    /// Nothing follows: the channel is closed for writing when all is written.
    is_last: bool,
}

impl Outgoing {
    /// Adds a line, with its end.
    pub(super) fn push(&mut self, line: &[u8]) {
        if !self.is_last {
            self.bytes.extend_from_slice(line);
        }
    }

    /// Closes the channel for writing after what waits.
    pub(super) fn close(&mut self) {
        self.is_last = true;
    }

    /// Whether there is something to do.
    pub(super) fn has_work(&self) -> bool {
        self.is_last || !self.bytes.is_empty()
    }

    /// Writes some of what waits. May be dropped and called again. Does not return when
    /// nothing can ever be written: the end of the process is noticed by others.
    pub(super) async fn write(&mut self, channel: &Option<UnixStream>) {
        let Some(channel) = channel else { return std::future::pending().await };
        while self.written < self.bytes.len() {
            if channel.writable().await.is_err() {
                return self.discard();
            }
            match channel.try_write(&self.bytes[self.written..]) {
                Ok(written) => self.written += written,
                Err(error) if error.kind() == std::io::ErrorKind::WouldBlock => {}
                Err(_) => return self.discard(),
            }
        }
        self.discard();
        if std::mem::take(&mut self.is_last) {
            // Nobody may be there any more.
            let _ = shutdown(channel, Shutdown::Write);
        }
    }

    fn discard(&mut self) {
        self.bytes.clear();
        self.written = 0;
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;
    use std::time::Duration;

    use super::*;
    use crate::host::unix::channel_pair;

    #[tokio::test]
    async fn a_line_that_could_not_be_written_at_once_is_written_whole_before_the_next() {
        let (ours, mut theirs) = channel_pair().unwrap();
        ours.set_nonblocking(true).unwrap();
        let ours = Some(UnixStream::from_std(ours).unwrap());
        let (first, second) = ([vec![b'a'; 1 << 20], vec![b'\n']].concat(), b"second\n".to_vec());
        let mut outgoing = Outgoing::default();
        outgoing.push(&first);
        // Nobody reads: it is given up in the middle.
        let given_up = tokio::time::timeout(Duration::from_millis(50), outgoing.write(&ours));
        assert!(given_up.await.is_err());
        outgoing.push(&second);
        outgoing.close();
        let reader = std::thread::spawn(move || {
            let mut read = Vec::new();
            theirs.read_to_end(&mut read).unwrap();
            read
        });
        outgoing.write(&ours).await;
        assert!(!outgoing.has_work());
        assert!(reader.join().unwrap() == [first, second].concat());
    }
}
