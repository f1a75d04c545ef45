//! Hosts that are forked instead of executed: see "Forking hosts" in
//! `spec/protocol.md`.
//!
//! Executing and linking a host costs more than most tests do. The second test
//! that wants the same host with the same environment gets a server started;
//! from then on such hosts are its forks. They are the runner's own children
//! all the same, and differ from executed ones in nothing that a plug-in sees.
//! When a server fails in any way, hosts are executed again.

use std::io;
use std::os::fd::{AsFd, AsRawFd, BorrowedFd, OwnedFd};
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

use rtf_model::protocol::{
    FORK_SERVER_VARIABLE, ForkReply, ForkRequest, OWNER_VARIABLE, SCOPE_VARIABLE,
};

use super::spawner::SpawnRequest;
use super::{resources, tree, unix};
use crate::isolate::Network;

const SIGKILL: i32 = 9;
/// How many servers there are at the most; the one that was used least recently ends.
const SERVERS: usize = 8;
/// Room for the variables that only one process has.
const ROOM: usize = 1024;
/// The longest request that a server takes.
const PACKET_BYTES: usize = 64 * 1024;
/// Variables of the dynamic linker that work only when a program is executed,
/// or whose libraries may not expect to be forked.
const LINKER_VARIABLES: [&str; 2] = ["LD_PRELOAD", "LD_AUDIT"];

/// When hosts that can be forked are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Forks {
    /// From the second test on that wants the same host and environment.
    #[default]
    Auto,
    /// From the first one on.
    Always,
    /// Never: each host is executed.
    Never,
}

/// The servers of a run.
#[derive(Debug)]
pub struct ForkServers {
    forks: Forks,
    /// What was asked for once: the next such host is forked.
    seen: Vec<Kind>,
    /// The one that was used last is the last.
    servers: Vec<Server>,
    /// What cannot be forked here.
    refused: Vec<Kind>,
}

/// What all forks of a server have in common.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Kind {
    command: Vec<String>,
    env: Vec<(String, String)>,
    /// Where relative paths in the environment start.
    folder: PathBuf,
    network: Option<Network>,
}

#[derive(Debug)]
struct Server {
    kind: Kind,
    socket: OwnedFd,
    process: Child,
}

/// What a forked host gets at its start.
#[derive(Debug)]
pub struct Ends<'a> {
    /// Its end of the channel.
    pub channel: BorrowedFd<'a>,
    /// Where its standard output goes.
    pub stdout: BorrowedFd<'a>,
    /// Where its standard error goes.
    pub stderr: BorrowedFd<'a>,
}

impl ForkServers {
    /// None yet.
    #[must_use]
    pub fn new(forks: Forks) -> Self {
        Self { forks, seen: Vec::new(), servers: Vec::new(), refused: Vec::new() }
    }

    /// Ends the servers, all of them or those in a network, and forgets them.
    pub fn end(&mut self, within: Option<&Network>) {
        let stays = |kind: &Kind| within.is_some_and(|gone| kind.network.as_ref() != Some(gone));
        self.servers.retain(|server| stays(&server.kind));
        self.seen.retain(stays);
        self.refused.retain(stays);
    }

    /// Forks a host; `None` when it is to be executed.
    pub fn fork(&mut self, request: &SpawnRequest, ends: &Ends<'_>) -> Option<i32> {
        let (kind, fork) = split(request)?;
        if self.forks == Forks::Never || self.refused.contains(&kind) {
            return None;
        }
        let known = self.servers.iter().position(|server| server.kind == kind);
        let is_first = known.is_none() && !self.seen.contains(&kind);
        if is_first && self.forks == Forks::Auto {
            self.seen.push(kind);
            return None;
        }
        let server = match known {
            Some(place) => Ok(self.servers.remove(place)),
            None => Server::start(kind.clone()),
        };
        let forked = server.and_then(|server| Ok((server.fork(&fork, ends)?, server)));
        let Ok((pid, server)) = forked else {
            self.refused.push(kind);
            return None;
        };
        if self.servers.len() == SERVERS {
            self.servers.remove(0);
        }
        self.servers.push(server);
        Some(pid)
    }
}

/// What is common to all hosts of this kind, and what only this one has.
/// `None` when it cannot be forked.
fn split(request: &SpawnRequest) -> Option<(Kind, Vec<u8>)> {
    let SpawnRequest { command, env, folder: Some(folder), forks: true, network, .. } = request
    else {
        return None;
    };
    let is_linkers = |(name, _): &(String, String)| LINKER_VARIABLES.contains(&name.as_str());
    let inherits = LINKER_VARIABLES.iter().any(|name| std::env::var_os(name).is_some());
    // A folder that is not there is told as it is for every process.
    if inherits || env.iter().any(is_linkers) || !folder.is_dir() {
        return None;
    }
    let is_own = |(name, _): &(String, String)| name == OWNER_VARIABLE || name == SCOPE_VARIABLE;
    let (own, env): (Vec<_>, Vec<_>) = env.iter().cloned().partition(is_own);
    if own.iter().map(|(name, value)| name.len() + value.len() + 2).sum::<usize>() > ROOM {
        return None;
    }
    let fork = ForkRequest { working_dir: folder.clone(), env: own.into_iter().collect() };
    let fork = serde_json::to_vec(&fork).ok().filter(|packet| packet.len() < PACKET_BYTES)?;
    let (command, folder, network) = (command.clone(), folder.clone(), network.clone());
    Some((Kind { command, env, folder, network }, fork))
}

impl Server {
    fn start(kind: Kind) -> io::Result<Self> {
        let (socket, theirs) = unix::packet_pair()?;
        let (program, arguments) = kind.command.split_first().ok_or(io::ErrorKind::InvalidInput)?;
        let mut command = Command::new(program);
        command.args(arguments).envs(kind.env.iter().map(|(name, value)| (name, value)));
        let value = format!("fd:{}{}", theirs.as_raw_fd(), " ".repeat(ROOM));
        command.env(FORK_SERVER_VARIABLE, value).process_group(0).current_dir(&kind.folder);
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        if let Some(network) = &kind.network {
            network.namespaces().enter(&mut command);
        }
        unix::let_inherit(&theirs)?;
        let pid_of = |child: &io::Result<Child>| i32::try_from(child.as_ref().ok()?.id()).ok();
        let process = tree::start_own_child(|| command.spawn(), pid_of);
        drop(theirs);
        let process = process?;
        if let Ok(pid) = i32::try_from(process.id()) {
            // Its forks have what it has.
            resources::limit_descriptors(pid);
            resources::make_expendable(pid);
        }
        Ok(Self { kind, socket, process })
    }

    fn fork(&self, request: &[u8], ends: &Ends<'_>) -> io::Result<i32> {
        let Ends { channel, stdout, stderr } = ends;
        unix::send_with(self.socket.as_fd(), request, &[*channel, *stdout, *stderr])?;
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

impl Drop for Server {
    fn drop(&mut self) {
        // It has nothing to clean up; its forks are not below it.
        let _ = self.process.kill();
        let _ = self.process.wait();
        if let Ok(pid) = i32::try_from(self.process.id()) {
            tree::remove_own_child(pid);
        }
    }
}
