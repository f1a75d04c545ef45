//! The system calls of this crate.
#![expect(unsafe_code, reason = "file descriptors by number, and of processes")]

use std::io;
use std::mem::MaybeUninit;
use std::os::fd::{AsFd, AsRawFd, BorrowedFd, OwnedFd};
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::process::Command;
use std::time::Duration;

use rtf_model::ExitStatus;
use rustix::io::{FdFlags, fcntl_getfd, fcntl_setfd, retry_on_intr};
use rustix::net::sockopt::{Timeout, set_socket_timeout};
use rustix::net::{AddressFamily, RecvFlags, SocketFlags, SocketType};
use rustix::process::{Pid, PidfdFlags, Signal, WaitId, WaitIdOptions, WaitOptions};
use tokio::io::unix::AsyncFd;

/// A fork server replies at once.
const REPLY_LIMIT: Duration = Duration::from_secs(5);

/// Prepares this process to run tests: inherited descriptors do not leak into plug-ins,
/// and the process adopts orphans of plug-ins.
///
/// # Errors
/// The kernel refused to make it a child subreaper, or `/proc` does not show this
/// process.
pub fn prepare_process() -> io::Result<()> {
    check_proc(std::fs::read_link("/proc/self"), std::process::id())?;
    for fd in inherited_descriptors() {
        // SAFETY: the number was just listed as open, and nothing closes
        // descriptors this early in the process.
        let fd = unsafe { BorrowedFd::borrow_raw(fd) };
        let _ = fcntl_setfd(fd, FdFlags::CLOEXEC);
    }
    adopt_orphans()
}

/// Makes this process a child subreaper: it becomes the parent of processes below it whose
/// parent has ended.
///
/// # Errors
/// The kernel, or an emulator, refused.
pub fn adopt_orphans() -> io::Result<()> {
    rustix::process::set_child_subreaper(Some(rustix::process::getpid())).map_err(|error| {
        let error = io::Error::from(error);
        let text = format!(
            "rtf cannot become the parent of processes that tests leave behind, which qemu \
             emulates since version 10: prctl(PR_SET_CHILD_SUBREAPER): {error}"
        );
        io::Error::new(error.kind(), text)
    })
}

/// Checks that `/proc` shows this PID namespace. Otherwise the state of a fixture would
/// be another process's.
fn check_proc(shown: io::Result<std::path::PathBuf>, own: u32) -> io::Result<()> {
    let shown = shown.map_err(unreadable_proc)?;
    if shown.to_str() == Some(own.to_string().as_str()) {
        return Ok(());
    }
    Err(io::Error::other(
        "`/proc` shows the processes of another PID namespace: mount the one of this namespace, \
         for example with `unshare --pid --fork --mount-proc`",
    ))
}

/// Explains that `/proc` is required.
pub fn unreadable_proc(error: io::Error) -> io::Error {
    let text = format!("rtf needs `/proc`, which cannot be read: {error}");
    io::Error::new(error.kind(), text)
}

fn inherited_descriptors() -> Vec<i32> {
    let Ok(entries) = std::fs::read_dir("/proc/self/fd") else {
        return Vec::new();
    };
    let numbers = entries.flatten().filter_map(|entry| entry.file_name().to_str()?.parse().ok());
    numbers.filter(|fd| *fd >= 3).filter(|fd| is_open(*fd)).collect()
}

fn is_open(fd: i32) -> bool {
    // SAFETY: a closed number only makes the call fail.
    let fd = unsafe { BorrowedFd::borrow_raw(fd) };
    fcntl_getfd(fd).is_ok()
}

/// Returns a connected pair of stream sockets, both close-on-exec. The first one, ours,
/// receives the sender's process id with each message.
pub fn channel_pair() -> io::Result<(UnixStream, UnixStream)> {
    let (ours, theirs) = UnixStream::pair()?;
    #[cfg(target_os = "linux")]
    rustix::net::sockopt::set_socket_passcred(&ours, true)?;
    Ok((ours, theirs))
}

/// The process that wrote to a channel. Zero if unknown: a process that is not visible
/// from this PID namespace, and every process on systems other than Linux.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Sender(pub i32);

/// Receives bytes that one process wrote to a channel: their number, zero at the end of
/// the channel, and the process. The kernel does not join bytes of different processes.
#[cfg(target_os = "linux")]
pub fn receive_from(channel: BorrowedFd<'_>, bytes: &mut [u8]) -> io::Result<(usize, Sender)> {
    /// Space for credentials only: the kernel discards descriptors sent with them.
    #[repr(C)]
    struct CredentialsBuffer {
        header: libc::cmsghdr,
        credentials: libc::ucred,
    }
    let mut part = libc::iovec { iov_base: bytes.as_mut_ptr().cast(), iov_len: bytes.len() };
    let mut control = MaybeUninit::<CredentialsBuffer>::uninit();
    // SAFETY: all fields may be zero.
    let mut message: libc::msghdr = unsafe { std::mem::zeroed() };
    (message.msg_iov, message.msg_iovlen) = (&raw mut part, 1);
    message.msg_control = control.as_mut_ptr().cast();
    message.msg_controllen = size_of::<CredentialsBuffer>();
    let length = loop {
        let flags = libc::MSG_CMSG_CLOEXEC;
        // SAFETY: `message` names `bytes` and `control`, which are valid for writing.
        let length = unsafe { libc::recvmsg(channel.as_raw_fd(), &raw mut message, flags) };
        match usize::try_from(length) {
            Ok(length) => break length,
            Err(_) => {
                let error = io::Error::last_os_error();
                if error.kind() != io::ErrorKind::Interrupted {
                    return Err(error);
                }
            }
        }
    };
    // SAFETY: the kernel wrote `msg_controllen` bytes; a header of this kind is followed
    // by credentials.
    let sender = unsafe {
        let header = libc::CMSG_FIRSTHDR(&raw const message);
        let has_credentials = !header.is_null()
            && (*header).cmsg_level == libc::SOL_SOCKET
            && (*header).cmsg_type == libc::SCM_CREDENTIALS;
        let credentials = || libc::CMSG_DATA(header).cast::<libc::ucred>().read_unaligned();
        Sender(if has_credentials { credentials().pid } else { 0 })
    };
    Ok((length, sender))
}

