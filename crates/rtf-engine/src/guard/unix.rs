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

use super::requests::Requests;

/// The number of requests to end the run after which nobody is waited for.
const KILLS: u32 = 3;

/// Signals that ask for the end of the run.
pub const ASKING: [i32; 3] = [libc::SIGINT, libc::SIGTERM, libc::SIGHUP];

/// All that the guard takes care of.
const TAKEN: [i32; 6] =
    [libc::SIGINT, libc::SIGTERM, libc::SIGHUP, libc::SIGQUIT, libc::SIGTSTP, libc::SIGCHLD];

/// Where the handler writes the numbers of signals.
static NOTED: AtomicI32 = AtomicI32::new(-1);

/// Makes two processes of this one: `Some` with the child's id in the parent.
pub fn fork() -> io::Result<Option<i32>> {
    if std::fs::read_dir("/proc/self/task").map_err(unreadable_proc)?.count() != 1 {
        return Err(io::Error::other("the process has threads already"));
    }
    // SAFETY: this is the only thread, so no lock is held by another one, and
    // the child may do whatever the parent may.
    match unsafe { libc::fork() } {
        -1 => Err(io::Error::last_os_error()),
        0 => Ok(None),
        child => Ok(Some(child)),
    }
}

/// Gives a process (this one when `None`) a group of its own.
pub fn own_group(pid: Option<i32>) {
    let pid = pid.and_then(Pid::from_raw);
    // The other side may have done it.
    let _ = rustix::process::setpgid(pid, pid);
}

/// A background process may write to its terminal, unless `stty tostop` is set:
/// then SIGTTOU would stop it, which must not happen to one that supervises a robot.
pub fn write_to_terminal_from_behind() {
    change_mask(libc::SIG_BLOCK, &set_of(&[libc::SIGTTOU]));
}

/// Keeps the memory of this process from being swapped out, where it may: what is
/// there, and of the rest what is used.
pub fn stay_in_memory() {
    // SAFETY: it changes nothing but where pages are. One that may not does without.
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

/// While it lives, the signals that the guard takes care of wait.
pub struct Held(libc::sigset_t);

impl Held {
    /// Lets them wait.
    pub fn hold() -> Self {
        Self(change_mask(libc::SIG_BLOCK, &set_of(&TAKEN)))
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        change_mask(libc::SIG_SETMASK, &self.0);
    }
}

/// The signals that came, to be polled and read.
#[derive(Debug)]
pub struct Signals {
    noted: OwnedFd,
    /// The requests to end the run.
    pub requests: Requests,
}

impl Signals {
    /// Takes the signals from now on. Handlers, unlike a mask, are not
    /// inherited by the programs that the guard starts.
    pub fn install() -> io::Result<Self> {
        let (noted, note) = rustix::pipe::pipe_with(PipeFlags::CLOEXEC | PipeFlags::NONBLOCK)?;
        // It is open until the process ends: a handler may run at any time.
        NOTED.store(note.into_raw_fd(), Ordering::Release);
        for signal in TAKEN {
            // After `nohup`, the terminal's end is not the run's.
            if signal != libc::SIGHUP || !is_ignored(signal) {
                take(signal)?;
            }
        }
        Ok(Self { noted, requests: Requests::default() })
    }

    /// The signals that came since the last call. Of those that ask for the end
    /// of the run, only new requests.
    pub fn read(&mut self) -> Vec<i32> {
        let mut numbers = [0; 256];
        let read = rustix::io::read(&self.noted, &mut numbers[..]).unwrap_or(0);
        let came = numbers[..read].iter().map(|number| i32::from(*number));
        let now = Instant::now();
        came.filter(|signal| !ASKING.contains(signal) || self.requests.take(now)).collect()
    }

    /// Whether nobody is waited for any more.
    #[must_use]
    pub fn kill(&self) -> bool {
        self.requests.made() >= KILLS
    }
}

impl AsFd for Signals {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.noted.as_fd()
    }
}

fn is_ignored(signal: i32) -> bool {
    let mut action = MaybeUninit::<libc::sigaction>::zeroed();
    // SAFETY: a null action only asks; all zeroes are a valid `sigaction`.
    unsafe {
        libc::sigaction(signal, std::ptr::null(), action.as_mut_ptr());
        action.assume_init().sa_sigaction == libc::SIG_IGN
    }
}

/// Lets a write beyond the limit of file sizes (`ulimit -f`) fail, which is
/// reported, instead of ending the process. A handler, unlike an ignored signal,
/// is not inherited by the programs that this process starts.
///
/// # Errors
/// The system refused.
pub fn survive_file_size_limit() -> io::Result<()> {
    handle(libc::SIGXFSZ, ignore)
}

extern "C" fn ignore(_: libc::c_int) {}

fn take(signal: i32) -> io::Result<()> {
    handle(signal, note)
}

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

extern "C" fn note(signal: libc::c_int) {
    let number = u8::try_from(signal).unwrap_or(0);
    // SAFETY: `write` and `errno` may be used in a handler; the descriptor is
    // never closed. A pipe that is full has woken the reader already.
    unsafe {
        let errno = libc::__errno_location();
        let before = *errno;
        libc::write(NOTED.load(Ordering::Acquire), (&raw const number).cast(), 1);
        *errno = before;
    }
}

/// How a child of this process ended, if it has; it is gone then. `Err` when
/// there is no such child (any more).
pub fn ended(pid: i32) -> Result<Option<ExitStatus>, Errno> {
    let pid = Pid::from_raw(pid).ok_or(Errno::CHILD)?;
    let status = rustix::process::waitpid(Some(pid), WaitOptions::NOHANG)?;
    Ok(status.map(|(_, status)| in_our_words(status)))
}

fn in_our_words(status: WaitStatus) -> ExitStatus {
    match (status.exit_status(), status.terminating_signal()) {
        (Some(code), _) => ExitStatus::Code(code),
        (None, Some(signal)) => ExitStatus::Signal(signal),
        (None, None) => ExitStatus::Code(-1),
    }
}
