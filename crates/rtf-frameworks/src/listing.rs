//! Runs a program that lists its cases.

use std::ffi::OsStr;
use std::io::Read;
use std::os::unix::process::CommandExt as _;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use rtf_model::protocol::SESSION_VARIABLE;
use rtf_model::{INTERPRETER_BYTES, Interpreter};
use rtf_process::tree;
use rustix::process::{Pid, Signal, kill_process_group};

use crate::framework::ListError;
use crate::own_child;

/// The limit of most programs that list their cases.
pub const LIST_LIMIT: Duration = Duration::from_secs(60);

/// The longest part of the output that an error quotes.
const QUOTED_BYTES: usize = 2000;

/// What a program printed, and how it ended.
#[derive(Debug)]
pub struct Listed {
    pub stdout: Vec<u8>,
    pub stderr: Vec<u8>,
    /// How it ended.
    pub status: ExitStatus,
}

impl Listed {
    /// The end of its output, for an error message; standard error if there is any.
    #[must_use]
    pub fn quote(&self) -> String {
        let is_blank = self.stderr.trim_ascii().is_empty();
        let text = if is_blank { &self.stdout } else { &self.stderr };
        let start = text.len().saturating_sub(QUOTED_BYTES);
        String::from_utf8_lossy(text[start..].trim_ascii()).into_owned()
    }

    /// An error about the program, with the end of its output.
    #[must_use]
    pub fn error(&self, message: String) -> ListError {
        let quote = self.quote();
        ListError::new(match quote.is_empty() {
            true => message,
            false => format!("{message}\nit printed\n{quote}"),
        })
    }

    /// The error about a program that listed nothing with these options of a framework.
    #[must_use]
    pub fn not_of(&self, framework: &str, file: &Path, options: &str) -> ListError {
        let (name, status) = (file_name(file), self.status);
        self.error(format!(
            "`{name}` is no {framework} program: `{options}` lists nothing ({status})"
        ))
    }
}

/// Runs a command that writes its list to a file, whose path is passed to `command`. Returns also
/// the contents of the file, if there is one.
///
/// # Errors
/// There can be no file; as for [`run`].
pub fn run_with_file(
    command: impl FnOnce(&Path) -> Command,
) -> Result<(Vec<u8>, Listed), ListError> {
    let dir = tempfile::tempdir().map_err(|error| ListError::new(error.to_string()))?;
    let file = dir.path().join("list");
    let listed = run(command(&file), LIST_LIMIT)?;
    Ok((std::fs::read(&file).unwrap_or_default(), listed))
}

/// Runs a command to its end, in a new process group, which is killed after the limit and
/// at the end.
///
/// # Errors
/// It cannot be started, or takes longer than the limit.
pub fn run(mut command: Command, limit: Duration) -> Result<Listed, ListError> {
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.process_group(0).env_remove(SESSION_VARIABLE);
    let program = command.get_program().to_string_lossy().into_owned();
    rtf_host::reset_signals(&mut command);
    let started = own_child::spawn(&mut command);
    let mut child =
        started.map_err(|error| ListError::new(not_started(command.get_program(), &error)))?;
    let pid = Pid::from_child(&child);
    let (stdout, stderr) = (read(child.stdout.take()), read(child.stderr.take()));
    let (sender, ended) = channel();
    std::thread::spawn(move || {
        let status = child.wait();
        tree::remove_own_child(child.id().cast_signed());
        sender.send(status)
    });
    let status = match ended.recv_timeout(limit) {
        Ok(status) => status,
        Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {
            kill(pid);
            let message = format!("`{program}` did not list its cases within {limit:?}");
            return Err(ListError::new(message));
        }
    };
    // Children that it left may hold its output open.
    kill(pid);
    let text = |reader: std::thread::JoinHandle<Vec<u8>>| reader.join().unwrap_or_default();
    let status = status.map_err(|error| ListError::new(format!("`{program}`: {error}")))?;
    Ok(Listed { stdout: text(stdout), stderr: text(stderr), status })
}

