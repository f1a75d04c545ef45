//! Fork servers: hosts that fork a process per test; see "Forking hosts" in
//! `spec/protocol.md`.
//!
//! Executing and linking a host takes longer than most tests. The second request for the
//! same host with the same environment starts a server, which forks all later ones. A
//! forked host is a child of the runner, and a plug-in cannot tell it from an executed
//! one. If a server fails, its hosts are executed.

use std::io;
use std::os::fd::{AsFd, AsRawFd, BorrowedFd, OwnedFd};
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;

use rtf_model::protocol::{
    FORK_SERVER_VARIABLE, ForkReply, ForkRequest, OWNER_VARIABLE, SCOPE_VARIABLE,
};

use rustix::net::SendFlags;

use crate::namespaces::Namespaces;
use crate::spawn_request::SpawnRequest;
use crate::{descriptor_passing, posix_spawn};
use crate::{resources, tree, unix};

const SIGKILL: i32 = 9;
/// The number of servers. The least recently used one ends first.
const MAX_SERVERS: usize = 8;
/// The bytes reserved in a server's environment for the variables of one fork.
const OWN_VARIABLE_BYTES: usize = 1024;
/// The longest request that a server accepts.
const PACKET_BYTES: usize = 64 * 1024;
/// Variables of the dynamic linker that only affect executed programs, or whose libraries
/// may not support forks.
const LINKER_VARIABLES: [&str; 2] = ["LD_PRELOAD", "LD_AUDIT"];

/// When hosts that support it are forked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ForkMode {
    /// From the second request for the same host and environment on.
    #[default]
    Auto,
    /// From the first request on.
    Always,
    /// Never: each host is executed.
    Never,
}

/// The servers of a run.
#[derive(Debug)]
pub struct ForkServers {
    mode: ForkMode,
    /// Hosts requested once: the next such request starts a server.
    seen: Vec<HostSpec>,
    /// The most recently used one is the last.
    servers: Vec<ForkServerProcess>,
    /// Hosts whose server has failed.
    refused: Vec<HostSpec>,
}

/// The properties that all forks of a server have in common.
#[derive(Clone, Debug, PartialEq, Eq)]
struct HostSpec {
    command: Vec<String>,
    env: Vec<(String, String)>,
    /// Relative paths in the environment start here.
    working_dir: PathBuf,
    namespaces: Option<Arc<Namespaces>>,
}

#[derive(Debug)]
struct ForkServerProcess {
    spec: HostSpec,
    socket: OwnedFd,
    process: Child,
}

/// The descriptors of a forked host.
#[derive(Debug)]
pub struct ChildEnds<'a> {
    /// Its end of the channel.
    pub channel: BorrowedFd<'a>,
    pub stdout: BorrowedFd<'a>,
    pub stderr: BorrowedFd<'a>,
}

impl ForkServers {
    /// Starts no server yet.
    pub fn new(mode: ForkMode) -> Self {
        Self { mode, seen: Vec::new(), servers: Vec::new(), refused: Vec::new() }
    }

    pub fn mode(&self) -> ForkMode {
        self.mode
    }

    /// Stops all servers, or those in the given namespaces.
    pub fn stop(&mut self, within: Option<&Namespaces>) {
        let remains = |spec: &HostSpec| {
            within.is_some_and(|removed| spec.namespaces.as_deref() != Some(removed))
        };
        self.servers.retain(|server| remains(&server.spec));
        self.seen.retain(remains);
        self.refused.retain(remains);
    }

    /// Forks a host; `None` when it must be executed.
    pub fn fork(&mut self, request: &SpawnRequest, ends: &ChildEnds<'_>) -> Option<i32> {
        let (spec, fork) = split(request)?;
        if self.mode == ForkMode::Never || self.refused.contains(&spec) {
            return None;
        }
        let known = self.servers.iter().position(|server| server.spec == spec);
        let is_first = known.is_none() && !self.seen.contains(&spec);
        if is_first && self.mode == ForkMode::Auto {
            self.seen.push(spec);
            return None;
        }
        let server = match known {
            Some(index) => Ok(self.servers.remove(index)),
            None => ForkServerProcess::start(spec.clone()),
        };
        let forked = server.and_then(|server| Ok((server.fork(&fork, ends)?, server)));
        let Ok((pid, server)) = forked else {
            self.refused.push(spec);
            return None;
        };
        if self.servers.len() == MAX_SERVERS {
            self.servers.remove(0);
        }
        self.servers.push(server);
        Some(pid)
    }
}

