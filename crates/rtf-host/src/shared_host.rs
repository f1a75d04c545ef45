//! A host that several tests share: see "Shared hosts" in `spec/protocol.md`.

use std::io;
use std::os::fd::OwnedFd;

use rustix::io::Errno;
use rustix::process::{WaitId, WaitIdOptions};

use crate::unix;

/// Separates the output and the processes of one test from those of the next.
#[derive(Debug)]
pub(crate) struct SharedHost {
    /// The outputs as the runner opened them, even if a plug-in redirects its own.
    outputs: [OwnedFd; 2],
}

impl SharedHost {
    /// Called before the first plug-in is loaded.
    pub(crate) fn begin() -> io::Result<Self> {
        let stdout = rustix::io::fcntl_dupfd_cloexec(rustix::stdio::stdout(), 3)?;
        let stderr = rustix::io::fcntl_dupfd_cloexec(rustix::stdio::stderr(), 3)?;
        // Leftover processes of a test become children of this process, not of the runner.
        rustix::process::set_child_subreaper(Some(rustix::process::getpid()))?;
        Ok(Self { outputs: [stdout, stderr] })
    }

    /// Whether the next test may begin; if so, ends the present test's output.
    pub(crate) fn end_test(&self, end_marker: &str) -> bool {
        unix::flush_output();
        let write = |output| write(output, end_marker.as_bytes()).is_ok();
        !has_children() && self.outputs.iter().all(write)
    }
}

/// Whether the test left processes behind. Reaps those that have ended.
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
            // A plug-in may have made it non-blocking. The runner reads it.
            Err(Errno::AGAIN) => std::thread::sleep(std::time::Duration::from_millis(1)),
            Err(error) => return Err(error.into()),
        }
    }
    Ok(())
}
