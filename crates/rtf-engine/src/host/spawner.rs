//! One thread that starts every process.
//!
//! Starting a process blocks until the kernel has executed it, and a channel's
//! descriptor must be inheritable for just that moment: both are reasons for a
//! single place. `posix_spawn` is used (no code runs between fork and exec), so
//! the time does not grow with the runner's memory; only a process that enters a
//! network of its suite is forked, and one that begins without a greeting when the
//! runner has another limit of descriptors than the user gave.

use std::io;
use std::os::fd::{AsFd, AsRawFd, OwnedFd};
use std::path::PathBuf;
use std::process::Stdio;

use rtf_model::ExitStatus;
use rtf_model::protocol::CHANNEL_VARIABLE;
use tokio::io::unix::AsyncFd;
use tokio::net::UnixStream;
use tokio::process::{Child, ChildStderr, ChildStdout, Command};
use tokio::sync::oneshot;

use super::fork::{Ends, ForkServers, Forks};
use super::resources::{self, Reserve};
use super::{remote, tree, unix};
use crate::guard::gate;
use crate::isolate::Network;
use crate::run::Role;

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
    /// Whether the command is a host that can be forked, and may be.
    pub forks: bool,
    /// The network that it enters; the runner's own when `None`.
    pub network: Option<Network>,
    /// What it is for; `None` for what the runner itself needs.
    pub role: Option<Role>,
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
    child: Started,
}

/// How the end is told.
#[derive(Debug)]
enum Started {
    /// By tokio, of a process that was executed.
    Executed(Child),
    /// By the kernel, of one that was forked.
    Forked(AsyncFd<OwnedFd>),
}

impl End {
    /// Waits for the end. May be dropped and called again.
    ///
    /// # Errors
    /// The kernel does not tell.
    pub async fn wait(&mut self) -> io::Result<ExitStatus> {
        let status = match &mut self.child {
            Started::Executed(child) => unix::exit_status(child.wait().await?),
            Started::Forked(process) => loop {
                let mut told = process.readable().await?;
                match unix::take_status(process.as_fd())? {
                    Some(status) => break status,
                    None => told.clear_ready(),
                }
            },
        };
        tree::remove_own_child(self.pid);
        Ok(status)
    }
}

impl Drop for End {
    /// A process that nobody waits for is not wanted. (Tokio does the same.)
    fn drop(&mut self) {
        if let Started::Forked(process) = &self.child
            && tree::is_own_child(self.pid)
        {
            tree::kill_tree(self.pid);
            let _ = unix::take_status(process.as_fd());
        }
    }
}