/// Splits a request into the common properties and the message to the server. `None` when
/// the host cannot be forked.
fn split(request: &SpawnRequest) -> Option<(HostSpec, Vec<u8>)> {
    let SpawnRequest { working_dir: Some(dir), can_fork: true, env, .. } = request else {
        return None;
    };
    let is_linkers = |(name, _): &(String, String)| LINKER_VARIABLES.contains(&name.as_str());
    let inherits = LINKER_VARIABLES.iter().any(|name| std::env::var_os(name).is_some());
    // Executing the host reports a missing directory as for every process.
    if inherits || env.iter().any(is_linkers) || !dir.is_dir() {
        return None;
    }
    let is_own = |(name, _): &(String, String)| name == OWNER_VARIABLE || name == SCOPE_VARIABLE;
    let (own, env): (Vec<_>, Vec<_>) = env.iter().cloned().partition(is_own);
    if own.iter().map(|(name, value)| name.len() + value.len() + 2).sum::<usize>()
        > OWN_VARIABLE_BYTES
    {
        return None;
    }
    let fork = ForkRequest { working_dir: dir.clone(), env: own.into_iter().collect() };
    let fork = serde_json::to_vec(&fork).ok().filter(|packet| packet.len() < PACKET_BYTES)?;
    let (command, namespaces) = (request.command.clone(), request.namespaces.clone());
    Some((HostSpec { command, env, working_dir: dir.clone(), namespaces }, fork))
}

impl ForkServerProcess {
    fn start(spec: HostSpec) -> io::Result<Self> {
        let (socket, theirs) = unix::packet_pair()?;
        let (program, arguments) = spec.command.split_first().ok_or(io::ErrorKind::InvalidInput)?;
        let mut command = Command::new(program);
        command.args(arguments).envs(spec.env.iter().map(|(name, value)| (name, value)));
        let value = format!("fd:{}{}", theirs.as_raw_fd(), " ".repeat(OWN_VARIABLE_BYTES));
        command.env(FORK_SERVER_VARIABLE, value).process_group(0).current_dir(&spec.working_dir);
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        if let Some(namespaces) = &spec.namespaces {
            namespaces.enter(&mut command);
        }
        posix_spawn::reset_signals(&mut command);
        unix::let_inherit(&theirs)?;
        let pid_of = |child: &io::Result<Child>| i32::try_from(child.as_ref().ok()?.id()).ok();
        let process = tree::start_own_child(|| command.spawn(), pid_of);
        drop(theirs);
        let process = process?;
        if let Ok(pid) = i32::try_from(process.id()) {
            // Its forks inherit both.
            resources::limit_descriptors(pid);
            resources::make_expendable(pid);
        }
        Ok(Self { spec, socket, process })
    }

    fn fork(&self, request: &[u8], ends: &ChildEnds<'_>) -> io::Result<i32> {
        let ChildEnds { channel, stdout, stderr } = ends;
        let (socket, descriptors) = (self.socket.as_fd(), [*channel, *stdout, *stderr]);
        descriptor_passing::send(socket, request, &descriptors, SendFlags::empty())?;
        let reply = unix::receive_packet(self.socket.as_fd())?;
        match serde_json::from_slice(&reply)? {
            ForkReply::Pid(pid) if unix::is_child(pid) => Ok(pid),
            ForkReply::Pid(pid) => {
                unix::signal_process(pid, SIGKILL);
                Err(io::Error::other("its fork is not a child of the runner"))
            }
            ForkReply::Error(error) => Err(io::Error::other(error)),
        }
    }
}

impl Drop for ForkServerProcess {
    fn drop(&mut self) {
        // It has nothing to clean up, and its forks are not its children.
        let _ = self.process.kill();
        let _ = self.process.wait();
        if let Ok(pid) = i32::try_from(self.process.id()) {
            tree::remove_own_child(pid);
        }
    }
}
