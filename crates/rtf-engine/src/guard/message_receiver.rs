//! Receives the runner's messages, and keeps the state that recovery needs.

use std::collections::VecDeque;
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::net::UnixStream;
use std::time::Instant;

use rtf_process::descriptor_passing;
use rustix::net::RecvFlags;

use super::message::GuardMessage;
use super::recovery_state::RecoveryState;

const READ_BYTES: usize = 64 * 1024;

/// The guard's end of the connection.
#[derive(Debug)]
pub(super) struct MessageReceiver {
    /// `None` once the runner's end is closed.
    socket: Option<UnixStream>,
    line: Vec<u8>,
    received: VecDeque<OwnedFd>,
    pub state: RecoveryState,
}

impl MessageReceiver {
    pub fn new(socket: UnixStream) -> Self {
        let (line, received) = (Vec::new(), VecDeque::new());
        Self { socket: Some(socket), line, received, state: RecoveryState::default() }
    }

    pub fn socket(&self) -> Option<&UnixStream> {
        self.socket.as_ref()
    }

    /// Receives all available messages. Returns whether there were any.
    pub fn receive(&mut self) -> bool {
        let mut bytes = vec![0; READ_BYTES];
        let mut has_received = false;
        while let Some(socket) = &self.socket {
            let socket = socket.as_fd();
            let read = match descriptor_passing::receive(socket, &mut bytes, RecvFlags::DONTWAIT) {
                Ok((read, descriptors)) => {
                    self.received.extend(descriptors);
                    read
                }
                Err(rustix::io::Errno::AGAIN) => break,
                Err(_) => 0,
            };
            if read == 0 {
                self.socket = None;
            }
            has_received |= read > 0;
            self.apply(&bytes[..read]);
        }
        has_received
    }

    fn apply(&mut self, bytes: &[u8]) {
        for piece in bytes.split_inclusive(|byte| *byte == b'\n') {
            self.line.extend_from_slice(piece);
            if self.line.ends_with(b"\n") {
                // The runner is the same program: it sends no invalid line.
                if let Ok(message) = serde_json::from_slice::<GuardMessage>(&self.line) {
                    self.state.apply(message, &mut self.received, Instant::now());
                }
                self.line.clear();
            }
        }
    }
}
