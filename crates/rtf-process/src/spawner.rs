//! The thread that starts every process.
//!
//! Starting a process blocks until the kernel has executed it, and a channel's
//! descriptor must be inheritable for just that moment: both need a single thread.
//! `posix_spawn` is used, so that the duration does not grow with the runner's memory.
//! A plain fork is needed only for a process that enters a namespace, and for one that
//! starts without a greeting while the runner's descriptor limit differs from the user's.

use std::io;
use std::os::fd::{AsFd, AsRawFd, OwnedFd};
use std::process::Stdio;
use std::sync::Arc;

use rtf_model::protocol::{CHANNEL_VARIABLE, FORK_VARIABLE};
use tokio::net::UnixStream;
use tokio::process::{Child, ChildStderr, ChildStdout, Command};
use tokio::sync::oneshot;

use crate::foreground::Foreground;
use crate::fork_server::{ChildEnds, ForkMode, ForkServers};
use crate::namespaces::Namespaces;
use crate::process::{ProcessEnd, StartedChild, StartedProcess};
use crate::resources::{self, DescriptorReserve};
use crate::spawn_request::{ProcessRole, SpawnRequest, Streams};
use crate::{ssh, start_gate, tree, unix};

enum SpawnerJob {
    Start(SpawnRequest, oneshot::Sender<io::Result<StartedProcess>>),
    StopForkServers(Option<Arc<Namespaces>>, oneshot::Sender<()>),
}

/// A handle to the thread.
#[derive(Clone, Debug)]
pub struct Spawner {
    jobs: std::sync::mpsc::Sender<SpawnerJob>,
}