/// Receives bytes from a channel; the sender is unknown.
#[cfg(not(target_os = "linux"))]
pub fn receive_from(channel: BorrowedFd<'_>, bytes: &mut [u8]) -> io::Result<(usize, Sender)> {
    let (length, _) =
        retry_on_intr(|| rustix::net::recv(channel, &mut *bytes, RecvFlags::empty()))?;
    Ok((length, Sender(0)))
}

/// Returns a connected pair of packet sockets, both close-on-exec. Ours has time limits.
pub fn packet_pair() -> io::Result<(OwnedFd, OwnedFd)> {
    let (kind, flags) = (SocketType::SEQPACKET, SocketFlags::CLOEXEC);
    let (ours, theirs) = rustix::net::socketpair(AddressFamily::UNIX, kind, flags, None)?;
    set_socket_timeout(&ours, Timeout::Recv, Some(REPLY_LIMIT))?;
    set_socket_timeout(&ours, Timeout::Send, Some(REPLY_LIMIT))?;
    Ok((ours, theirs))
}

/// Waits for a short packet; no longer than the socket's limit.
pub fn receive_packet(socket: BorrowedFd<'_>) -> io::Result<Vec<u8>> {
    let mut packet = vec![0; 4096];
    let (length, _) = retry_on_intr(|| rustix::net::recv(socket, &mut packet, RecvFlags::empty()))?;
    packet.truncate(length);
    Ok(packet)
}

/// Opens a descriptor that becomes readable when the process ends.
///
/// # Panics
/// Outside of a tokio runtime.
pub fn open_process(pid: i32) -> io::Result<AsyncFd<OwnedFd>> {
    let pid = Pid::from_raw(pid).ok_or(io::ErrorKind::InvalidInput)?;
    let process = rustix::process::pidfd_open(pid, PidfdFlags::empty())?;
    // SAFETY: an `OwnedFd` keeps its descriptor open, and the same, to its end.
    Ok(unsafe { AsyncFd::register(process) }?)
}

/// Reaps a child that has ended; `None` while it is alive.
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

/// Makes this process, and those that it starts from now on, ignore SIGTSTP.
pub fn ignore_suspension() {
    // SAFETY: no handler is replaced that anything relies on.
    unsafe { libc::signal(libc::SIGTSTP, libc::SIG_IGN) };
}

/// Makes a child the leader of a new process group.
pub fn lead_group(pid: i32) {
    // Fails if it leads a group already or has ended.
    let _ = rustix::process::setpgid(Pid::from_raw(pid), Pid::from_raw(pid));
}

/// Makes a descriptor inheritable by the next process that is started.
pub fn let_inherit(fd: impl AsFd) -> io::Result<()> {
    Ok(fcntl_setfd(fd, FdFlags::empty())?)
}

/// Runs `act`, which must only make system calls, in a command's process before it
/// executes its program.
pub fn before_exec(
    command: &mut Command,
    act: impl FnMut() -> io::Result<()> + Send + Sync + 'static,
) {
    // SAFETY: between fork and exec, only system calls are made.
    unsafe { command.pre_exec(act) };
}

/// Moves this process, which must have one thread only, into a namespace of this kind.
pub fn enter_namespace(namespace: BorrowedFd<'_>, kind: i32) -> io::Result<()> {
    // SAFETY: it has no memory arguments.
    match unsafe { libc::setns(namespace.as_raw_fd(), kind) } {
        -1 => Err(io::Error::last_os_error()),
        _ => Ok(()),
    }
}

/// Sends a signal to a process group, if it exists.
pub fn signal_group(pid: i32, signal: i32) {
    send_signal(pid, signal, rustix::process::kill_process_group);
}

/// Sends a signal to a process, if it exists.
pub fn signal_process(pid: i32, signal: i32) {
    send_signal(pid, signal, rustix::process::kill_process);
}

fn send_signal(pid: i32, signal: i32, kill: impl Fn(Pid, Signal) -> rustix::io::Result<()>) {
    if let (Some(pid), Some(signal)) = (Pid::from_raw(pid), Signal::from_named_raw(signal)) {
        let _ = kill(pid, signal);
    }
}

/// Reaps an adopted orphan. Does not wait.
pub fn reap(pid: i32) {
    if let Some(pid) = Pid::from_raw(pid) {
        let _ = rustix::process::waitpid(Some(pid), WaitOptions::NOHANG);
    }
}

/// Waits for the end of a killed child.
pub fn await_end(pid: i32) {
    if let Some(pid) = Pid::from_raw(pid) {
        let _ = rustix::process::waitpid(Some(pid), WaitOptions::empty());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_proc_of_another_namespace_and_a_missing_one_are_reported() {
        let of = |pid: &str| Ok(std::path::PathBuf::from(pid));
        assert!(check_proc(of("7"), 7).is_ok());
        let error = check_proc(of("4711"), 7).unwrap_err().to_string();
        assert!(error.contains("another PID namespace"), "{error}");
        let missing = Err(io::ErrorKind::NotFound.into());
        let error = check_proc(missing, 7).unwrap_err().to_string();
        assert!(error.starts_with("rtf needs `/proc`, which cannot be read"), "{error}");
    }
}
