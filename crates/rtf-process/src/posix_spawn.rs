//! Starts programs with the signals that a shell starts them with: none is blocked, and none is
//! ignored that the runner ignores for itself.
//!
//! The runner blocks SIGTTOU, Rust ignores SIGPIPE, and `posix_spawn` of glibc and musl ignores the
//! signals that they use themselves: a program could not tell a cancelled thread from one that
//! its user wants to survive. What the user has ignored, as `nohup` does, remains ignored.
#![expect(unsafe_code, reason = "posix_spawn and signal masks have no safe form")]

use std::ffi::{CString, OsStr, OsString};
use std::io;
use std::mem::MaybeUninit;
use std::os::fd::{AsRawFd, OwnedFd};
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::ptr;

use crate::unix;

/// The signals of the C libraries, which their functions for sets refuse.
const LIBRARY_SIGNALS: std::ops::RangeInclusive<usize> = 32..=34;
/// The size of the kernel's set of signals.
const KERNEL_SET_BYTES: usize = 8;
/// At least the size of the kernel's `sigaction`; all zeroes are the default action.
const KERNEL_ACTION_BYTES: usize = 64;
/// Where programs are searched without `PATH`.
const DEFAULT_PATH: &str = "/bin:/usr/bin";

/// The standard streams of a process; inherited where `None`.
pub type Streams = [Option<OwnedFd>; 3];

/// Makes a command start with default signals, in a process that is forked.
pub fn reset_signals(command: &mut Command) {
    unix::before_exec(command, || {
        let action = [0_u8; KERNEL_ACTION_BYTES];
        for signal in LIBRARY_SIGNALS {
            // SAFETY: the kernel reads the action, and the C library refuses these signals.
            unsafe {
                let (new, old) = (action.as_ptr(), ptr::null_mut::<u8>());
                libc::syscall(libc::SYS_rt_sigaction, signal, new, old, KERNEL_SET_BYTES);
            }
        }
        let none = empty_set();
        // SAFETY: the set is initialised. SIGPIPE is reset by the standard library.
        unsafe { libc::sigprocmask(libc::SIG_SETMASK, &raw const none, ptr::null_mut()) };
        Ok(())
    });
}

fn empty_set() -> libc::sigset_t {
    let mut set = MaybeUninit::uninit();
    // SAFETY: it initialises the set.
    unsafe {
        libc::sigemptyset(set.as_mut_ptr());
        set.assume_init()
    }
}

/// The signals that the runner does not ignore for its user.
fn reset_set() -> libc::sigset_t {
    let mut set = empty_set();
    // SAFETY: the set is initialised.
    unsafe { libc::sigaddset(&raw mut set, libc::SIGPIPE) };
    let words: *mut libc::c_ulong = (&raw mut set).cast();
    for signal in LIBRARY_SIGNALS {
        let (word, bit) = ((signal - 1) / BITS, (signal - 1) % BITS);
        // SAFETY: a set is an array of words with a bit for each signal.
        unsafe { *words.add(word) |= 1 << bit };
    }
    set
}

const BITS: usize = libc::c_ulong::BITS as usize;

/// Starts a command in a new process group, and returns its process. Of the command, only the
/// program, its arguments, environment and directory are used.
///
/// # Errors
/// The program is missing, or cannot be executed.
pub fn spawn(command: &Command, streams: &Streams) -> io::Result<i32> {
    let environment = environment(command);
    let program = c_string(program(command, &environment)?.into_os_string())?;
    let args = std::iter::once(command.get_program()).chain(command.get_args());
    let args = args.map(|word| c_string(word.to_owned())).collect::<io::Result<Vec<_>>>()?;
    let variables = environment.into_iter().map(|(mut name, value)| {
        name.push("=");
        name.push(value);
        c_string(name)
    });
    let variables = variables.collect::<io::Result<Vec<_>>>()?;
    let dir = command.get_current_dir().map(|dir| c_string(dir.into())).transpose()?;
    let mut actions = FileActions::new()?;
    for (number, end) in (0..).zip(streams) {
        if let Some(end) = end {
            actions.redirect(number, end)?;
        }
    }
    if let Some(dir) = &dir {
        actions.change_dir(dir)?;
    }
    let attributes = Attributes::new()?;
    let (args, variables) = (pointers(&args), pointers(&variables));
    let mut pid = 0;
    // SAFETY: all pointers are to values that live until the call returns; both lists end with null.
    check(unsafe {
        libc::posix_spawn(
            &raw mut pid,
            program.as_ptr(),
            &raw const actions.0,
            &raw const attributes.0,
            args.as_ptr(),
            variables.as_ptr(),
        )
    })?;
    Ok(pid)
}

