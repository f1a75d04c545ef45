//! Probes: whether a fixture answers on TCP or HTTP, has written a file, or satisfies a
//! command.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use rtf_model::ExitStatus;
use tokio::io::AsyncReadExt;
use tokio::time::{Instant, timeout};
use url::Url;

use crate::http;
use crate::network::{Network, connect};
use crate::spawn_request::{SpawnRequest, Streams};
use crate::spawner::Spawner;
use crate::{start_failure, tree};

/// How long another program may take to accept a connection.
const ADDRESS_IN_USE_LIMIT: Duration = Duration::from_millis(200);
/// The longest reason printed by a command, in bytes.
const MAX_REASON_BYTES: u64 = 4096;
/// The longest value that is read completely, in bytes: more than the runner accepts.
const MAX_VALUE_BYTES: u64 = 128 * 1024;

#[derive(Clone, Debug, Default)]
pub struct Probes {
    /// Each must pass once before the process is ready.
    pub ready: Vec<ProbeSpec>,
    /// All must pass while it is ready.
    pub alive: Vec<ProbeSpec>,
    /// The values that are read once the `ready` probes have passed.
    pub values: Vec<ValueSpec>,
    /// The network namespace of the process; the runner's when `None`.
    pub network: Option<Network>,
}

/// A value that the process provides.
#[derive(Clone, Debug)]
pub struct ValueSpec {
    pub name: String,
    pub source: ValueSource,
    /// The interval at which the source is polled.
    pub interval: Duration,
    /// The limit for one run of a command.
    pub timeout: Duration,
}

#[derive(Clone, Debug)]
pub enum ValueSource {
    /// The content of a file.
    File(PathBuf),
    /// The output of a program with arguments.
    Command(Vec<String>),
}

#[derive(Clone, Debug)]
pub struct ProbeSpec {
    pub target: ProbeTarget,
    pub interval: Duration,
    /// The limit for one evaluation.
    pub timeout: Duration,
}

/// The target of a probe, and the condition to pass.
#[derive(Clone, Debug)]
pub enum ProbeTarget {
    /// `host:port` accepts a TCP connection.
    Tcp(String),
    /// An HTTP GET of the URL returns a 2xx status.
    Http(String),
    /// The file exists.
    File(PathBuf),
    /// The program exits with code 0.
    Command {
        /// The program and its arguments.
        command: Vec<String>,
        /// The probed object, for messages: "ros-topic `/chatter`". Set for a program that
        /// prints the reason why the probe does not pass.
        subject: Option<String>,
    },
}

/// Which probes a check evaluates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProbeSelection {
    All,
    /// Those that start no program.
    Quick,
}

impl ProbeSelection {
    pub(crate) fn of(self, probes: &[ProbeSpec]) -> Vec<ProbeSpec> {
        let is_selected = |probe: &&ProbeSpec| match probe.target {
            ProbeTarget::Tcp(_) | ProbeTarget::Http(_) | ProbeTarget::File(_) => true,
            ProbeTarget::Command { .. } => self == Self::All,
        };
        probes.iter().filter(is_selected).cloned().collect()
    }
}

/// Returns a TCP or HTTP address of a `ready` probe on which another program answers
/// before the process was started.
pub(crate) async fn address_in_use(probes: Option<&Probes>) -> Option<String> {
    let Probes { ready, network, .. } = probes?;
    for probe in ready {
        let address = match &probe.target {
            ProbeTarget::Tcp(address) => address.clone(),
            ProbeTarget::Http(url) => http::address(&Url::parse(url).ok()?)?,
            _ => continue,
        };
        let connection = timeout(ADDRESS_IN_USE_LIMIT, connect(network.as_ref(), &address)).await;
        if matches!(connection, Ok(Ok(_))) {
            return Some(address);
        }
    }
    None
}

/// Evaluates the probes of a process.
#[derive(Debug)]
pub(crate) struct Prober {
    pub spawner: Spawner,
    /// The request of the probed process: commands get its working directory, environment
    /// and namespaces.
    pub template: SpawnRequest,
    pub network: Option<Network>,
}