impl Spawner {
    /// Starts the thread. It ends with the last handle.
    ///
    /// # Errors
    /// The thread cannot be started.
    ///
    /// # Panics
    /// Outside of a tokio runtime.
    pub fn start(mode: ForkMode) -> io::Result<Self> {
        let (jobs, queue) = std::sync::mpsc::channel::<SpawnerJob>();
        let runtime = tokio::runtime::Handle::current();
        std::thread::Builder::new().name("rtf-spawner".to_owned()).spawn(move || {
            let _entered = runtime.enter();
            let mut servers = ForkServers::new(mode);
            let mut reserve = DescriptorReserve::default();
            for job in queue {
                reserve.fill();
                match job {
                    SpawnerJob::Start(request, reply) => {
                        let started = spawn_or_release(&request, &mut servers, &mut reserve);
                        // Without a receiver the process is killed by its drop.
                        drop(reply.send(started));
                    }
                    SpawnerJob::StopForkServers(within, done) => {
                        servers.stop(within.as_deref());
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
    /// The program cannot be executed, or a resource is exhausted.
    pub async fn spawn(&self, request: SpawnRequest) -> io::Result<StartedProcess> {
        Self::started(self.begin(request)).await
    }

    /// Requests the start of a process, without waiting for it.
    pub fn begin(&self, request: SpawnRequest) -> oneshot::Receiver<io::Result<StartedProcess>> {
        let (reply, started) = oneshot::channel();
        // Without the thread, the receiver reports it.
        let _ = self.jobs.send(SpawnerJob::Start(request, reply));
        started
    }

    /// Stops all fork servers, or those in the given namespaces.
    pub async fn stop_fork_servers(&self, within: Option<Arc<Namespaces>>) {
        let (done, stopped) = oneshot::channel();
        let _ = self.jobs.send(SpawnerJob::StopForkServers(within, done));
        // They end with the thread.
        let _ = stopped.await;
    }

    /// Waits for the start requested by [`Spawner::begin`].
    ///
    /// # Errors
    /// As for [`Spawner::spawn`].
    pub async fn started(
        reply: oneshot::Receiver<io::Result<StartedProcess>>,
    ) -> io::Result<StartedProcess> {
        reply.await.map_err(|_| io::Error::other("the thread that starts processes has ended"))?
    }
}

/// Starts a process. A hook or a fixture may use the reserved descriptors.
fn spawn_or_release(
    request: &SpawnRequest,
    servers: &mut ForkServers,
    reserve: &mut DescriptorReserve,
) -> io::Result<StartedProcess> {
    match (spawn(request, servers), request.role) {
        (Err(error), Some(role @ (ProcessRole::Hook | ProcessRole::Fixture)))
            if resources::is_exhausted(&error) =>
        {
            reserve.release(role == ProcessRole::Hook);
            spawn(request, servers)
        }
        (started, _) => started,
    }
}

fn spawn(request: &SpawnRequest, servers: &mut ForkServers) -> io::Result<StartedProcess> {
    let (mut ours, mut theirs) = (None, None);
    if request.channel.is_some() {
        let (runner, host) = unix::channel_pair()?;
        runner.set_nonblocking(true)?;
        ours = Some(UnixStream::from_std(runner)?);
        theirs = Some(OwnedFd::from(host));
    }
    let forked = match &theirs {
        Some(host) if request.can_fork => fork(request, host, servers)?,
        _ => None,
    };
    let process = match forked {
        // It inherits the limits of its server.
        Some(process) => process,
        None => {
            let process = execute(request, theirs, servers.mode())?;
            resources::limit_descriptors(process.pid);
            if matches!(request.role, Some(ProcessRole::Test | ProcessRole::Fixture)) {
                resources::make_expendable(process.pid);
            }
            process
        }
    };
    if let (Some(greeting), Some(ours)) = (&request.channel, &ours) {
        // The process waits for the greeting, which fits into the socket's buffer. A
        // process that has ended is noticed by its exit.
        let _ = rustix::io::write(ours, greeting);
    }
    Ok(StartedProcess { channel: ours, ..process })
}

/// Lets a server fork the process; `None` when it must be executed.
fn fork(
    request: &SpawnRequest,
    channel: &OwnedFd,
    servers: &mut ForkServers,
) -> io::Result<Option<StartedProcess>> {
    let (stdout, their_stdout) = io::pipe()?;
    let (stderr, their_stderr) = io::pipe()?;
    let (channel, out, err) = (channel.as_fd(), their_stdout.as_fd(), their_stderr.as_fd());
    let ends = ChildEnds { channel, stdout: out, stderr: err };
    let forked = tree::start_own_child(|| servers.fork(request, &ends), |pid| *pid);
    let Some(pid) = forked else { return Ok(None) };
    unix::lead_group(pid);
    let stdout = ChildStdout::from_std(OwnedFd::from(stdout).into())?;
    let stderr = ChildStderr::from_std(OwnedFd::from(stderr).into())?;
    let child =
        unix::open_process(pid).map(StartedChild::Forked).inspect_err(|_| tree::kill_tree(pid))?;
    let end = ProcessEnd::new(pid, child);
    Ok(Some(StartedProcess {
        pid,
        channel: None,
        stdout: Some(stdout),
        stderr: Some(stderr),
        foreground: None,
        end,
    }))
}

/// Whether a command takes its channel as its standard input.
fn uses_stdin(command: &[String]) -> bool {
    start_gate::is_behind(command) || ssh::is_remote(command)
}

fn execute(
    request: &SpawnRequest,
    channel: Option<OwnedFd>,
    mode: ForkMode,
) -> io::Result<StartedProcess> {
    let Some((program, arguments)) = request.command.split_first() else {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "an empty command"));
    };
    let mut command = Command::new(program);
    command.args(arguments).envs(request.env.iter().map(|(name, value)| (name, value)));
    command.process_group(0).kill_on_drop(true);
    set_streams(&mut command, request.streams);
    if let Some(dir) = &request.working_dir {
        command.current_dir(dir);
    }
    if let Some(namespaces) = &request.namespaces {
        namespaces.enter(command.as_std_mut());
    }
    if channel.is_none() {
        resources::limit_descriptors_of(command.as_std_mut());
    }
    if channel.is_some() && mode == ForkMode::Never {
        // Hosts that fork programs follow it.
        command.env(FORK_VARIABLE, "never");
    }
    let mut theirs = None;
    match channel {
        Some(host) if uses_stdin(&request.command) => drop(command.stdin(host)),
        Some(host) => {
            unix::let_inherit(&host)?;
            command.env(CHANNEL_VARIABLE, format!("fd:{}", host.as_raw_fd()));
            theirs = Some(host);
        }
        None => {}
    }
    let pid_of = |child: &io::Result<Child>| i32::try_from(child.as_ref().ok()?.id()?).ok();
    let child = tree::start_own_child(|| command.spawn(), pid_of);
    // Only the new process may keep the other end.
    drop(theirs);
    let mut child = child?;
    let pid = child.id().and_then(|pid| i32::try_from(pid).ok()).unwrap_or_default();
    // Before its greeting: it does not read the terminal yet.
    let foreground = match request.streams {
        Streams::Terminal => Some(Foreground::give(pid)?),
        _ => None,
    };
    let (stdout, stderr) = (child.stdout.take(), child.stderr.take());
    let end = ProcessEnd::new(pid, StartedChild::Executed(child));
    Ok(StartedProcess { pid, channel: None, stdout, stderr, foreground, end })
}

fn set_streams(command: &mut Command, streams: Streams) {
    let (stdin, stdout, stderr) = match streams {
        Streams::Both => (Stdio::null(), Stdio::piped(), Stdio::piped()),
        Streams::StdoutOnly => (Stdio::null(), Stdio::piped(), Stdio::null()),
        Streams::None => (Stdio::null(), Stdio::null(), Stdio::null()),
        Streams::Terminal => {
            // It inherits this. The shell could not continue it.
            unix::ignore_suspension();
            (Stdio::inherit(), Stdio::inherit(), Stdio::inherit())
        }
    };
    command.stdin(stdin).stdout(stdout).stderr(stderr);
}
