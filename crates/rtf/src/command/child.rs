//! This program again, as a child that ends with it.

use std::ffi::OsStr;
use std::io;
use std::os::unix::process::CommandExt;
use std::process::{Command, Stdio};

use rustix::process::{Pid, Signal};

/// The option with which a run notices the end of its standard input.
pub const OPTION: &str = "--end-with-stdin";

/// This program in a process group of its own, which a terminal's signals do not
/// reach. With [`OPTION`] among its arguments it ends when its standard input
/// does, which this process has to hold open: when it dies, however it dies, the
/// run is asked to end, once. The kernel's own signal for that, of
/// `PR_SET_PDEATHSIG`, may come several times from a parent with several threads.
///
/// # Errors
/// It is not known where this program is.
pub fn again<S: AsRef<OsStr>>(args: impl IntoIterator<Item = S>) -> io::Result<Command> {
    let mut command = Command::new(std::env::current_exe()?);
    command.args(args).stdin(Stdio::piped()).process_group(0);
    Ok(command)
}

/// The process of a child that was not waited for.
pub fn pid(id: u32) -> Option<Pid> {
    Pid::from_raw(id.cast_signed())
}

/// Sends a signal. Its end is told in another way, when it has ended.
pub fn signal(pid: Pid, number: i32) {
    if let Some(signal) = Signal::from_named_raw(number) {
        let _ = rustix::process::kill_process(pid, signal);
    }
}
