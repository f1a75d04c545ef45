//! A started process and its end.

use std::io;
use std::os::fd::{AsFd, OwnedFd};

use rtf_model::ExitStatus;
use tokio::io::unix::AsyncFd;
use tokio::net::UnixStream;
use tokio::process::{ChildStderr, ChildStdout};

use crate::foreground::Foreground;
use crate::{tree, unix};

#[derive(Debug)]
pub struct StartedProcess {
    /// Its id, and that of its group.
    pub pid: i32,
    /// The runner's end of its channel.
    pub channel: Option<UnixStream>,
    pub stdout: Option<ChildStdout>,
    pub stderr: Option<ChildStderr>,
    /// The foreground of the terminal, if it has it.
    pub foreground: Option<Foreground>,
    pub end: ProcessEnd,
}

/// Waits for the end of a process. The process is killed on drop.
#[derive(Debug)]
pub struct ProcessEnd {
    pid: i32,
    process: AsyncFd<OwnedFd>,
}

impl ProcessEnd {
    /// The end of a child of this process, which is killed on errors.
    pub(crate) fn open(pid: i32) -> io::Result<Self> {
        match unix::open_process(pid) {
            Ok(process) => Ok(Self { pid, process }),
            Err(error) => {
                tree::kill_tree(pid);
                unix::await_end(pid);
                tree::remove_own_child(pid);
                Err(error)
            }
        }
    }

    /// Waits for the end. Cancel safe.
    ///
    /// # Errors
    /// The kernel does not report the status.
    pub async fn wait(&mut self) -> io::Result<ExitStatus> {
        let status = loop {
            let mut ready = self.process.readable().await?;
            match unix::take_status(self.process.as_fd())? {
                Some(status) => break status,
                None => ready.clear_ready(),
            }
        };
        tree::remove_own_child(self.pid);
        Ok(status)
    }
}

impl Drop for ProcessEnd {
    /// Kills an abandoned process.
    fn drop(&mut self) {
        if tree::is_own_child(self.pid) {
            tree::kill_tree(self.pid);
            let _ = unix::take_status(self.process.as_fd());
        }
    }
}
