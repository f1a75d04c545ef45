//! The probes of process fixtures that ask the world: TCP, HTTP, a file, a
//! command, middleware. (What a process prints is looked at by the state machine.)

use std::collections::BTreeMap;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use rtf_model::ExitStatus;
use tokio::io::AsyncReadExt;
use tokio::time::timeout;
use url::Url;

use super::http;
use crate::host::spawner::{SpawnRequest, Spawner, Streams};
use crate::host::task::Inputs;
use crate::host::tree;
use crate::isolate::{Network, connect};
use crate::run::machine::{HostId, HostInput};
use rtf_plan::plan::{Probe, ProbeKind, ProcessPlan};

/// How long somebody else may take to answer.
const TAKEN_WAIT: Duration = Duration::from_millis(200);
/// How much of a reason is read, in bytes.
const LONGEST_REASON: u64 = 4096;

/// Asks the probes of one fixture and tells the suite's task what comes of it.
#[derive(Clone, Debug)]
pub struct Watch {
    /// The fixture's process, or what stands for it.
    pub host: HostId,
    /// Where it is told.
    pub inputs: Inputs,
    /// Where the probes are asked.
    pub asker: Asker,
}

impl Watch {
    /// Tells when each of these probes has held once, and why one does not
    /// whenever the reason changes. A file counts when it is not as it was `before`.
    pub async fn until_ready(self, probes: Vec<Probe>, before: Files) {
        let mut told = String::new();
        for probe in &probes {
            while let Err(reason) = ask(probe, &before, &self.asker).await {
                if reason != told {
                    told.clone_from(&reason);
                    self.tell(HostInput::ProbeWaits(reason)).await;
                }
                tokio::time::sleep(probe.every).await;
            }
        }
        self.tell(HostInput::ProbesHold).await;
    }

    /// Asks each of these probes once.
    ///
    /// # Errors
    /// Why one does not hold.
    pub async fn all_hold(&self, probes: &[Probe]) -> Result<(), String> {
        for probe in probes {
            ask(probe, &Files::default(), &self.asker).await?;
        }
        Ok(())
    }

    /// Tells when one of these probes does not hold any more.
    pub async fn until_unwell(self, probes: Vec<Probe>) {
        let reason = wait_until_unwell(&probes, &self.asker).await;
        self.tell(HostInput::ProbeFailed(reason)).await;
    }

    /// Tells the suite's task something of the fixture.
    pub async fn tell(&self, input: HostInput) {
        drop(self.inputs.send((self.host, input)).await);
    }
}

/// A TCP or HTTP address that a fixture will be ready by and that answers
/// before the fixture was started: somebody else's.
pub async fn already_answers(
    process: Option<&ProcessPlan>,
    request: &SpawnRequest,
) -> Option<String> {
    let network = request.network.as_ref();
    for probe in process.map_or(&[][..], |process| &process.ready) {
        let address = match &probe.kind {
            ProbeKind::Tcp(address) => address.clone(),
            ProbeKind::Http(url) => address_of(url)?,
            _ => continue,
        };
        if matches!(timeout(TAKEN_WAIT, connect(network, &address)).await, Ok(Ok(_))) {
            return Some(address);
        }
    }
    None
}

fn address_of(url: &str) -> Option<String> {
    http::address(&Url::parse(url).ok()?)
}

/// Where the probes of a process are asked.
#[derive(Clone, Debug)]
pub struct Asker {
    /// The thread that starts processes.
    pub spawner: Spawner,
    /// The process that is asked about: commands get its folder and environment.
    pub like: SpawnRequest,
}

/// Returns when a probe does not hold any more, with the reason.
async fn wait_until_unwell(probes: &[Probe], asker: &Asker) -> String {
    let asked: Vec<&Probe> =
        probes.iter().filter(|probe| !matches!(probe.kind, ProbeKind::Log(_))).collect();
    let mut due: Vec<_> = asked.iter().map(|p| tokio::time::Instant::now() + p.every).collect();
    loop {
        let next = (0..asked.len()).min_by_key(|index| due[*index]);
        let Some(next) = next else {
            return std::future::pending().await;
        };
        tokio::time::sleep_until(due[next]).await;
        if let Err(reason) = ask(asked[next], &Files::default(), asker).await {
            return reason;
        }
        due[next] = tokio::time::Instant::now() + asked[next].every;
    }
}

async fn ask(probe: &Probe, before: &Files, asker: &Asker) -> Result<(), String> {
    let network = asker.like.network.as_ref();
    let answer = async {
        match &probe.kind {
            ProbeKind::Tcp(address) => match connect(network, address).await {
                Ok(_) => Ok(()),
                Err(error) => Err(format!("no TCP connection to {address}: {error}")),
            },
            ProbeKind::Http(url) => ask_http(network, url).await,
            ProbeKind::File(path) => before.ask(path),
            ProbeKind::Command(command) => ask_command(command, asker).await,
            ProbeKind::Middleware { command, subject } => {
                ask_middleware(command, subject, asker).await
            }
            ProbeKind::Log(_) => Ok(()),
        }
    };
    match timeout(probe.timeout, answer).await {
        Ok(answer) => answer,
        Err(_) => Err(format!("{} did not answer within {:?}", subject(probe), probe.timeout)),
    }
}