fn kill(pid: Pid) {
    // Fails if all of them have ended.
    let _ = kill_process_group(pid, Signal::KILL);
}

fn read(stream: Option<impl Read + Send + 'static>) -> std::thread::JoinHandle<Vec<u8>> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut stream) = stream {
            drop(stream.read_to_end(&mut bytes));
        }
        bytes
    })
}

/// Debian's packages with the programs that frameworks need.
const PACKAGES: [(&str, &str); 6] = [
    ("cargo", "cargo"),
    ("ctest", "cmake"),
    ("go", "golang-go"),
    ("java", "default-jre-headless"),
    ("python3", "python3"),
    ("rostest", "python3-rostest"),
];

/// The message for a program that cannot be started, with what installs it.
#[must_use]
pub fn not_started(program: &OsStr, error: &std::io::Error) -> String {
    let program = program.to_string_lossy();
    let interpreter = interpreter_problem(Path::new(&*program));
    let why = interpreter.unwrap_or_else(|| error.to_string());
    let message = format!("`{program}` cannot be started: {why}");
    let package = PACKAGES.iter().find(|(name, _)| *name == program);
    match package.filter(|_| error.kind() == std::io::ErrorKind::NotFound) {
        Some((_, package)) => format!("{message}\nDebian's package is `{package}`"),
        None => message,
    }
}

/// Why a file cannot be started although it exists: its interpreter is missing.
fn interpreter_problem(program: &Path) -> Option<String> {
    let mut head = Vec::new();
    let file = std::fs::File::open(program).ok()?;
    file.take(INTERPRETER_BYTES as u64).read_to_end(&mut head).ok()?;
    let problem = Interpreter::of(&head)?.problem(|path| Path::new(path).exists())?;
    Some(format!("{} ({})", problem.message, problem.hint))
}

/// Refuses arguments that `rtf` sets itself.
///
/// # Errors
/// There is such an argument.
pub fn refuse_reserved(args: &[String], reserved_names: &[&str]) -> Result<(), ListError> {
    match reserved(args, reserved_names) {
        Some(name) => {
            let message = format!("`{name}` is set by rtf; select cases with `cases`");
            Err(ListError::new(message))
        }
        None => Ok(()),
    }
}

/// The first argument that `rtf` sets itself, and its name without a value.
#[must_use]
pub fn reserved<'a>(args: &'a [String], reserved: &[&str]) -> Option<&'a str> {
    let name = |arg: &'a String| arg.split('=').next().unwrap_or(arg);
    args.iter().map(name).find(|name| reserved.contains(name))
}

/// A file name, for messages.
#[must_use]
pub fn file_name(file: &Path) -> String {
    file.file_name().unwrap_or(OsStr::new("?")).to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_program_is_named_with_its_package() {
        let missing = std::io::Error::from(std::io::ErrorKind::NotFound);
        let message = not_started(OsStr::new("go"), &missing);
        assert!(message.ends_with("\nDebian's package is `golang-go`"), "{message}");
        let message = not_started(OsStr::new("./arm_test"), &missing);
        assert!(!message.contains("Debian"), "{message}");
        let dir = tempfile::tempdir().unwrap();
        let script = dir.path().join("test.sh");
        std::fs::write(&script, "#!/usr/bin/nowhere\n").unwrap();
        let message = not_started(script.as_os_str(), &missing);
        assert!(message.contains("its interpreter `/usr/bin/nowhere` does not exist"), "{message}");
        let denied = std::io::Error::from(std::io::ErrorKind::PermissionDenied);
        assert!(!not_started(OsStr::new("go"), &denied).contains("Debian"));
    }

    #[test]
    fn a_program_that_lists_for_too_long_is_killed() {
        let mut command = Command::new("sh");
        command.args(["-c", "sleep 600 & sleep 600"]);
        let error = run(command, Duration::from_millis(100)).unwrap_err();
        assert!(error.message.contains("did not list its cases within 100ms"), "{error}");
    }
}
