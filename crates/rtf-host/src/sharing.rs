//! A host that several tests share: see "Shared hosts" in `spec/protocol.md`.

use std::io;
use std::os::fd::OwnedFd;

use rustix::io::Errno;
use rustix::process::{WaitId, WaitIdOptions};

use crate::unix;

/// What tells one test from the next.
#[derive(Debug)]
pub(crate) struct Sharing {
    /// The outputs as the runner gave them, whatever a plug-in makes of its own.
    outputs: [OwnedFd; 2],
}

impl Sharing {
    /// Called before the first plug-in is loaded.
    pub(crate) fn begin() -> io::Result<Self> {
        let stdout = rustix::io::fcntl_dupfd_cloexec(rustix::stdio::stdout(), 3)?;
        let stderr = rustix::io::fcntl_dupfd_cloexec(rustix::stdio::stderr(), 3)?;
        // What a test's process leaves comes here and not to the runner, so that
        // it is known whose it is.
        rustix::process::set_child_subreaper(Some(rustix::process::getpid()))?;
        Ok(Self { outputs: [stdout, stderr] })
    }

    /// Ends what the test has printed, if the next one may begin.
    pub(crate) fn stay(&self, mark: &str) -> bool {
        unix::flush_output();
        !has_children() && self.outputs.iter().all(|output| write(output, mark.as_bytes()).is_ok())
    }
}

/// Whether there are processes that the test left. Those that have ended are
/// taken in.
fn has_children() -> bool {
    let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG;
    loop {
        match rustix::process::waitid(WaitId::All, options) {
            Ok(Some(_)) | Err(Errno::INTR) => {}
            Ok(None) => return true,
            Err(_) => return false,
        }
    }
}

fn write(output: &OwnedFd, mut bytes: &[u8]) -> io::Result<()> {
    while !bytes.is_empty() {
        match rustix::io::write(output, bytes) {
            Ok(written) => bytes = &bytes[written..],
            Err(Errno::INTR) => {}
            // A plug-in may have made it non-blocking; the runner reads.
            Err(Errno::AGAIN) => std::thread::sleep(std::time::Duration::from_millis(1)),
            Err(error) => return Err(error.into()),
        }
    }
    Ok(())
}
