//! A worker: `rtf run` with a list of episodes, in a separate process with a guard and a journal.
//!
//! It is started by a command line, not by a request: it resolves `rtf.toml`, the environment and
//! the terminal on the machine where it runs, which may be a node of a cluster.

use std::ffi::{OsStr, OsString};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use rtf_report::escape;
use rtf_run::campaign::directory::CampaignDir;
use rtf_run::error::Failure;
use rtf_run::operator::campaign::OPERATOR_ON_STDIN;
use rtf_run::spawn_self;

/// The file with what a worker printed.
const OUTPUT: &str = "output.txt";

/// The command of a worker with a list of episodes.
pub fn command(
    dir: &CampaignDir,
    number: u32,
    list: &OsStr,
    shutdown_timeout: Duration,
) -> Result<Command, Failure> {
    let description = &dir.description;
    // It runs in the directory in which the campaign was started.
    let results = std::path::absolute(dir.worker(number)).map_err(Failure::internal)?;
    // The worker may have run before.
    let output = File::options().create(true).append(true).open(results.join(OUTPUT));
    let output = output.map_err(Failure::internal)?;
    let mut args: Vec<OsString> = vec!["run".into(), description.suite.clone().into()];
    args.extend(["--color", "never", "--no-history"].map(Into::into));
    args.push(format!("--shutdown-timeout={}ms", shutdown_timeout.as_millis()).into());
    args.extend(["--results".into(), results.into()]);
    args.extend(["--episodes".into(), list.into()]);
    args.extend(description.options.iter().map(Into::into));
    let mut command = spawn_self::command(args).map_err(Failure::internal)?;
    command.envs(description.variables.iter().map(|(name, value)| (name, value)));
    command.current_dir(&description.working_dir);
    command.stdout(output.try_clone().map_err(Failure::internal)?).stderr(Stdio::from(output));
    Ok(command)
}

/// Makes a worker start no hosts to check the plug-ins.
pub const CHECKED: &str = "--checked";

/// Who answers the questions of workers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answers {
    /// The operator at the terminal of this process.
    Operator,
    /// No user.
    Nobody,
    /// No user, because of `--no-input`.
    NoInput,
}

/// The command of a worker with a file of episodes. It ends when its standard input is closed,
/// also if this process is killed.
pub fn command_with_list(
    dir: &CampaignDir,
    number: u32,
    list: &Path,
    (shutdown_timeout, answers): (Duration, Answers),
) -> Result<Command, Failure> {
    let list = std::path::absolute(list).map_err(Failure::internal)?;
    let mut command = command(dir, number, list.as_os_str(), shutdown_timeout)?;
    match answers {
        Answers::Operator => command.arg(OPERATOR_ON_STDIN),
        Answers::Nobody => command.arg(spawn_self::END_WITH_STDIN),
        Answers::NoInput => command.args([spawn_self::END_WITH_STDIN, "--no-input"]),
    };
    Ok(command)
}

/// The failure of a worker that does not work: how it ended, and the files with what it printed, of
/// which `shown` is shown.
pub fn failure(how: &str, outputs: &[PathBuf], shown: impl Fn(&str) -> String) -> Failure {
    let texts: Vec<_> = outputs.iter().map(|file| shown(&last_lines(file))).collect();
    let files: Vec<_> = outputs.iter().map(|file| format!("`{}`", file.display())).collect();
    let error = format!("{how}:\n{}", texts.join("\n").trim());
    Failure::internal(error).hint(format!("its output is in {}", files.join(" and ")))
}

/// How a worker ended.
pub fn ending(number: u32, code: Option<u8>) -> String {
    match code {
        Some(code) => format!("worker {number} ended with exit code {code}"),
        None => format!("worker {number} was killed"),
    }
}

/// The file with what a worker printed.
pub fn output(dir: &CampaignDir, number: u32) -> PathBuf {
    dir.worker(number).join(OUTPUT)
}

/// The last lines of a file, for a terminal.
fn last_lines(file: &Path) -> String {
    let text = std::fs::read_to_string(file).unwrap_or_default();
    let lines: Vec<_> = text.trim_end().lines().map(escape::line).collect();
    lines[lines.len().saturating_sub(20)..].join("\n")
}
