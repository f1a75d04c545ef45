//! Queues lines for a process that may not read its channel at the moment.

use rustix::net::{Shutdown, shutdown};
use tokio::net::UnixStream;

#[derive(Debug, Default)]
pub(super) struct WriteQueue {
    bytes: Vec<u8>,
    written: usize,
    /// Shut the channel down for writing when the queue is empty.
    is_closing: bool,
}

impl WriteQueue {
    /// Adds a line, with its end.
    pub(super) fn push(&mut self, line: &[u8]) {
        if !self.is_closing {
            self.bytes.extend_from_slice(line);
        }
    }

    /// Shuts the channel down for writing after the queued lines.
    pub(super) fn close(&mut self) {
        self.is_closing = true;
    }

    /// Whether [`WriteQueue::write`] has something to do.
    pub(super) fn has_work(&self) -> bool {
        self.is_closing || !self.bytes.is_empty()
    }

    /// Writes the queue. Cancel safe. Never returns without a channel.
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
        if std::mem::take(&mut self.is_closing) {
            // Fails if the process has ended.
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
    use crate::unix::channel_pair;

    #[tokio::test]
    async fn a_partially_written_line_is_completed_before_the_next() {
        let (ours, mut theirs) = channel_pair().unwrap();
        ours.set_nonblocking(true).unwrap();
        let ours = Some(UnixStream::from_std(ours).unwrap());
        let (first, second) = ([vec![b'a'; 1 << 20], vec![b'\n']].concat(), b"second\n".to_vec());
        let mut outgoing = WriteQueue::default();
        outgoing.push(&first);
        // The process does not read: the write is cancelled after a part.
        let cancelled = tokio::time::timeout(Duration::from_millis(50), outgoing.write(&ours));
        assert!(cancelled.await.is_err());
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
