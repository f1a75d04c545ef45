//! Runs a host with `--check FILE…` (`spec/protocol.md`), and reads its reports.

use std::io::{BufRead as _, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::Duration;

use rtf_model::protocol;
use rtf_plan::plan::{CheckAnswer, CheckGroup, CheckReport};

use super::unix;

enum HostEnd {
    Exited { how: String, success: bool },
    Silent,
    NotStarted(String),
}

/// The longest standard error of a host.
const STDERR_BYTES: u64 = 4096;

/// The longest line of the protocol: a list of 50 000 cases with long names.
const LINE_BYTES: u64 = 64 * 1024 * 1024;

/// Checks all files. A host that dies at one of them is restarted for the files
/// after it, so that one bad plug-in does not hide another.
pub(super) fn check(group: &CheckGroup, files: &[&Path], limit: Duration) -> Vec<CheckAnswer> {
    let limit = group.limit(limit);
    let mut answers = Vec::with_capacity(files.len());
    while answers.len() < files.len() {
        let rest = &files[answers.len()..];
        let (reports, stderr, end) = start(group, rest, limit);
        let no_report = reports.is_empty();
        answers.extend(reports.into_iter().map(CheckAnswer::Report));
        let left = files.len() - answers.len();
        if left == 0 {
            break;
        }
        let failed = match end {
            HostEnd::Silent => {
                answers.push(CheckAnswer::Silent(limit));
                continue;
            }
            // A constructor of a plug-in may end the process. A host that also fails without
            // files is itself at fault.
            HostEnd::Exited { how, .. } if !no_report || works(group, limit) => {
                answers.push(CheckAnswer::Died { how, stderr });
                continue;
            }
            HostEnd::Exited { how, .. } | HostEnd::NotStarted(how) => how,
        };
        let host_failed =
            |_| CheckAnswer::HostFailed { how: failed.clone(), stderr: stderr.clone() };
        answers.extend((0..left).map(host_failed));
    }
    answers
}

/// Whether the host works without files.
fn works(group: &CheckGroup, limit: Duration) -> bool {
    matches!(start(group, &[], limit).2, HostEnd::Exited { success: true, .. })
}

fn start(
    group: &CheckGroup,
    files: &[&Path],
    limit: Duration,
) -> (Vec<CheckReport>, String, HostEnd) {
    let mut child = match spawn(group, files) {
        Ok(child) => child,
        Err(error) => {
            let how = format!("it cannot be started: {error}");
            return (Vec::new(), String::new(), HostEnd::NotStarted(how));
        }
    };
    let lines = read_lines(&mut child);
    let errors = read_errors(&mut child);
    let mut reports = Vec::new();
    let end = loop {
        match lines.recv_timeout(limit) {
            Ok(line) => reports.extend(report(&line, files.get(reports.len()))),
            Err(RecvTimeoutError::Timeout) => {
                unix::kill_group(&mut child);
                break HostEnd::Silent;
            }
            Err(RecvTimeoutError::Disconnected) => break ended(child, limit),
        }
    };
    // Children of the plug-in may hold standard error open.
    let stderr = errors.recv_timeout(Duration::from_millis(200)).unwrap_or_default();
    (reports, stderr, end)
}

fn spawn(group: &CheckGroup, files: &[&Path]) -> std::io::Result<Child> {
    let (program, arguments) = group.host.command.split_first().ok_or_else(|| {
        std::io::Error::new(std::io::ErrorKind::NotFound, "the host has no program")
    })?;
    let mut command = Command::new(program);
    command.args(arguments).arg("--check").args(files).current_dir(&group.folder);
    if !files.is_empty() && !group.arguments.is_empty() {
        command.arg("--").args(&group.arguments);
    }
    command.envs(group.env.iter().map(|(name, value)| (name, value)));
    command.envs(group.host.env.iter().map(|(name, value)| (name, value)));
    command.env_remove(protocol::CHANNEL_VARIABLE);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    unix::in_own_group(&mut command);
    rtf_process::reset_signals(&mut command);
    command.spawn()
}

/// Waits for the end of a host that has closed its output, and kills it after the limit.
fn ended(child: Child, limit: Duration) -> HostEnd {
    match unix::wait(child, limit) {
        Some(status) => HostEnd::Exited { how: unix::describe(status), success: status.success() },
        None => HostEnd::Silent,
    }
}

/// Parses a report about the next file. Plug-ins may print other lines while they are loaded.
fn report(line: &[u8], next: Option<&&Path>) -> Option<CheckReport> {
    let report: CheckReport = serde_json::from_slice(line).ok()?;
    (next?.to_str() == Some(&report.file)).then_some(report)
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
        // Discards the rest, so that the host does not block.
        let _ = std::io::copy(&mut stderr, &mut std::io::sink());
        let _ = sender.send(String::from_utf8_lossy(&kept).trim_end().to_owned());
    });
    receiver
}
