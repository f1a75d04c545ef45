//! Calls to the operating system.
#![expect(unsafe_code, reason = "inherited descriptors and C functions that have no safe form")]

use std::ffi::c_int;
use std::fs::File;
use std::io;
use std::os::fd::{BorrowedFd, FromRawFd, RawFd};
use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::Command;

use rustix::io::FdFlags;
use rustix::net::SendFlags;

/// The signals that the C libraries use themselves. Their `posix_spawn` starts programs that ignore
/// them, and their functions refuse them.
const LIBRARY_SIGNALS: std::ops::RangeInclusive<c_int> = 32..=34;
/// The size of the kernel's set of signals.
const KERNEL_SET_BYTES: usize = 8;
/// At least the size of the kernel's `sigaction`; all zeroes are the default action.
const KERNEL_ACTION_BYTES: usize = 64;

/// Makes a command start with no signal blocked, and none ignored by a C library, as a shell starts
/// programs. The runner has the same for the programs that it starts.
pub fn reset_signals(command: &mut Command) {
    let reset = || {
        let action = [0_u8; KERNEL_ACTION_BYTES];
        for signal in LIBRARY_SIGNALS {
            let (new, old) = (action.as_ptr(), std::ptr::null_mut::<u8>());
            // SAFETY: the kernel reads the action.
            unsafe { libc::syscall(libc::SYS_rt_sigaction, signal, new, old, KERNEL_SET_BYTES) };
        }
        // SAFETY: the set is initialised before it is used.
        unsafe {
            let mut none = std::mem::zeroed::<libc::sigset_t>();
            libc::sigemptyset(&raw mut none);
            libc::sigprocmask(libc::SIG_SETMASK, &raw const none, std::ptr::null_mut());
        }
        Ok(())
    };
    // SAFETY: between fork and exec, only system calls are made.
    unsafe { command.pre_exec(reset) };
}

/// Takes over a descriptor that the runner left open for this process, and
/// closes it in programs that the plug-in starts.
pub(crate) fn take_channel(fd: RawFd) -> std::io::Result<UnixStream> {
    // SAFETY: if the descriptor is not open, the call fails, and nothing takes ownership.
    let borrowed = unsafe { BorrowedFd::borrow_raw(fd) };
    let flags = rustix::io::fcntl_getfd(borrowed)?;
    rustix::io::fcntl_setfd(borrowed, flags | FdFlags::CLOEXEC)?;
    rustix::io::ioctl_fionbio(borrowed, false)?;
    // SAFETY: it is open, and RTF_CHANNEL, which is removed, gives it to this process.
    Ok(unsafe { UnixStream::from_raw_fd(fd) })
}

/// Removes a variable that the plug-in and its children must not see.
pub(crate) fn remove_variable(name: &str) {
    // SAFETY: called while the process has one thread.
    unsafe { std::env::remove_var(name) }
}

/// Sets a variable before a plug-in is loaded.
pub(crate) fn set_variable(name: &str, value: &str) {
    // SAFETY: the other thread, which reads the channel, does not use the environment. Threads
    // that an earlier plug-in of a shared host has left may: its author has chosen to share.
    unsafe { std::env::set_var(name, value) }
}

/// Undoes what Rust's start-up does to `SIGPIPE`: the plug-in and the programs
/// that it starts expect the signal as the shell would leave it.
pub(crate) fn restore_sigpipe() {
    // SAFETY: sets a disposition; no handler of ours is involved.
    unsafe { libc::signal(libc::SIGPIPE, libc::SIG_DFL) };
}

/// A thread's function.
pub(crate) type Body = Box<dyn FnOnce() + Send>;

