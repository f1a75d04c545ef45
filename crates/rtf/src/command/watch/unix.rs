//! The process of a round.
#![expect(unsafe_code, reason = "what a process does between fork and exec has no safe form")]

use std::ffi::OsString;
use std::io;
use std::path::Path;
use std::process::Stdio;

use rustix::process::{Pid, Signal};
use tokio::process::{Child, Command};

/// Starts a program in a process group of its own, which a terminal's signals
/// do not reach. It gets SIGTERM when this process dies, however it dies; the
/// calling thread has to live as long as the process.
pub fn start(program: &Path, args: &[OsString]) -> io::Result<Child> {
    let watcher = rustix::process::getpid();
    let mut command = Command::new(program);
    command.args(args).stdin(Stdio::null()).process_group(0);
    // SAFETY: only makes system calls, and allocates nothing.
    unsafe { command.pre_exec(move || end_with(watcher)) };
    command.spawn()
}

fn end_with(watcher: Pid) -> io::Result<()> {
    rustix::process::set_parent_process_death_signal(Some(Signal::TERM))?;
    // It may have died before.
    match rustix::process::getppid() {
        Some(parent) if parent == watcher => Ok(()),
        _ => Err(rustix::io::Errno::SRCH.into()),
    }
}

/// Sends a signal, unless the process has ended.
pub fn signal(child: &Child, number: i32) {
    let pid = child.id().and_then(|pid| Pid::from_raw(pid.cast_signed()));
    if let (Some(pid), Some(signal)) = (pid, Signal::from_named_raw(number)) {
        // Its end is told in another way.
        let _ = rustix::process::kill_process(pid, signal);
    }
}
