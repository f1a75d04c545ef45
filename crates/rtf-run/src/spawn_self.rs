//! Starts this program as a child process that ends with this process.

use std::ffi::OsStr;
use std::io;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::process::{Command, ExitStatus, Stdio};

use rustix::process::{Pid, Signal};

use crate::exit;

/// Makes a run end when its standard input closes.
pub const END_WITH_STDIN: &str = "--end-with-stdin";

/// Creates a command for this program in a separate process group, which a terminal's
/// signals do not reach.
///
/// With [`END_WITH_STDIN`], the run ends when this process dies and so closes the pipe.
/// The signal of `PR_SET_PDEATHSIG` could arrive several times if the parent has several
/// threads.
///
/// # Errors
/// The path of this program is unknown.
pub fn command<S: AsRef<OsStr>>(args: impl IntoIterator<Item = S>) -> io::Result<Command> {
    let mut command = Command::new(std::env::current_exe()?);
    command.args(args).stdin(Stdio::piped()).process_group(0);
    Ok(command)
}

/// The process of a child that has not been waited for.
pub fn pid(id: u32) -> Option<Pid> {
    Pid::from_raw(id.cast_signed())
}

/// Sends a signal, unless the process has ended.
pub fn signal(pid: Pid, number: i32) {
    if let Some(signal) = Signal::from_named_raw(number) {
        let _ = rustix::process::kill_process(pid, signal);
    }
}

/// The exit code of a child, as shells report it.
pub fn exit_code(status: ExitStatus) -> u8 {
    let code = status.code().and_then(|code| u8::try_from(code).ok());
    code.or_else(|| status.signal().map(exit::of_signal)).unwrap_or(exit::BROKEN)
}
