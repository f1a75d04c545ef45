//! Reading what a process says and prints, and waiting for its end.

use std::os::fd::AsFd;

use rtf_model::ExitStatus;
use tokio::io::{AsyncRead, AsyncReadExt, Interest};
use tokio::net::UnixStream;

use crate::host::spawner::End;
use crate::host::unix::{self, Sender};

/// How much is read at once: what a pipe holds at most.
const READ_BYTES: usize = 64 * 1024;

/// What was read last from each stream.
pub(super) struct Buffers {
    pub(super) channel: Received,
    pub(super) stdout: Vec<u8>,
    pub(super) stderr: Vec<u8>,
}

impl Buffers {
    pub(super) fn new() -> Self {
        let empty = || Vec::with_capacity(READ_BYTES);
        let channel = Received { bytes: vec![0; READ_BYTES], length: 0, sender: Sender(0) };
        Self { channel, stdout: empty(), stderr: empty() }
    }
}

/// What one process wrote to a channel.
pub(super) struct Received {
    bytes: Vec<u8>,
    length: usize,
    sender: Sender,
}

impl Received {
    /// Which process, and what; nothing at the end of the channel.
    pub(super) fn get(&self) -> (Sender, &[u8]) {
        (self.sender, &self.bytes[..self.length])
    }
}

/// As [`read`], of a channel.
pub(super) async fn receive(channel: &Option<UnixStream>, received: &mut Received) {
    let Some(channel) = channel else { return std::future::pending().await };
    let bytes = &mut received.bytes;
    let next = || unix::receive_from(channel.as_fd(), bytes);
    (received.length, received.sender) =
        channel.async_io(Interest::READABLE, next).await.unwrap_or((0, Sender(0)));
}

/// Replaces the buffer by what comes next from a stream; by nothing at its end,
/// and an error counts as the end. A stream that is closed never answers.
pub(super) async fn read<R: AsyncRead + Unpin>(stream: &mut Option<R>, buffer: &mut Vec<u8>) {
    match stream {
        Some(stream) => {
            buffer.clear();
            let _ = stream.read_buf(buffer).await;
        }
        None => std::future::pending().await,
    }
}

pub(super) async fn wait(end: &mut End) -> ExitStatus {
    end.wait().await.unwrap_or(ExitStatus::Code(-1))
}
