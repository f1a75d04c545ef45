//! One host, asked with `--check FILE…` (`spec/protocol.md`).

use std::io::{BufRead as _, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::Duration;

use rtf_model::protocol;
use serde::Deserialize;

use super::HostPlan;
use crate::plan::unix;

/// What is asked.
pub(super) struct Request<'a> {
    pub host: &'a HostPlan,
    pub folder: &'a Path,
    pub env: &'a [(String, String)],
    pub files: Vec<&'a Path>,
}

/// What came of one file.
#[derive(Debug)]
pub(super) enum Answer {
    /// The host's word.
    Said(Word),
    /// The host died while it looked at this file.
    Died { how: String, stderr: String },
    /// The host did not come to an end with this file.
    Silent(Duration),
    /// The host does not work at all.
    HostFailed { how: String, stderr: String },
}

/// One line of a host's answer.
#[derive(Debug, Deserialize)]
pub(super) struct Word {
    /// The file, as it was given.
    pub file: String,
    /// Whether it could be loaded.
    pub ok: bool,
    /// Why not.
    pub message: Option<String>,
    /// The line of the file that is to blame.
    pub line: Option<u32>,
    /// `test`, `fixture`: what it holds, as far as can be told.
    pub kinds: Option<Vec<String>>,
}

/// How one start of the host ended.
enum End {
    Exited { how: String, success: bool },
    Silent,
    NotStarted(String),
}

/// What is kept of the host's standard error.
const STDERR_BYTES: u64 = 4096;

/// A line longer than this is not one of the protocol.
const LINE_BYTES: u64 = 1024 * 1024;

/// Asks about all files. A host that dies at one of them is started again for
/// those after it: one bad plug-in does not hide another one.
pub(super) fn ask(request: &Request<'_>, limit: Duration) -> Vec<Answer> {
    let mut answers = Vec::with_capacity(request.files.len());
    while answers.len() < request.files.len() {
        let rest = &request.files[answers.len()..];
        let (words, stderr, end) = start(request, rest, limit);
        let nothing_said = words.is_empty();
        answers.extend(words.into_iter().map(Answer::Said));
        let left = request.files.len() - answers.len();
        if left == 0 {
            break;
        }
        let failed = match end {
            End::Silent => {
                answers.push(Answer::Silent(limit));
                continue;
            }
            // A plug-in may end the process from its constructors. A host that
            // cannot even look at no file at all is at fault itself.
            End::Exited { how, .. } if !nothing_said || works(request, limit) => {
                answers.push(Answer::Died { how, stderr });
                continue;
            }
            End::Exited { how, .. } | End::NotStarted(how) => how,
        };
        let host_failed = |_| Answer::HostFailed { how: failed.clone(), stderr: stderr.clone() };
        answers.extend((0..left).map(host_failed));
    }
    answers
}

/// Whether the host itself works.
fn works(request: &Request<'_>, limit: Duration) -> bool {
    matches!(start(request, &[], limit).2, End::Exited { success: true, .. })
}

fn start(request: &Request<'_>, files: &[&Path], limit: Duration) -> (Vec<Word>, String, End) {
    let mut child = match spawn(request, files) {
        Ok(child) => child,
        Err(error) => {
            let how = format!("it cannot be started: {error}");
            return (Vec::new(), String::new(), End::NotStarted(how));
        }
    };
    let lines = read_lines(&mut child);
    let errors = read_errors(&mut child);
    let mut words = Vec::new();
    let end = loop {
        match lines.recv_timeout(limit) {
            Ok(line) => words.extend(word(&line, files.get(words.len()))),
            Err(RecvTimeoutError::Timeout) => {
                unix::kill_group(&mut child);
                break End::Silent;
            }
            Err(RecvTimeoutError::Disconnected) => break ended(child, limit),
        }
    };
    // What the plug-in's children may still write is not waited for.
    let stderr = errors.recv_timeout(Duration::from_millis(200)).unwrap_or_default();
    (words, stderr, end)
}

fn spawn(request: &Request<'_>, files: &[&Path]) -> std::io::Result<Child> {
    let (program, arguments) = request.host.command.split_first().ok_or_else(|| {
        std::io::Error::new(std::io::ErrorKind::NotFound, "the host has no program")
    })?;
    let mut command = Command::new(program);
    command.args(arguments).arg("--check").args(files).current_dir(request.folder);
    command.envs(request.env.iter().map(|(name, value)| (name, value)));
    command.envs(request.host.env.iter().map(|(name, value)| (name, value)));
    command.env_remove(protocol::CHANNEL_VARIABLE);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    unix::in_own_group(&mut command);
    command.spawn()
}

/// How a host ended that closed its output. One that does not end then is
/// killed: all its answers are there.
fn ended(child: Child, limit: Duration) -> End {
    match unix::wait(child, limit) {
        Some(status) => End::Exited { how: unix::describe(status), success: status.success() },
        None => End::Silent,
    }
}

/// A line of the host, if it is about the file that is next. What plug-ins
/// print while they are loaded is not.
fn word(line: &[u8], next: Option<&&Path>) -> Option<Word> {
    let word: Word = serde_json::from_slice(line).ok()?;
    (next?.to_str() == Some(&word.file)).then_some(word)
}

fn read_lines(child: &mut Child) -> Receiver<Vec<u8>> {
    let (sender, receiver) = sync_channel(64);
    let stdout = child.stdout.take();
    std::thread::spawn(move || {
        let Some(stdout) = stdout else { return };
        let mut reader = BufReader::new(stdout);
        loop {
            let mut line = Vec::new();
            let read = reader.by_ref().take(LINE_BYTES).read_until(b'\n', &mut line);
            if !matches!(read, Ok(1..)) || sender.send(line).is_err() {
                return;
            }
        }
    });
    receiver
}

fn read_errors(child: &mut Child) -> Receiver<String> {
    let (sender, receiver) = sync_channel(1);
    let stderr = child.stderr.take();
    std::thread::spawn(move || {
        let Some(mut stderr) = stderr else { return };
        let mut kept = Vec::new();
        let _ = stderr.by_ref().take(STDERR_BYTES).read_to_end(&mut kept);
        // The rest is read so that the host never waits for us.
        let _ = std::io::copy(&mut stderr, &mut std::io::sink());
        let _ = sender.send(String::from_utf8_lossy(&kept).trim_end().to_owned());
    });
    receiver
}
