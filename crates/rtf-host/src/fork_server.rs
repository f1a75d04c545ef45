//! A host that starts once and forks a host for each request: see "Forking hosts" in
//! `spec/protocol.md`.

mod unix;

use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;

use rtf_model::protocol::{FORK_SERVER_VARIABLE, ForkReply, ForkRequest};

use self::unix::{Forked, InitialVariable};
use crate::session::Session;

/// The size limit of a request.
const PACKET_BYTES: usize = 64 * 1024;

/// Why a process cannot be a fork server.
#[derive(Debug, thiserror::Error)]
pub enum ForkError {
    /// The variable does not name a descriptor.
    #[error("`{FORK_SERVER_VARIABLE}` does not begin with `fd:N`")]
    Malformed,
    /// The socket, or the kernel, refuses.
    #[error("cannot serve forks")]
    System(#[from] std::io::Error),
}

/// A fork server before its first fork.
#[derive(Debug)]
pub(crate) struct ForkServer {
    socket: OwnedFd,
    variable: InitialVariable,
    thread: unix::MainThread,
}

impl ForkServer {
    /// The server, if the runner started this process as one. Called while the process has
    /// one thread.
    pub(crate) fn open() -> Result<Option<Self>, ForkError> {
        let Some((value, variable)) = InitialVariable::take(FORK_SERVER_VARIABLE) else {
            return Ok(None);
        };
        let fd = value.split_whitespace().next().and_then(|word| word.strip_prefix("fd:"));
        let fd = fd.and_then(|number| number.parse().ok()).ok_or(ForkError::Malformed)?;
        let socket = unix::take_descriptor(fd)?;
        Ok(Some(Self { socket, variable, thread: unix::MainThread::read()? }))
    }

    /// Serves until the runner closes the socket, and returns `None`. In each forked
    /// process it returns the session with the runner.
    pub(crate) fn serve(self) -> Result<Option<Session>, ForkError> {
        let mut packet = vec![0; PACKET_BYTES];
        loop {
            let (length, descriptors) = unix::receive(&self.socket, &mut packet)?;
            if length == 0 {
                return Ok(None);
            }
            let reply = match parse(&packet[..length], descriptors) {
                Ok((request, [channel, stdout, stderr])) => match self.thread.fork() {
                    Ok(Forked::Child) => {
                        drop(self.socket);
                        unix::become_host(&request, &self.variable, &stdout, &stderr)?;
                        return Ok(Some(Session::over(UnixStream::from(channel))));
                    }
                    Ok(Forked::Parent(pid)) => ForkReply::Pid(pid),
                    Err(error) => ForkReply::Error(error.to_string()),
                },
                Err(problem) => ForkReply::Error(problem),
            };
            let reply = serde_json::to_vec(&reply).map_err(std::io::Error::from)?;
            unix::send_packet(&self.socket, &reply)?;
        }
    }
}

fn parse(packet: &[u8], descriptors: Vec<OwnedFd>) -> Result<(ForkRequest, [OwnedFd; 3]), String> {
    let request = serde_json::from_slice(packet).map_err(|error| error.to_string())?;
    let mismatch = |got: Vec<OwnedFd>| format!("got {} descriptors, expected 3", got.len());
    Ok((request, descriptors.try_into().map_err(mismatch)?))
}
