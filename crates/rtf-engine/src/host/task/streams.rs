//! Reading what a process says and prints, and waiting for its end.

use rtf_model::ExitStatus;
use tokio::io::{AsyncRead, AsyncReadExt};

use crate::host::spawner::End;

/// How much is read at once: what a pipe holds at most.
const READ_BYTES: usize = 64 * 1024;

/// What was read last from each stream.
pub(super) struct Buffers {
    pub(super) channel: Vec<u8>,
    pub(super) stdout: Vec<u8>,
    pub(super) stderr: Vec<u8>,
}

impl Buffers {
    pub(super) fn new() -> Self {
        let empty = || Vec::with_capacity(READ_BYTES);
        Self { channel: empty(), stdout: empty(), stderr: empty() }
    }
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
