//! The thread that starts every process.
//!
//! Starting a process blocks until the kernel has executed it, and a channel's
//! descriptor must be inheritable for just that moment: both need a single thread.
//! [`posix_spawn`] is used, so that the duration does not grow with the runner's memory.
//! A plain fork is needed only for a process that enters a namespace, and for one that
//! starts without a greeting while the runner's descriptor limit differs from the user's.

use std::fs::File;
use std::io::{self, PipeReader};
use std::os::fd::{AsFd, AsRawFd, OwnedFd};
use std::os::unix::process::CommandExt;
use std::process::{Command, Stdio};
use std::sync::Arc;

use rtf_model::protocol::{CHANNEL_VARIABLE, FORK_VARIABLE};
use tokio::net::UnixStream;
use tokio::process::{ChildStderr, ChildStdout};
use tokio::sync::oneshot;

use crate::foreground::Foreground;
use crate::fork_server::{ChildEnds, ForkMode, ForkServers};
use crate::namespaces::Namespaces;
use crate::posix_spawn;
use crate::process::{ProcessEnd, StartedProcess};
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
    let end = ProcessEnd::open(pid)?;
    let (stdout, stderr) = outputs(Some(stdout), Some(stderr))?;
    Ok(Some(StartedProcess { pid, channel: None, stdout, stderr, foreground: None, end }))
}

/// The runner's ends of the outputs of a process.
fn outputs(
    stdout: Option<PipeReader>,
    stderr: Option<PipeReader>,
) -> io::Result<(Option<ChildStdout>, Option<ChildStderr>)> {
    let stdout = stdout.map(|end| ChildStdout::from_std(OwnedFd::from(end).into()));
    let stderr = stderr.map(|end| ChildStderr::from_std(OwnedFd::from(end).into()));
    Ok((stdout.transpose()?, stderr.transpose()?))
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
    if let Some(dir) = &request.working_dir {
        command.current_dir(dir);
    }
    if channel.is_some() && mode == ForkMode::Never {
        // Hosts that fork programs follow it.
        command.env(FORK_VARIABLE, "never");
    }
    let mut streams = StandardStreams::open(request.streams)?;
    let (mut theirs, has_channel) = (None, channel.is_some());
    match channel {
        Some(host) if uses_stdin(&request.command) => streams.theirs[0] = Some(host),
        Some(host) => {
            unix::let_inherit(&host)?;
            command.env(CHANNEL_VARIABLE, format!("fd:{}", host.as_raw_fd()));
            theirs = Some(host);
        }
        None => {}
    }
    let StandardStreams { theirs: ends, stdout, stderr } = streams;
    let start = || match fork_steps(request, has_channel, &mut command) {
        true => fork_and_execute(&mut command, ends),
        false => posix_spawn::spawn(&command, &ends),
    };
    let pid = tree::start_own_child(start, |pid| pid.as_ref().ok().copied());
    // Only the new process may keep the other end.
    drop(theirs);
    let pid = pid?;
    let end = ProcessEnd::open(pid)?;
    // Before its greeting: it does not read the terminal yet.
    let foreground = match request.streams {
        Streams::Terminal => Some(Foreground::give(pid)?),
        _ => None,
    };
    let (stdout, stderr) = outputs(stdout, stderr)?;
    Ok(StartedProcess { pid, channel: None, stdout, stderr, foreground, end })
}

/// Adds the steps between fork and execution; false if there are none.
fn fork_steps(request: &SpawnRequest, has_channel: bool, command: &mut Command) -> bool {
    if let Some(namespaces) = &request.namespaces {
        namespaces.enter(command);
    }
    let is_limited = !has_channel && resources::limit_descriptors_of(command);
    is_limited || request.namespaces.is_some()
}

fn fork_and_execute(command: &mut Command, ends: posix_spawn::Streams) -> io::Result<i32> {
    let [stdin, stdout, stderr] = ends.map(|end| end.map_or_else(Stdio::inherit, Stdio::from));
    command.stdin(stdin).stdout(stdout).stderr(stderr).process_group(0);
    posix_spawn::reset_signals(command);
    i32::try_from(command.spawn()?.id()).map_err(io::Error::other)
}

/// The standard streams of a new process.
struct StandardStreams {
    theirs: posix_spawn::Streams,
    stdout: Option<PipeReader>,
    stderr: Option<PipeReader>,
}

impl StandardStreams {
    fn open(streams: Streams) -> io::Result<Self> {
        let null = || {
            io::Result::Ok(OwnedFd::from(File::options().read(true).write(true).open("/dev/null")?))
        };
        if streams == Streams::Terminal {
            // It inherits this. The shell could not continue it.
            unix::ignore_suspension();
            return Ok(Self { theirs: [None, None, None], stdout: None, stderr: None });
        }
        let output = |is_captured: bool| {
            if !is_captured {
                return io::Result::Ok((None, null()?));
            }
            let (ours, theirs) = io::pipe()?;
            Ok((Some(ours), theirs.into()))
        };
        let (stdout, out) = output(streams != Streams::None)?;
        let (stderr, err) = output(streams == Streams::Both)?;
        Ok(Self { theirs: [Some(null()?), Some(out), Some(err)], stdout, stderr })
    }
}
