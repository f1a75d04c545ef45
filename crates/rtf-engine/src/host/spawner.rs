//! One thread that starts every process.
//!
//! Starting a process blocks until the kernel has executed it, and a channel's
//! descriptor must be inheritable for just that moment: both are reasons for a
//! single place. `posix_spawn` is used (no code runs between fork and exec), so
//! the time does not grow with the runner's memory.

use std::io::{self, Write};
use std::os::fd::{AsRawFd, OwnedFd};
use std::path::PathBuf;
use std::process::Stdio;

use rtf_model::ExitStatus;
use rtf_model::protocol::CHANNEL_VARIABLE;
use tokio::net::UnixStream;
use tokio::process::{Child, ChildStderr, ChildStdout, Command};
use tokio::sync::oneshot;

use super::{tree, unix};
use crate::guard::gate;

/// Which outputs of a process are captured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Streams {
    /// Both.
    #[default]
    Both,
    /// Standard output; standard error is thrown away.
    StdoutOnly,
    /// None; both are thrown away.
    None,
}

/// What to start. Each process is the leader of a group of its own.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SpawnRequest {
    /// The program and its arguments.
    pub command: Vec<String>,
    /// Environment variables beside the runner's own; later ones win.
    pub env: Vec<(String, String)>,
    /// The working folder; the runner's own when `None`.
    pub folder: Option<PathBuf>,
    /// Whether it gets a channel, and what is written there at once.
    pub channel: Option<Vec<u8>>,
    /// What is captured.
    pub streams: Streams,
}

/// A process that was started.
#[derive(Debug)]
pub struct Process {
    /// Its id, and that of its group.
    pub pid: i32,
    /// The runner's end of its channel.
    pub channel: Option<UnixStream>,
    /// Its standard output.
    pub stdout: Option<ChildStdout>,
    /// Its standard error.
    pub stderr: Option<ChildStderr>,
    /// Its end.
    pub end: End,
}

/// The end of a process, to be waited for.
#[derive(Debug)]
pub struct End {
    pid: i32,
    child: Child,
}

impl End {
    /// Waits for the end. May be dropped and called again.
    ///
    /// # Errors
    /// The kernel does not tell.
    pub async fn wait(&mut self) -> io::Result<ExitStatus> {
        let status = self.child.wait().await?;
        tree::remove_own_child(self.pid);
        Ok(unix::exit_status(status))
    }
}

type Job = (SpawnRequest, oneshot::Sender<io::Result<Process>>);

/// A handle to the thread that starts processes.
#[derive(Clone, Debug)]
pub struct Spawner {
    jobs: std::sync::mpsc::Sender<Job>,
}

impl Spawner {
    /// Starts the thread. It ends with the last handle.
    ///
    /// # Errors
    /// The thread cannot be started.
    ///
    /// # Panics
    /// Outside of a tokio runtime.
    pub fn start() -> io::Result<Self> {
        let (jobs, queue) = std::sync::mpsc::channel::<Job>();
        let runtime = tokio::runtime::Handle::current();
        std::thread::Builder::new().name("rtf-spawner".to_owned()).spawn(move || {
            let _entered = runtime.enter();
            for (request, answer) in queue {
                // The asker may be gone: then the process is killed by its drop.
                let _ = answer.send(spawn(&request));
            }
        })?;
        Ok(Self { jobs })
    }

    /// Starts a process.
    ///
    /// # Errors
    /// The program cannot be executed, or a resource is used up.
    pub async fn spawn(&self, request: SpawnRequest) -> io::Result<Process> {
        Self::started(self.begin(request)).await
    }

    /// Asks for the start of a process, without waiting for it.
    #[must_use]
    pub fn begin(&self, request: SpawnRequest) -> oneshot::Receiver<io::Result<Process>> {
        let (answer, started) = oneshot::channel();
        // When the thread is gone, so is the other end of the answer.
        let _ = self.jobs.send((request, answer));
        started
    }

    /// Waits for what [`Spawner::begin`] asked for.
    ///
    /// # Errors
    /// As for [`Spawner::spawn`].
    pub async fn started(answer: oneshot::Receiver<io::Result<Process>>) -> io::Result<Process> {
        let gone = |_| io::Error::other("the thread that starts processes is gone");
        answer.await.map_err(gone)?
    }
}

fn spawn(request: &SpawnRequest) -> io::Result<Process> {
    let Some((program, arguments)) = request.command.split_first() else {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "an empty command"));
    };
    let mut command = Command::new(program);
    command.args(arguments).envs(request.env.iter().map(|(name, value)| (name, value)));
    command.stdin(Stdio::null()).process_group(0).kill_on_drop(true);
    let (stdout, stderr) = match request.streams {
        Streams::Both => (Stdio::piped(), Stdio::piped()),
        Streams::StdoutOnly => (Stdio::piped(), Stdio::null()),
        Streams::None => (Stdio::null(), Stdio::null()),
    };
    command.stdout(stdout).stderr(stderr);
    if let Some(folder) = &request.folder {
        command.current_dir(folder);
    }
    let mut channel = None;
    let mut theirs = None;
    if let Some(greeting) = &request.channel {
        let (ours, host) = unix::channel_pair()?;
        // It is short: it fits into the socket's buffer before anybody reads.
        (&ours).write_all(greeting)?;
        ours.set_nonblocking(true)?;
        channel = Some(UnixStream::from_std(ours)?);
        if gate::is_behind(&request.command) {
            command.stdin(OwnedFd::from(host));
        } else {
            unix::let_inherit(&host)?;
            command.env(CHANNEL_VARIABLE, format!("fd:{}", host.as_raw_fd()));
            theirs = Some(host);
        }
    }
    let pid_of = |child: &io::Result<Child>| i32::try_from(child.as_ref().ok()?.id()?).ok();
    let child = tree::start_own_child(|| command.spawn(), pid_of);
    // From here on nobody but the new process has the other end.
    drop(theirs);
    let mut child = child?;
    let pid = child.id().and_then(|pid| i32::try_from(pid).ok()).unwrap_or_default();
    let (stdout, stderr) = (child.stdout.take(), child.stderr.take());
    Ok(Process { pid, channel, stdout, stderr, end: End { pid, child } })
}