/// Starts a thread that no signal reaches. A plug-in that blocks a signal and
/// waits for it in its own threads would otherwise be killed through ours.
///
/// The standard library's threads allocate when they start, and the second
/// thread that allocates gets a separate heap, which is too slow for a host.
pub(crate) fn spawn_thread(stack_bytes: usize, body: Body) -> std::io::Result<()> {
    let argument = Box::into_raw(Box::new(body));
    // SAFETY: every set and attribute is initialised before it is used;
    // `argument` belongs to the thread, or to us again when there is none.
    let error = unsafe {
        let mut all = std::mem::zeroed::<libc::sigset_t>();
        let mut before = std::mem::zeroed::<libc::sigset_t>();
        let mut attributes = std::mem::zeroed::<libc::pthread_attr_t>();
        let mut thread = std::mem::zeroed::<libc::pthread_t>();
        libc::pthread_attr_init(&raw mut attributes);
        libc::pthread_attr_setstacksize(&raw mut attributes, stack_bytes);
        libc::pthread_attr_setdetachstate(&raw mut attributes, libc::PTHREAD_CREATE_DETACHED);
        libc::sigfillset(&raw mut all);
        libc::pthread_sigmask(libc::SIG_SETMASK, &raw const all, &raw mut before);
        let start = &raw const attributes;
        let error = libc::pthread_create(&raw mut thread, start, run_body, argument.cast());
        libc::pthread_sigmask(libc::SIG_SETMASK, &raw const before, std::ptr::null_mut());
        libc::pthread_attr_destroy(&raw mut attributes);
        error
    };
    if error == 0 {
        return Ok(());
    }
    // SAFETY: no thread was started that could have taken it.
    drop(unsafe { Box::from_raw(argument) });
    Err(std::io::Error::from_raw_os_error(error))
}

extern "C" fn run_body(argument: *mut libc::c_void) -> *mut libc::c_void {
    #[cfg(target_os = "linux")]
    // SAFETY: the name ends with a zero and is short enough.
    unsafe {
        libc::prctl(libc::PR_SET_NAME, c"rtf-channel".as_ptr());
    }
    // SAFETY: made by `spawn_thread` for this thread alone.
    let body = unsafe { Box::from_raw(argument.cast::<Body>()) };
    body();
    std::ptr::null_mut()
}

unsafe extern "C" {
    #[cfg_attr(target_os = "macos", link_name = "__stdoutp")]
    static stdout: *mut libc::FILE;
}

/// Makes C's standard output line-buffered, so that a crash does not lose printed lines.
/// C++'s streams use it.
pub(crate) fn buffer_output_by_lines() {
    // SAFETY: nothing was written to the stream yet, and the process has one thread.
    unsafe { libc::setvbuf(stdout, std::ptr::null_mut(), libc::_IOLBF, 0) };
}

/// Opens a regular file. The error for anything else names its type; opening a FIFO does
/// not wait for its other end.
pub(crate) fn open_regular(path: &Path) -> io::Result<File> {
    let flags = libc::O_NONBLOCK | libc::O_NOCTTY;
    let file = File::options().read(true).custom_flags(flags).open(path)?;
    let kind = file.metadata()?.file_type();
    let file_type = match () {
        () if kind.is_file() => return Ok(file),
        () if kind.is_dir() => "a directory",
        () if kind.is_fifo() => "a FIFO",
        () => "a device or a socket",
    };
    Err(io::Error::other(format!("it is {file_type}, not a file")))
}

/// Flushes C's streams, to which plug-ins print.
pub fn flush_output() {
    // SAFETY: null means all output streams; they are locked while written.
    unsafe { libc::fflush(std::ptr::null_mut()) };
}

/// Ends the process at once: no destructors, no handlers, no flushing.
pub(crate) fn exit_now(code: c_int) -> ! {
    // SAFETY: ends the process.
    unsafe { libc::_exit(code) }
}

/// Sends all bytes. A closed channel is an error, not a signal.
pub(crate) fn send_all(channel: &UnixStream, mut bytes: &[u8]) -> rustix::io::Result<()> {
    while !bytes.is_empty() {
        let sent =
            rustix::io::retry_on_intr(|| rustix::net::send(channel, bytes, SendFlags::NOSIGNAL))?;
        bytes = &bytes[sent..];
    }
    Ok(())
}

/// Returns the standard output under another number. From then on, number 1 is the
/// standard error.
pub(crate) fn divert_stdout() -> std::io::Result<std::fs::File> {
    let output = rustix::io::fcntl_dupfd_cloexec(rustix::stdio::stdout(), 3)?;
    rustix::stdio::dup2_stdout(rustix::stdio::stderr())?;
    Ok(output.into())
}
