//! This program again, as a child that ends with it.
#![expect(unsafe_code, reason = "what a process does between fork and exec has no safe form")]

use std::ffi::OsStr;
use std::io;
use std::os::unix::process::CommandExt;
use std::process::{Command, Stdio};

use rustix::process::{Pid, Signal};

/// This program in a process group of its own, which a terminal's signals do not
/// reach. It gets SIGTERM when this process dies, however it dies; the thread
/// that starts it has to live as long as it does.
///
/// # Errors
/// It is not known where this program is.
pub fn again<S: AsRef<OsStr>>(args: impl IntoIterator<Item = S>) -> io::Result<Command> {
    let parent = rustix::process::getpid();
    let mut command = Command::new(std::env::current_exe()?);
    command.args(args).stdin(Stdio::null()).process_group(0);
    // SAFETY: only makes system calls, and allocates nothing.
    unsafe { command.pre_exec(move || end_with(parent)) };
    Ok(command)
}

fn end_with(parent: Pid) -> io::Result<()> {
    rustix::process::set_parent_process_death_signal(Some(Signal::TERM))?;
    // It may have died before.
    match rustix::process::getppid() {
        Some(now) if now == parent => Ok(()),
        _ => Err(rustix::io::Errno::SRCH.into()),
    }
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
