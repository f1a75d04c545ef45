//! A gate before a hook's command.
//!
//! When the runner dies just as it starts a hook, the guard must know whether
//! the hook has run. So a command waits behind a gate until the guard knows its
//! process. Whoever opens the gate, the runner or after its death the guard,
//! it is passed once. Plug-ins need none: they wait for `run-test`.
//!
//! The gate is this program once more, so that a hook needs nothing of the
//! suite's `PATH`, and it becomes the command.

use std::ffi::OsString;
use std::io::{BufRead, BufReader, Error, ErrorKind};
use std::os::unix::process::CommandExt;
use std::process::{Command, Stdio};

/// The first argument of a process of this program that is a gate.
pub const WAIT: &str = "--wait-at-gate";
/// This program, also when its file was replaced meanwhile.
const PROGRAM: &str = "/proc/self/exe";
/// The exit codes of a shell for a program that is not there, or cannot be executed.
const NOT_FOUND: i32 = 127;
const NOT_EXECUTED: i32 = 126;
/// The exit code of a gate that nobody opened.
const CLOSED: i32 = 125;

/// What opens the gate.
pub const GO: &[u8] = b"go\n";

/// The command behind a gate. Its process needs a channel, as its standard input.
#[must_use]
pub fn behind(command: &[String]) -> Vec<String> {
    let gate = [PROGRAM, WAIT].into_iter().map(str::to_owned);
    gate.chain(command.iter().cloned()).collect()
}

/// Whether a command waits behind a gate.
#[must_use]
pub fn is_behind(command: &[String]) -> bool {
    command.get(1).is_some_and(|first| first == WAIT)
}

/// Waits for two lines (a host's greeting, which every channel begins with, and
/// [`GO`]), then becomes the command. Returns only if it cannot: an exit code,
/// and why.
pub fn wait(command: impl IntoIterator<Item = OsString>) -> (i32, Error) {
    if let Err(error) = pass() {
        return (CLOSED, error);
    }
    let mut words = command.into_iter();
    let Some(program) = words.next() else {
        return (NOT_FOUND, Error::new(ErrorKind::NotFound, "an empty command"));
    };
    let error = Command::new(program).args(words).stdin(Stdio::null()).exec();
    let code = if error.kind() == ErrorKind::NotFound { NOT_FOUND } else { NOT_EXECUTED };
    (code, error)
}

fn pass() -> Result<(), Error> {
    let mut input = BufReader::new(std::io::stdin().lock());
    for _ in 0..2 {
        let mut line = Vec::new();
        input.read_until(b'\n', &mut line)?;
        if !line.ends_with(b"\n") {
            return Err(Error::from(ErrorKind::UnexpectedEof));
        }
    }
    Ok(())
}
