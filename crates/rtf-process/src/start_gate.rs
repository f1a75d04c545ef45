//! The start gate: a process waits until its command may run.
//!
//! If the runner dies while it starts a hook, the guard must know whether the hook has
//! run. So a command waits behind a gate until the guard knows its process; then the
//! runner, or after its death the guard, opens it. Plug-ins need no gate: they wait for
//! `run-test`.
//!
//! The gate executes this program, not one of the suite's `PATH`, and then the command.

use std::ffi::OsString;
use std::io::{BufRead, BufReader, Error, ErrorKind};
use std::os::unix::process::CommandExt;
use std::process::{Command, Stdio};

/// The first argument of this program when it is a gate.
pub const WAIT_ARGUMENT: &str = "--wait-at-gate";
/// This program, even if its file was replaced.
const PROGRAM: &str = "/proc/self/exe";
/// A shell's exit codes for a program that is missing, or cannot be executed.
const NOT_FOUND: i32 = 127;
const NOT_EXECUTED: i32 = 126;
/// The exit code if the gate is not opened.
const CLOSED: i32 = 125;

/// The line that opens the gate.
pub const GO: &[u8] = b"go\n";

/// Puts a command behind a gate. Its process needs a channel as its standard input.
pub fn behind(command: &[String]) -> Vec<String> {
    let gate = [PROGRAM, WAIT_ARGUMENT].into_iter().map(str::to_owned);
    gate.chain(command.iter().cloned()).collect()
}

/// Whether a command waits behind a gate.
pub fn is_behind(command: &[String]) -> bool {
    command.get(1).is_some_and(|first| first == WAIT_ARGUMENT)
}

/// Waits for two lines, the greeting of every channel and [`GO`], and then executes the
/// command. Returns only if it cannot: the exit code and the reason.
pub fn wait(command: impl IntoIterator<Item = OsString>) -> (i32, Error) {
    if let Err(error) = wait_for_lines() {
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

fn wait_for_lines() -> Result<(), Error> {
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
