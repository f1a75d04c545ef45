//! What the host asks of the operating system.
#![expect(
    unsafe_code,
    reason = "inherited descriptors and C functions that have no safe form"
)]

use std::os::fd::{BorrowedFd, FromRawFd, RawFd};
use std::os::unix::net::UnixStream;

use rustix::io::FdFlags;
use rustix::net::SendFlags;

/// Takes over a descriptor that the runner left open for this process, and
/// keeps it from the programs that the plug-in starts.
pub(crate) fn take_channel(fd: RawFd) -> std::io::Result<UnixStream> {
    // SAFETY: the descriptor is only looked at here; when it is not open, the
    // call says so and nothing takes ownership.
    let borrowed = unsafe { BorrowedFd::borrow_raw(fd) };
    let flags = rustix::io::fcntl_getfd(borrowed)?;
    rustix::io::fcntl_setfd(borrowed, flags | FdFlags::CLOEXEC)?;
    rustix::io::ioctl_fionbio(borrowed, false)?;
    // SAFETY: it is open, and RTF_CHANNEL gives it to this process; the
    // variable is removed, so that nobody takes it twice.
    Ok(unsafe { UnixStream::from_raw_fd(fd) })
}

/// Removes a variable that the plug-in and its children must not see.
pub(crate) fn remove_variable(name: &str) {
    // SAFETY: called while the process has one thread.
    unsafe { std::env::remove_var(name) }
}

/// Undoes what Rust's start-up does to `SIGPIPE`: the plug-in and the programs
/// that it starts expect the signal as the shell would leave it.
pub(crate) fn restore_sigpipe() {
    // SAFETY: sets a disposition; no handler of ours is involved.
    unsafe { libc::signal(libc::SIGPIPE, libc::SIG_DFL) };
}

/// Keeps signals away from the calling thread. A plug-in that blocks a signal
/// and waits for it in its own threads would otherwise be killed through ours.
pub(crate) fn block_signals() {
    let mut all = std::mem::MaybeUninit::<libc::sigset_t>::uninit();
    // SAFETY: sigfillset initialises the set before it is used.
    unsafe {
        libc::sigfillset(all.as_mut_ptr());
        libc::pthread_sigmask(libc::SIG_SETMASK, all.as_ptr(), std::ptr::null_mut());
    }
}

/// Ends the process at once: no destructors, no handlers, no flushing.
pub(crate) fn end_now() -> ! {
    // SAFETY: ends the process.
    unsafe { libc::_exit(1) }
}

/// Sends all bytes. A channel that is closed is an error here, not a signal.
pub(crate) fn send_all(channel: &UnixStream, mut bytes: &[u8]) -> rustix::io::Result<()> {
    while !bytes.is_empty() {
        let sent =
            rustix::io::retry_on_intr(|| rustix::net::send(channel, bytes, SendFlags::NOSIGNAL))?;
        bytes = &bytes[sent..];
    }
    Ok(())
}

/// The standard output under a number of its own; what is written to number 1
/// from now on goes to the standard error.
pub(crate) fn divert_stdout() -> std::io::Result<std::fs::File> {
    let kept = rustix::io::fcntl_dupfd_cloexec(rustix::stdio::stdout(), 3)?;
    rustix::stdio::dup2_stdout(rustix::stdio::stderr())?;
    Ok(kept.into())
}
