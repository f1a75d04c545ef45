//! The system calls behind the guard.
#![expect(unsafe_code, reason = "fork, signal masks and handlers have no safe form")]

use std::io;
use std::mem::MaybeUninit;
use std::os::fd::{AsFd, BorrowedFd, IntoRawFd, OwnedFd};
use std::sync::atomic::{AtomicI32, Ordering};
use std::time::Instant;

use rtf_model::ExitStatus;
use rtf_process::unreadable_proc;
use rustix::io::Errno;
use rustix::pipe::PipeFlags;
use rustix::process::{Pid, WaitOptions, WaitStatus};

use super::stop_requests::StopRequests;

/// The number of requests after which hooks are killed.
const KILL_REQUESTS: u32 = 3;

/// The signals that request the end of the run.
pub const STOP_SIGNALS: [i32; 3] = [libc::SIGINT, libc::SIGTERM, libc::SIGHUP];

const HANDLED_SIGNALS: [i32; 6] =
    [libc::SIGINT, libc::SIGTERM, libc::SIGHUP, libc::SIGQUIT, libc::SIGTSTP, libc::SIGCHLD];

/// The pipe to which the handler writes the numbers of signals.
static SIGNAL_PIPE: AtomicI32 = AtomicI32::new(-1);

/// Forks this process, before it starts a thread: `Some` with the child's id in the parent.
///
/// Only debug builds count the threads: an emulator, such as qemu, has its own in each process.
pub fn fork() -> io::Result<Option<i32>> {
    let threads = std::fs::read_dir("/proc/self/task").map_err(unreadable_proc)?.count();
    if cfg!(debug_assertions) && threads != 1 {
        return Err(io::Error::other("the process has threads already"));
    }
    // SAFETY: this is the only thread of the program, so no other one holds a lock, and the
    // child may do all that the parent may.
    match unsafe { libc::fork() } {
        -1 => Err(io::Error::last_os_error()),
        0 => Ok(None),
        child => Ok(Some(child)),
    }
}

/// Makes a process, this one when `None`, the leader of a new group.
pub fn lead_group(pid: Option<i32>) {
    let pid = pid.and_then(Pid::from_raw);
    // Fails if the other process has done so.
    let _ = rustix::process::setpgid(pid, pid);
}

/// Blocks SIGTTOU: with `stty tostop`, it would stop a background process that writes to its
/// terminal, which must not happen to one that supervises a robot.
pub fn permit_background_output() {
    change_mask(libc::SIG_BLOCK, &set_of(&[libc::SIGTTOU]));
}

/// Prevents the used memory of this process from being swapped out, if permitted.
pub fn lock_memory() {
    // SAFETY: it only changes where pages are.
    unsafe { libc::mlockall(libc::MCL_CURRENT | libc::MCL_ONFAULT) };
}

fn set_of(signals: &[i32]) -> libc::sigset_t {
    let mut set = MaybeUninit::uninit();
    // SAFETY: `sigemptyset` initialises the set that it is given.
    let mut set = unsafe {
        libc::sigemptyset(set.as_mut_ptr());
        set.assume_init()
    };
    for signal in signals {
        // SAFETY: the set is initialised, and numbers that are none are refused.
        unsafe { libc::sigaddset(&mut set, *signal) };
    }
    set
}

fn change_mask(how: i32, set: &libc::sigset_t) -> libc::sigset_t {
    let mut before = set_of(&[]);
    // SAFETY: both point to sets that live until the call returns.
    unsafe { libc::pthread_sigmask(how, set, &mut before) };
    before
}

/// Blocks the signals that the guard handles, until it is dropped.
pub struct BlockedSignals(libc::sigset_t);

impl BlockedSignals {
    pub fn block() -> Self {
        Self(change_mask(libc::SIG_BLOCK, &set_of(&HANDLED_SIGNALS)))
    }
}

impl Drop for BlockedSignals {
    fn drop(&mut self) {
        change_mask(libc::SIG_SETMASK, &self.0);
    }
}

/// The received signals, to be polled and read.
#[derive(Debug)]
pub struct GuardSignals {
    pipe: OwnedFd,
    pub requests: StopRequests,
}