impl Prober {
    /// Evaluates each of these probes once.
    ///
    /// # Errors
    /// Why one does not pass.
    pub async fn check_all(&self, probes: &[ProbeSpec]) -> Result<(), String> {
        for probe in probes {
            self.check(probe, &FileVersions::default()).await?;
        }
        Ok(())
    }

    /// Polls these probes until one fails; returns the reason.
    pub async fn wait_for_failure(&self, probes: &[ProbeSpec]) -> String {
        let mut due: Vec<_> = probes.iter().map(|probe| Instant::now() + probe.interval).collect();
        loop {
            let next = (0..probes.len()).min_by_key(|index| due[*index]);
            let Some(next) = next else {
                return std::future::pending().await;
            };
            tokio::time::sleep_until(due[next]).await;
            if let Err(reason) = self.check(&probes[next], &FileVersions::default()).await {
                return reason;
            }
            due[next] = Instant::now() + probes[next].interval;
        }
    }

    /// Evaluates a probe once. A file must have changed since `before`.
    ///
    /// # Errors
    /// Why it does not pass.
    pub async fn check(&self, probe: &ProbeSpec, before: &FileVersions) -> Result<(), String> {
        let network = self.network.as_ref();
        let result = async {
            match &probe.target {
                ProbeTarget::Tcp(address) => match connect(network, address).await {
                    Ok(_) => Ok(()),
                    Err(error) => Err(format!("no TCP connection to {address}: {error}")),
                },
                ProbeTarget::Http(url) => check_http(network, url).await,
                ProbeTarget::File(path) => before.check(path),
                ProbeTarget::Command { command, subject } => {
                    self.check_command(command, subject.as_deref()).await
                }
            }
        };
        match timeout(probe.timeout, result).await {
            Ok(result) => result,
            Err(_) => Err(format!("{} did not answer within {:?}", subject(probe), probe.timeout)),
        }
    }

    /// Reads a value once, without white space at its ends. A file must have changed since
    /// `before`. A text of [`MAX_VALUE_BYTES`] may be truncated.
    ///
    /// # Errors
    /// Why there is no value.
    pub async fn read(&self, value: &ValueSpec, before: &FileVersions) -> Result<String, String> {
        let (text, source) = match &value.source {
            ValueSource::File(path) => {
                before.check(path)?;
                let shown = path.display().to_string();
                (read_file(path).map_err(|error| format!("{shown}: {error}"))?, shown)
            }
            ValueSource::Command(command) => {
                let shown = format!("`{}`", shown(command));
                (self.read_output(command, &shown, value.timeout).await?, shown)
            }
        };
        match text.trim() {
            "" => Err(format!("{source} is empty")),
            text => Ok(text.to_owned()),
        }
    }

    async fn read_output(
        &self,
        command: &[String],
        shown: &str,
        limit: Duration,
    ) -> Result<String, String> {
        let run = self.run(command, Streams::StdoutOnly, MAX_VALUE_BYTES);
        match timeout(limit, run).await {
            Ok(Ok((ExitStatus::Code(0), text))) => Ok(text),
            // The command could not write the rest.
            Ok(Ok((_, text))) if text.len() as u64 > MAX_VALUE_BYTES / 2 => Ok(text),
            Ok(Ok((status, _))) => Err(format!("{shown} ended with {status}")),
            Ok(Err(error)) => Err(format!("{shown} cannot run: {}", why(command, &error))),
            Err(_) => Err(format!("{shown} did not answer within {limit:?}")),
        }
    }

    async fn check_command(&self, command: &[String], subject: Option<&str>) -> Result<(), String> {
        let streams = if subject.is_some() { Streams::StdoutOnly } else { Streams::None };
        let shown = shown(command);
        match (self.run(command, streams, MAX_REASON_BYTES).await, subject) {
            (Ok((ExitStatus::Code(0), _)), _) => Ok(()),
            (Ok((_, reason)), Some(_)) if !reason.is_empty() => Err(reason),
            (Ok((status, _)), None) => Err(format!("`{shown}` ended with {status}")),
            (Ok((status, _)), Some(subject)) => {
                Err(format!("the program that asks {subject} ended with {status}"))
            }
            (Err(error), None) => Err(format!("`{shown}` cannot run: {}", why(command, &error))),
            (Err(error), Some(subject)) => Err(format!("{subject} cannot be asked: {error}")),
        }
    }

