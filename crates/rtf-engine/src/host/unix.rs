//! The system calls behind [`crate::host`].
#![expect(unsafe_code, reason = "file descriptors of this process are marked by number")]

use std::io;
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;

use rtf_model::ExitStatus;
use rustix::io::{FdFlags, fcntl_getfd, fcntl_setfd};
use rustix::process::{Pid, Signal, WaitOptions};

/// Makes this process fit to run tests: nothing that it inherited leaks into
/// plug-ins, and orphans of plug-ins come back to it.
///
/// # Errors
/// The kernel refused to make it a child subreaper.
pub fn prepare_process() -> io::Result<()> {
    for fd in inherited_descriptors() {
        // SAFETY: the number was just listed as open, and nothing closes
        // descriptors this early in the process.
        let fd = unsafe { BorrowedFd::borrow_raw(fd) };
        let _ = fcntl_setfd(fd, FdFlags::CLOEXEC);
    }
    rustix::process::set_child_subreaper(Some(rustix::process::getpid()))?;
    Ok(())
}

fn inherited_descriptors() -> Vec<i32> {
    let Ok(entries) = std::fs::read_dir("/proc/self/fd") else {
        return Vec::new();
    };
    let numbers = entries.flatten().filter_map(|entry| entry.file_name().to_str()?.parse().ok());
    numbers.filter(|fd| *fd >= 3).filter(|fd| is_open(*fd)).collect()
}

fn is_open(fd: i32) -> bool {
    // SAFETY: a number that is not open any more makes the call fail, no more.
    let fd = unsafe { BorrowedFd::borrow_raw(fd) };
    fcntl_getfd(fd).is_ok()
}

/// A connected pair of stream sockets, both close-on-exec.
pub fn channel_pair() -> io::Result<(UnixStream, UnixStream)> {
    UnixStream::pair()
}

/// Lets the next process that is started inherit this descriptor.
pub fn let_inherit(fd: impl AsFd) -> io::Result<()> {
    Ok(fcntl_setfd(fd, FdFlags::empty())?)
}

/// Sends a signal to a process group; whether there was one.
pub fn signal_group(pid: i32, signal: i32) -> bool {
    with(pid, signal, rustix::process::kill_process_group)
}

/// Sends a signal to a process; whether there was one.
pub fn signal_process(pid: i32, signal: i32) -> bool {
    with(pid, signal, rustix::process::kill_process)
}

fn with(pid: i32, signal: i32, kill: impl Fn(Pid, Signal) -> rustix::io::Result<()>) -> bool {
    match (Pid::from_raw(pid), Signal::from_named_raw(signal)) {
        (Some(pid), Some(signal)) => kill(pid, signal).is_ok(),
        _ => false,
    }
}

/// Takes the exit status of a child that was not started by this process
/// itself but came to it as an orphan. Does not wait.
pub fn reap(pid: i32) {
    if let Some(pid) = Pid::from_raw(pid) {
        let _ = rustix::process::waitpid(Some(pid), WaitOptions::NOHANG);
    }
}

/// How a process ended, in our own words.
pub fn exit_status(status: std::process::ExitStatus) -> ExitStatus {
    use std::os::unix::process::ExitStatusExt;
    match (status.code(), status.signal()) {
        (Some(code), _) => ExitStatus::Code(code),
        (None, Some(signal)) => ExitStatus::Signal(signal),
        (None, None) => ExitStatus::Code(-1),
    }
}
