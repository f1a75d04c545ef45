//! A started process and its end.

use std::io;
use std::os::fd::{AsFd, OwnedFd};

use rtf_model::ExitStatus;
use tokio::io::unix::AsyncFd;
use tokio::net::UnixStream;
use tokio::process::{Child, ChildStderr, ChildStdout};

use crate::foreground::Foreground;
use crate::{tree, unix};

/// A started process.
#[derive(Debug)]
pub struct StartedProcess {
    /// Its id, and that of its group.
    pub pid: i32,
    /// The runner's end of its channel.
    pub channel: Option<UnixStream>,
    /// Its standard output.
    pub stdout: Option<ChildStdout>,
    /// Its standard error.
    pub stderr: Option<ChildStderr>,
    /// The foreground of the terminal, if it has it.
    pub foreground: Option<Foreground>,
    /// Its end.
    pub end: ProcessEnd,
}

/// Waits for the end of a process. The process is killed on drop.
#[derive(Debug)]
pub struct ProcessEnd {
    pid: i32,
    child: StartedChild,
}

/// Who notifies the runner of the end.
#[derive(Debug)]
pub(crate) enum StartedChild {
    /// Tokio, for an executed process.
    Executed(Child),
    /// The kernel, for a forked process.
    Forked(AsyncFd<OwnedFd>),
}

impl ProcessEnd {
    pub(crate) fn new(pid: i32, child: StartedChild) -> Self {
        Self { pid, child }
    }

    /// Waits for the end. Cancel safe.
    ///
    /// # Errors
    /// The kernel does not report the status.
    pub async fn wait(&mut self) -> io::Result<ExitStatus> {
        let status = match &mut self.child {
            StartedChild::Executed(child) => unix::exit_status(child.wait().await?),
            StartedChild::Forked(process) => loop {
                let mut ready = process.readable().await?;
                match unix::take_status(process.as_fd())? {
                    Some(status) => break status,
                    None => ready.clear_ready(),
                }
            },
        };
        tree::remove_own_child(self.pid);
        Ok(status)
    }
}

impl Drop for ProcessEnd {
    /// Kills an abandoned process, as tokio does for executed ones.
    fn drop(&mut self) {
        if let StartedChild::Forked(process) = &self.child
            && tree::is_own_child(self.pid)
        {
            tree::kill_tree(self.pid);
            let _ = unix::take_status(process.as_fd());
        }
    }
}