impl GuardSignals {
    /// Installs the handlers. Unlike a mask, programs that the guard starts do not inherit
    /// them.
    pub fn install() -> io::Result<Self> {
        let (pipe, writer) = rustix::pipe::pipe_with(PipeFlags::CLOEXEC | PipeFlags::NONBLOCK)?;
        // Never closed: a handler may run at any time.
        SIGNAL_PIPE.store(writer.into_raw_fd(), Ordering::Release);
        for signal in HANDLED_SIGNALS {
            // `nohup` ignores SIGHUP.
            if signal != libc::SIGHUP || !is_ignored(signal) {
                handle(signal, write_to_pipe)?;
            }
        }
        Ok(Self { pipe, requests: StopRequests::default() })
    }

    /// Returns the signals since the last call. GuardSignals that belong to an earlier request are
    /// left out.
    pub fn read(&mut self) -> Vec<i32> {
        let mut numbers = [0; 256];
        let read = rustix::io::read(&self.pipe, &mut numbers[..]).unwrap_or(0);
        let received = numbers[..read].iter().map(|number| i32::from(*number));
        let now = Instant::now();
        received
            .filter(|signal| !STOP_SIGNALS.contains(signal) || self.requests.record(now))
            .collect()
    }

    /// Whether hooks are killed.
    pub fn requests_kill(&self) -> bool {
        self.requests.count() >= KILL_REQUESTS
    }
}

impl AsFd for GuardSignals {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.pipe.as_fd()
    }
}

fn is_ignored(signal: i32) -> bool {
    let mut action = MaybeUninit::<libc::sigaction>::zeroed();
    // SAFETY: a null action only queries; all zeroes are a valid `sigaction`.
    unsafe {
        libc::sigaction(signal, std::ptr::null(), action.as_mut_ptr());
        action.assume_init().sa_sigaction == libc::SIG_IGN
    }
}

/// Makes a write beyond the file size limit (`ulimit -f`) fail instead of ending the
/// process. Unlike an ignored signal, programs that this process starts do not inherit the
/// handler.
///
/// # Errors
/// The system refused.
pub fn survive_file_size_limit() -> io::Result<()> {
    handle(libc::SIGXFSZ, ignore)
}

/// Makes Ctrl-Z have no effect on this process while it has the terminal, as on the guard.
///
/// # Errors
/// The system refused.
pub fn survive_terminal_stop() -> io::Result<()> {
    handle(libc::SIGTSTP, ignore)
}

extern "C" fn ignore(_: libc::c_int) {}

fn handle(signal: i32, handler: extern "C" fn(libc::c_int)) -> io::Result<()> {
    // SAFETY: all zeroes are a valid `sigaction`, and the handlers of this file
    // do only what a handler may.
    let handled = unsafe {
        let mut action = MaybeUninit::<libc::sigaction>::zeroed().assume_init();
        action.sa_sigaction = handler as libc::sighandler_t;
        action.sa_flags = libc::SA_RESTART | libc::SA_NOCLDSTOP;
        libc::sigaction(signal, &action, std::ptr::null_mut())
    };
    if handled == 0 { Ok(()) } else { Err(io::Error::last_os_error()) }
}

extern "C" fn write_to_pipe(signal: libc::c_int) {
    let number = u8::try_from(signal).unwrap_or(0);
    // SAFETY: `write` and `errno` may be used in a handler; the descriptor is never closed.
    // A full pipe has woken the reader already.
    unsafe {
        let errno = libc::__errno_location();
        let before = *errno;
        libc::write(SIGNAL_PIPE.load(Ordering::Acquire), (&raw const number).cast(), 1);
        *errno = before;
    }
}

/// Reaps a child of this process if it has ended. `Err` if there is no such child.
pub fn ended(pid: i32) -> Result<Option<ExitStatus>, Errno> {
    let pid = Pid::from_raw(pid).ok_or(Errno::CHILD)?;
    let status = rustix::process::waitpid(Some(pid), WaitOptions::NOHANG)?;
    Ok(status.map(|(_, status)| exit_status(status)))
}

fn exit_status(status: WaitStatus) -> ExitStatus {
    match (status.exit_status(), status.terminating_signal()) {
        (Some(code), _) => ExitStatus::Code(code),
        (None, Some(signal)) => ExitStatus::Signal(signal),
        (None, None) => ExitStatus::Code(-1),
    }
}