    /// Runs a program; returns its exit status and, if captured, its output.
    async fn run(
        &self,
        command: &[String],
        streams: Streams,
        max_bytes: u64,
    ) -> std::io::Result<(ExitStatus, String)> {
        let request = SpawnRequest {
            command: command.to_vec(),
            streams,
            channel: None,
            can_fork: false,
            ..self.template.clone()
        };
        let mut process = self.spawner.spawn(request).await?;
        let guard = KillOnDrop(process.pid);
        let mut printed = Vec::new();
        if let Some(stdout) = process.stdout.take() {
            stdout.take(max_bytes).read_to_end(&mut printed).await?;
        }
        let status = process.end.wait().await?;
        std::mem::forget(guard);
        Ok((status, String::from_utf8_lossy(&printed).trim().to_owned()))
    }
}

/// Why a command could not be started.
fn why(command: &[String], error: &std::io::Error) -> String {
    start_failure::describe(command.first().map_or("", String::as_str), error)
}

fn subject(probe: &ProbeSpec) -> String {
    match &probe.target {
        ProbeTarget::Tcp(address) => address.clone(),
        ProbeTarget::Http(url) => url.clone(),
        ProbeTarget::File(path) => path.display().to_string(),
        ProbeTarget::Command { subject: Some(subject), .. } => subject.clone(),
        ProbeTarget::Command { command, .. } => format!("`{}`", shown(command)),
    }
}

async fn check_http(network: Option<&Network>, url: &str) -> Result<(), String> {
    let status = http::get(network, url).await;
    let status = status.map_err(|error| format!("no answer from {url}: {error}"))?;
    if status.is_success() { Ok(()) } else { Err(format!("{url} answers {status}")) }
}

/// The versions of probed files before a process was started: an unchanged file is left
/// over from an earlier start. Compares no times with a clock, which may be set, and may
/// differ from the file system's.
#[derive(Clone, Debug, Default)]
pub(crate) struct FileVersions(BTreeMap<PathBuf, FileVersion>);

/// The properties that change when a file is written or replaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct FileVersion {
    inode: u64,
    size: u64,
    written: (i64, i64),
    changed: (i64, i64),
}

impl FileVersions {
    /// Reads the versions of the files of `ready` probes and values.
    pub fn now(probes: Option<&Probes>) -> Self {
        let ready = probes.into_iter().flat_map(|probes| &probes.ready);
        let ready = ready.filter_map(|probe| match &probe.target {
            ProbeTarget::File(path) => Some(path),
            _ => None,
        });
        let values = probes.into_iter().flat_map(|probes| &probes.values);
        let values = values.filter_map(|value| match &value.source {
            ValueSource::File(path) => Some(path),
            ValueSource::Command(_) => None,
        });
        let paths = ready.chain(values);
        Self(paths.filter_map(|path| Some((path.clone(), version(path).ok()?))).collect())
    }

    fn check(&self, path: &Path) -> Result<(), String> {
        let shown = path.display();
        let now = version(path).map_err(|error| format!("no file {shown}: {error}"))?;
        if self.0.get(path) == Some(&now) {
            return Err(format!("{shown} is from before the start"));
        }
        Ok(())
    }
}

fn read_file(path: &Path) -> std::io::Result<String> {
    let mut text = String::new();
    std::fs::File::open(path)?.take(MAX_VALUE_BYTES).read_to_string(&mut text)?;
    Ok(text)
}

fn version(path: &Path) -> std::io::Result<FileVersion> {
    let file = std::fs::metadata(path)?;
    Ok(FileVersion {
        inode: file.ino(),
        size: file.size(),
        written: (file.mtime(), file.mtime_nsec()),
        changed: (file.ctime(), file.ctime_nsec()),
    })
}

/// A command as in the suite: the plan has made its program absolute.
fn shown(command: &[String]) -> String {
    let mut words: Vec<&str> = command.iter().map(String::as_str).collect();
    if let Some(program) = words.first_mut() {
        *program = program.rsplit('/').next().unwrap_or(program);
    }
    shell_words::join(words)
}

/// Kills a command's tree when its probe times out.
struct KillOnDrop(i32);

impl Drop for KillOnDrop {
    fn drop(&mut self) {
        tree::kill_tree(self.0);
    }
}
