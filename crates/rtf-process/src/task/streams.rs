//! Reads the channel and the outputs of a process, and waits for its end.

use std::os::fd::AsFd;

use rtf_model::ExitStatus;
use tokio::io::{AsyncRead, AsyncReadExt, Interest};
use tokio::net::UnixStream;

use crate::process::ProcessEnd;
use crate::unix::{self, Sender};

/// The capacity of a pipe.
const READ_BYTES: usize = 64 * 1024;

/// The bytes read last from each stream.
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

/// Bytes that one process wrote to a channel.
pub(super) struct Received {
    bytes: Vec<u8>,
    length: usize,
    sender: Sender,
}

impl Received {
    /// Returns the process and the bytes; none at the end of the channel.
    pub(super) fn get(&self) -> (Sender, &[u8]) {
        (self.sender, &self.bytes[..self.length])
    }
}

/// As [`read`], for a channel.
pub(super) async fn receive(channel: &Option<UnixStream>, received: &mut Received) {
    let Some(channel) = channel else { return std::future::pending().await };
    let bytes = &mut received.bytes;
    let next = || unix::receive_from(channel.as_fd(), bytes);
    (received.length, received.sender) =
        channel.async_io(Interest::READABLE, next).await.unwrap_or((0, Sender(0)));
}

/// Replaces the buffer by the next bytes of a stream, or empties it at the end or on an
/// error. Never returns for a closed stream.
pub(super) async fn read<R: AsyncRead + Unpin>(stream: &mut Option<R>, buffer: &mut Vec<u8>) {
    match stream {
        Some(stream) => {
            buffer.clear();
            let _ = stream.read_buf(buffer).await;
        }
        None => std::future::pending().await,
    }
}

pub(super) async fn wait(end: &mut ProcessEnd) -> ExitStatus {
    end.wait().await.unwrap_or(ExitStatus::Code(-1))
}