fn subject(probe: &Probe) -> String {
    match &probe.kind {
        ProbeKind::Tcp(address) => address.clone(),
        ProbeKind::Http(url) => url.clone(),
        ProbeKind::File(path) => path.display().to_string(),
        ProbeKind::Command(command) => format!("`{}`", shown(command)),
        ProbeKind::Middleware { subject, .. } => subject.clone(),
        ProbeKind::Log(pattern) => pattern.to_string(),
    }
}

async fn ask_http(network: Option<&Network>, url: &str) -> Result<(), String> {
    let status = http::get(network, url).await;
    let status = status.map_err(|error| format!("no answer from {url}: {error}"))?;
    if status.is_success() { Ok(()) } else { Err(format!("{url} answers {status}")) }
}

/// The files that probes ask for, as they were before a process was started: one that
/// was not written since says nothing about this start. No clock is asked, which may be
/// set meanwhile, or be another one than the file system's.
#[derive(Clone, Debug, Default)]
pub struct Files(BTreeMap<PathBuf, Version>);

/// What changes when a file is written, or another one takes its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Version {
    inode: u64,
    size: u64,
    written: (i64, i64),
    changed: (i64, i64),
}

impl Files {
    /// As they are now.
    #[must_use]
    pub fn now(probes: &[Probe]) -> Self {
        let paths = probes.iter().filter_map(|probe| match &probe.kind {
            ProbeKind::File(path) => Some(path),
            _ => None,
        });
        Self(paths.filter_map(|path| Some((path.clone(), version(path).ok()?))).collect())
    }

    fn ask(&self, path: &Path) -> Result<(), String> {
        let shown = path.display();
        let now = version(path).map_err(|error| format!("no file {shown}: {error}"))?;
        if self.0.get(path) == Some(&now) {
            return Err(format!("{shown} is from before the start"));
        }
        Ok(())
    }
}

fn version(path: &Path) -> std::io::Result<Version> {
    let file = std::fs::metadata(path)?;
    Ok(Version {
        inode: file.ino(),
        size: file.size(),
        written: (file.mtime(), file.mtime_nsec()),
        changed: (file.ctime(), file.ctime_nsec()),
    })
}

async fn ask_command(command: &[String], asker: &Asker) -> Result<(), String> {
    let shown = shown(command);
    match run(command, Streams::None, asker).await {
        Ok((ExitStatus::Code(0), _)) => Ok(()),
        Ok((status, _)) => Err(format!("`{shown}` ended with {status}")),
        Err(error) => Err(format!("`{shown}` cannot run: {error}")),
    }
}

/// The program tells in a line why it does not hold.
async fn ask_middleware(command: &[String], subject: &str, asker: &Asker) -> Result<(), String> {
    match run(command, Streams::StdoutOnly, asker).await {
        Ok((ExitStatus::Code(0), _)) => Ok(()),
        Ok((_, reason)) if !reason.is_empty() => Err(reason),
        Ok((status, _)) => Err(format!("the program that asks {subject} ended with {status}")),
        Err(error) => Err(format!("{subject} cannot be asked: {error}")),
    }
}

/// Runs a program to its end; how it ended, and what it printed if that is wanted.
async fn run(
    command: &[String],
    streams: Streams,
    asker: &Asker,
) -> std::io::Result<(ExitStatus, String)> {
    let request = SpawnRequest {
        command: command.to_vec(),
        streams,
        channel: None,
        forks: false,
        ..asker.like.clone()
    };
    let mut process = asker.spawner.spawn(request).await?;
    let guard = KillOnDrop(process.pid);
    let mut printed = Vec::new();
    if let Some(stdout) = process.stdout.take() {
        stdout.take(LONGEST_REASON).read_to_end(&mut printed).await?;
    }
    let status = process.end.wait().await?;
    std::mem::forget(guard);
    Ok((status, String::from_utf8_lossy(&printed).trim().to_owned()))
}

/// A command as the suite has it: the program was made absolute since.
fn shown(command: &[String]) -> String {
    let mut words: Vec<&str> = command.iter().map(String::as_str).collect();
    if let Some(program) = words.first_mut() {
        *program = program.rsplit('/').next().unwrap_or(program);
    }
    shell_words::join(words)
}

/// Kills a command's tree when its probe runs out of time.
struct KillOnDrop(i32);

impl Drop for KillOnDrop {
    fn drop(&mut self) {
        tree::kill_tree(self.0);
    }
}
