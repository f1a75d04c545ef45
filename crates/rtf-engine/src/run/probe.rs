//! The probes of process fixtures that ask the world: TCP, HTTP, a file, a
//! command. (What a process prints is looked at by the state machine.)

use std::path::Path;
use std::time::{Duration, SystemTime};

use tokio::net::TcpStream;
use tokio::time::timeout;

use crate::host::spawner::{SpawnRequest, Spawner, Streams};
use crate::host::tree;
use crate::plan::{Probe, ProbeKind, ProcessPlan};

/// How long somebody else may take to answer.
const TAKEN_WAIT: Duration = Duration::from_millis(200);

/// A TCP or HTTP address that a fixture will be ready by and that answers
/// before the fixture was started: somebody else's.
pub async fn already_answers(process: Option<&ProcessPlan>) -> Option<String> {
    for probe in process.map_or(&[][..], |process| &process.ready) {
        let address = match &probe.kind {
            ProbeKind::Tcp(address) => address.clone(),
            ProbeKind::Http(url) => address_of(url)?,
            _ => continue,
        };
        if matches!(timeout(TAKEN_WAIT, TcpStream::connect(&address)).await, Ok(Ok(_))) {
            return Some(address);
        }
    }
    None
}

fn address_of(url: &str) -> Option<String> {
    let url = reqwest::Url::parse(url).ok()?;
    Some(format!("{}:{}", url.host_str()?, url.port_or_known_default()?))
}

/// Where the probes of a process are asked.
#[derive(Clone, Debug)]
pub struct Asker {
    /// The thread that starts processes.
    pub spawner: Spawner,
    /// The process that is asked about: commands get its folder and environment.
    pub like: SpawnRequest,
}

/// Returns when each probe has held once.
pub async fn wait_until_ready(probes: &[Probe], started_at: SystemTime, asker: &Asker) {
    for probe in probes {
        while ask(probe, Some(started_at), asker).await.is_err() {
            tokio::time::sleep(probe.every).await;
        }
    }
}

/// Returns when a probe does not hold any more, with the reason.
pub async fn wait_until_unwell(probes: &[Probe], asker: &Asker) -> String {
    let asked: Vec<&Probe> =
        probes.iter().filter(|probe| !matches!(probe.kind, ProbeKind::Log(_))).collect();
    let mut due: Vec<_> = asked.iter().map(|p| tokio::time::Instant::now() + p.every).collect();
    loop {
        let next = (0..asked.len()).min_by_key(|index| due[*index]);
        let Some(next) = next else {
            return std::future::pending().await;
        };
        tokio::time::sleep_until(due[next]).await;
        if let Err(reason) = ask(asked[next], None, asker).await {
            return reason;
        }
        due[next] = tokio::time::Instant::now() + asked[next].every;
    }
}

async fn ask(probe: &Probe, since: Option<SystemTime>, asker: &Asker) -> Result<(), String> {
    let answer = async {
        match &probe.kind {
            ProbeKind::Tcp(address) => match TcpStream::connect(address).await {
                Ok(_) => Ok(()),
                Err(error) => Err(format!("no TCP connection to {address}: {error}")),
            },
            ProbeKind::Http(url) => ask_http(url).await,
            ProbeKind::File(path) => ask_file(path, since),
            ProbeKind::Command(command) => ask_command(command, asker).await,
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
        ProbeKind::Log(pattern) => pattern.to_string(),
    }
}

async fn ask_http(url: &str) -> Result<(), String> {
    let answer =
        reqwest::get(url).await.map_err(|error| format!("no answer from {url}: {error}"))?;
    if answer.status().is_success() {
        Ok(())
    } else {
        Err(format!("{url} answers {}", answer.status()))
    }
}

/// A file from before the start says nothing about this start.
fn ask_file(path: &Path, since: Option<SystemTime>) -> Result<(), String> {
    let shown = path.display();
    let file = std::fs::metadata(path).map_err(|error| format!("no file {shown}: {error}"))?;
    match (since, file.modified()) {
        // File systems keep times in coarser steps than the clock.
        (Some(since), Ok(time)) if time + Duration::from_millis(20) < since => {
            Err(format!("{shown} is from before the start"))
        }
        _ => Ok(()),
    }
}

async fn ask_command(command: &[String], asker: &Asker) -> Result<(), String> {
    let shown = shown(command);
    let request = SpawnRequest {
        command: command.to_vec(),
        streams: Streams::None,
        channel: None,
        ..asker.like.clone()
    };
    let started = asker.spawner.spawn(request).await;
    let mut process = started.map_err(|error| format!("`{shown}` cannot run: {error}"))?;
    let guard = KillOnDrop(process.pid);
    let status = process.end.wait().await.map_err(|error| format!("`{shown}`: {error}"))?;
    std::mem::forget(guard);
    if status == rtf_model::ExitStatus::Code(0) {
        Ok(())
    } else {
        Err(format!("`{shown}` ended with {status}"))
    }
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