fn pointers(texts: &[CString]) -> Vec<*mut libc::c_char> {
    texts.iter().map(|text| text.as_ptr().cast_mut()).chain([ptr::null_mut()]).collect()
}

fn c_string(text: OsString) -> io::Result<CString> {
    CString::new(text.into_vec()).map_err(io::Error::from)
}

fn check(code: libc::c_int) -> io::Result<()> {
    if code == 0 { Ok(()) } else { Err(io::Error::from_raw_os_error(code)) }
}

/// The variables of this process, as the command changes them.
fn environment(command: &Command) -> Vec<(OsString, OsString)> {
    let is_changed = |name: &OsStr| command.get_envs().any(|(changed, _)| changed == name);
    let inherited = std::env::vars_os().filter(|(name, _)| !is_changed(name));
    let own = command.get_envs().filter_map(|(name, value)| Some((name.into(), value?.into())));
    inherited.chain(own).collect()
}

/// Searches a program without a directory in the `PATH` of the new process, as a shell does.
fn program(command: &Command, environment: &[(OsString, OsString)]) -> io::Result<PathBuf> {
    let name = command.get_program();
    if name.as_bytes().contains(&b'/') {
        return Ok(name.into());
    }
    let path = environment.iter().find(|(variable, _)| variable == "PATH");
    let path = path.map_or(OsStr::new(DEFAULT_PATH), |(_, path)| path);
    let dir = command.get_current_dir().unwrap_or(Path::new("."));
    let mut refused = None;
    for entry in std::env::split_paths(path).filter(|_| !name.is_empty()) {
        let file = entry.join(name);
        match is_executable(&dir.join(&file)) {
            Ok(true) => return Ok(file),
            Ok(false) => refused = Some(libc::EACCES),
            Err(_) => {}
        }
    }
    Err(io::Error::from_raw_os_error(refused.unwrap_or(libc::ENOENT)))
}

fn is_executable(file: &Path) -> io::Result<bool> {
    let is_file = std::fs::metadata(file)?.is_file();
    Ok(is_file && rustix::fs::access(file, rustix::fs::Access::EXEC_OK).is_ok())
}

/// The changes of descriptors and directory in the new process.
struct FileActions(libc::posix_spawn_file_actions_t);

impl FileActions {
    fn new() -> io::Result<Self> {
        let mut actions = MaybeUninit::uninit();
        // SAFETY: the call initialises the value if it succeeds.
        unsafe {
            check(libc::posix_spawn_file_actions_init(actions.as_mut_ptr()))?;
            Ok(Self(actions.assume_init()))
        }
    }

    fn redirect(&mut self, number: i32, end: &OwnedFd) -> io::Result<()> {
        let end = end.as_raw_fd();
        // SAFETY: the value is initialised; the descriptor is used while it is open.
        check(unsafe { libc::posix_spawn_file_actions_adddup2(&raw mut self.0, end, number) })
    }

    fn change_dir(&mut self, dir: &CString) -> io::Result<()> {
        // SAFETY: the value is initialised, and the text is copied.
        check(unsafe { libc::posix_spawn_file_actions_addchdir_np(&raw mut self.0, dir.as_ptr()) })
    }
}

impl Drop for FileActions {
    fn drop(&mut self) {
        // SAFETY: it is initialised, and not used again.
        unsafe { libc::posix_spawn_file_actions_destroy(&raw mut self.0) };
    }
}

/// The process group and signals of the new process.
struct Attributes(libc::posix_spawnattr_t);

impl Attributes {
    fn new() -> io::Result<Self> {
        let mut attributes = MaybeUninit::uninit();
        // SAFETY: the first call initialises the value if it succeeds.
        let mut attributes = unsafe {
            check(libc::posix_spawnattr_init(attributes.as_mut_ptr()))?;
            Self(attributes.assume_init())
        };
        let flags = libc::POSIX_SPAWN_SETPGROUP
            | libc::POSIX_SPAWN_SETSIGDEF
            | libc::POSIX_SPAWN_SETSIGMASK;
        let (reset, none) = (reset_set(), empty_set());
        let these = &raw mut attributes.0;
        // SAFETY: the value and the sets are initialised, and the sets are copied.
        unsafe {
            check(libc::posix_spawnattr_setpgroup(these, 0))?;
            check(libc::posix_spawnattr_setsigdefault(these, &raw const reset))?;
            check(libc::posix_spawnattr_setsigmask(these, &raw const none))?;
            check(libc::posix_spawnattr_setflags(these, flags as libc::c_short))?;
        }
        Ok(attributes)
    }
}

impl Drop for Attributes {
    fn drop(&mut self) {
        // SAFETY: it is initialised, and not used again.
        unsafe { libc::posix_spawnattr_destroy(&raw mut self.0) };
    }
}
