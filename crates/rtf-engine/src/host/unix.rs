//! The system calls behind [`crate::host`].
#![expect(unsafe_code, reason = "file descriptors by number, and of processes")]

use std::io;
use std::mem::MaybeUninit;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::os::unix::net::UnixStream;
use std::time::Duration;

use rtf_model::ExitStatus;
use rustix::io::{FdFlags, fcntl_getfd, fcntl_setfd, retry_on_intr};
use rustix::net::sockopt::{Timeout, set_socket_timeout};
use rustix::net::{
    AddressFamily, RecvFlags, SendAncillaryBuffer, SendAncillaryMessage, SendFlags, SocketFlags,
    SocketType, sendmsg,
};
use rustix::process::{Pid, PidfdFlags, Signal, WaitId, WaitIdOptions, WaitOptions};
use tokio::io::unix::AsyncFd;

/// How long a server of forks may take for an answer: it does nothing slow.
const ANSWER_LIMIT: Duration = Duration::from_secs(5);

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

/// A connected pair of sockets that keep packets apart, both close-on-exec.
/// Ours does not wait for ever.
pub fn packet_pair() -> io::Result<(OwnedFd, OwnedFd)> {
    let (kind, flags) = (SocketType::SEQPACKET, SocketFlags::CLOEXEC);
    let (ours, theirs) = rustix::net::socketpair(AddressFamily::UNIX, kind, flags, None)?;
    set_socket_timeout(&ours, Timeout::Recv, Some(ANSWER_LIMIT))?;
    set_socket_timeout(&ours, Timeout::Send, Some(ANSWER_LIMIT))?;
    Ok((ours, theirs))
}

/// Sends a packet, and descriptors with it.
pub fn send_with(socket: BorrowedFd<'_>, packet: &[u8], fds: &[BorrowedFd<'_>]) -> io::Result<()> {
    let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(3))];
    let mut control = SendAncillaryBuffer::new(&mut space);
    if !control.push(SendAncillaryMessage::ScmRights(fds)) {
        return Err(io::Error::from(io::ErrorKind::InvalidInput));
    }
    let packet = [io::IoSlice::new(packet)];
    retry_on_intr(|| sendmsg(socket, &packet, &mut control, SendFlags::NOSIGNAL))?;
    Ok(())
}

/// Waits for a short packet.
pub fn receive_packet(socket: BorrowedFd<'_>) -> io::Result<Vec<u8>> {
    let mut packet = vec![0; 4096];
    let (length, _) = retry_on_intr(|| rustix::net::recv(socket, &mut packet, RecvFlags::empty()))?;
    packet.truncate(length);
    Ok(packet)
}

/// What becomes readable when a process ends.
///
/// # Panics
/// Outside of a tokio runtime.
pub fn open_process(pid: i32) -> io::Result<AsyncFd<OwnedFd>> {
    let pid = Pid::from_raw(pid).ok_or(io::ErrorKind::InvalidInput)?;
    let process = rustix::process::pidfd_open(pid, PidfdFlags::empty())?;
    // SAFETY: an `OwnedFd` keeps its descriptor open, and the same, to its end.
    Ok(unsafe { AsyncFd::register(process) }?)
}

/// Takes the exit status of a child whose end was told; `None` when it lives.
pub fn take_status(process: BorrowedFd<'_>) -> io::Result<Option<ExitStatus>> {
    let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG;
    let Some(status) = rustix::process::waitid(WaitId::PidFd(process), options)? else {
        return Ok(None);
    };
    let code = status.exit_status().map(ExitStatus::Code);
    Ok(code.or_else(|| status.terminating_signal().map(ExitStatus::Signal)))
}

/// Whether a process is a child of this one, alive or not yet waited for.
pub fn is_child(pid: i32) -> bool {
    let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
    Pid::from_raw(pid).is_some_and(|pid| rustix::process::waitid(WaitId::Pid(pid), options).is_ok())
}

/// Makes a child the leader of a process group of its own.
pub fn lead_group(pid: i32) {
    // When it has done so itself already, or is gone, nothing is to be done.
    let _ = rustix::process::setpgid(Pid::from_raw(pid), Pid::from_raw(pid));
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

/// Waits for the end of a child that was killed.
pub fn await_end(pid: i32) {
    if let Some(pid) = Pid::from_raw(pid) {
        let _ = rustix::process::waitpid(Some(pid), WaitOptions::empty());
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