enum Job {
    Start(SpawnRequest, oneshot::Sender<io::Result<Process>>),
    Finish(Option<Network>, oneshot::Sender<()>),
}

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
    pub fn start(forks: Forks) -> io::Result<Self> {
        let (jobs, queue) = std::sync::mpsc::channel::<Job>();
        let runtime = tokio::runtime::Handle::current();
        std::thread::Builder::new().name("rtf-spawner".to_owned()).spawn(move || {
            let _entered = runtime.enter();
            let mut servers = ForkServers::new(forks);
            let mut reserve = Reserve::default();
            for job in queue {
                reserve.fill();
                match job {
                    Job::Start(request, answer) => {
                        let started = spawn_or_release(&request, &mut servers, &mut reserve);
                        // The asker may be gone: then the process is killed by its drop.
                        drop(answer.send(started));
                    }
                    Job::Finish(within, done) => {
                        servers.end(within.as_ref());
                        let _ = done.send(());
                    }
                }
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
        let _ = self.jobs.send(Job::Start(request, answer));
        started
    }

    /// Ends the processes that the spawner keeps for itself, all of them or those
    /// that are in a network.
    pub async fn finish(&self, within: Option<Network>) {
        let (done, finished) = oneshot::channel();
        let _ = self.jobs.send(Job::Finish(within, done));
        // When the thread is gone, so are they.
        let _ = finished.await;
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

/// Starts a process. A hook or a fixture may have the descriptors that are kept.
fn spawn_or_release(
    request: &SpawnRequest,
    servers: &mut ForkServers,
    reserve: &mut Reserve,
) -> io::Result<Process> {
    match (spawn(request, servers), request.role) {
        (Err(error), Some(role @ (Role::Hook | Role::Fixture)))
            if resources::is_exhausted(&error) =>
        {
            reserve.release(role == Role::Hook);
            spawn(request, servers)
        }
        (started, _) => started,
    }
}

fn spawn(request: &SpawnRequest, servers: &mut ForkServers) -> io::Result<Process> {
    let (mut ours, mut theirs) = (None, None);
    if request.channel.is_some() {
        let (runner, host) = unix::channel_pair()?;
        runner.set_nonblocking(true)?;
        ours = Some(UnixStream::from_std(runner)?);
        theirs = Some(OwnedFd::from(host));
    }
    let forked = match &theirs {
        Some(host) if request.forks => fork(request, host, servers)?,
        _ => None,
    };
    let process = match forked {
        // It has what its server has.
        Some(process) => process,
        None => {
            let process = execute(request, theirs)?;
            resources::limit_descriptors(process.pid);
            if matches!(request.role, Some(Role::Test | Role::Fixture)) {
                resources::make_expendable(process.pid);
            }
            process
        }
    };
    if let (Some(greeting), Some(ours)) = (&request.channel, &ours) {
        // It does nothing before. The greeting is short: it fits into the socket's
        // buffer before anybody reads. One that has ended is noticed by its exit.
        let _ = rustix::io::write(ours, greeting);
    }
    Ok(Process { channel: ours, ..process })
}

/// Lets a server fork the process; `None` when it must be executed.
fn fork(
    request: &SpawnRequest,
    channel: &OwnedFd,
    servers: &mut ForkServers,
) -> io::Result<Option<Process>> {
    let (stdout, their_stdout) = io::pipe()?;
    let (stderr, their_stderr) = io::pipe()?;
    let (channel, out, err) = (channel.as_fd(), their_stdout.as_fd(), their_stderr.as_fd());
    let ends = Ends { channel, stdout: out, stderr: err };
    let forked = tree::start_own_child(|| servers.fork(request, &ends), |pid| *pid);
    let Some(pid) = forked else { return Ok(None) };
    unix::lead_group(pid);
    let stdout = ChildStdout::from_std(OwnedFd::from(stdout).into())?;
    let stderr = ChildStderr::from_std(OwnedFd::from(stderr).into())?;
    let child =
        unix::open_process(pid).map(Started::Forked).inspect_err(|_| tree::kill_tree(pid))?;
    let end = End { pid, child };
    Ok(Some(Process { pid, channel: None, stdout: Some(stdout), stderr: Some(stderr), end }))
}

/// Whether a command takes its channel as its standard input.
fn on_stdin(command: &[String]) -> bool {
    gate::is_behind(command) || remote::is_remote(command)
}

fn execute(request: &SpawnRequest, channel: Option<OwnedFd>) -> io::Result<Process> {
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
    if let Some(network) = &request.network {
        network.namespaces().enter(command.as_std_mut());
    }
    if channel.is_none() {
        resources::limit_descriptors_of(command.as_std_mut());
    }
    let mut theirs = None;
    match channel {
        Some(host) if on_stdin(&request.command) => drop(command.stdin(host)),
        Some(host) => {
            unix::let_inherit(&host)?;
            command.env(CHANNEL_VARIABLE, format!("fd:{}", host.as_raw_fd()));
            theirs = Some(host);
        }
        None => {}
    }
    let pid_of = |child: &io::Result<Child>| i32::try_from(child.as_ref().ok()?.id()?).ok();
    let child = tree::start_own_child(|| command.spawn(), pid_of);
    // From here on nobody but the new process has the other end.
    drop(theirs);
    let mut child = child?;
    let pid = child.id().and_then(|pid| i32::try_from(pid).ok()).unwrap_or_default();
    let (stdout, stderr) = (child.stdout.take(), child.stderr.take());
    let end = End { pid, child: Started::Executed(child) };
    Ok(Process { pid, channel: None, stdout, stderr, end })
}
