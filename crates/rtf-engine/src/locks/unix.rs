//! The system calls behind [`crate::locks`].
#![expect(unsafe_code, reason = "locks of open file descriptions have no safe form")]

use std::fs::File;
use std::io;
use std::os::fd::AsRawFd;

/// Locks a file, unless another process has; returns whether it succeeded. The lock belongs to
/// the open file description: it ends when it is unlocked, or with the last descriptor in any
/// process.
pub fn lock(file: &File) -> io::Result<bool> {
    match control(file, libc::F_OFD_SETLK, &mut whole(libc::F_WRLCK)) {
        Ok(()) => Ok(true),
        Err(error) if matches!(error.raw_os_error(), Some(libc::EAGAIN | libc::EACCES)) => {
            Ok(false)
        }
        Err(error) => Err(error),
    }
}

/// Unlocks a file, even if another process has its descriptor.
pub fn unlock(file: &File) -> io::Result<()> {
    control(file, libc::F_OFD_SETLK, &mut whole(libc::F_UNLCK))
}

/// Whether another process has locked a file. Does not lock it.
pub fn is_locked(file: &File) -> io::Result<bool> {
    let mut query = whole(libc::F_WRLCK);
    control(file, libc::F_OFD_GETLK, &mut query)?;
    Ok(i32::from(query.l_type) != libc::F_UNLCK)
}

fn whole(kind: i32) -> libc::flock {
    // SAFETY: all zeroes are a valid `flock`: from the start to the end.
    let mut lock = unsafe { std::mem::zeroed::<libc::flock>() };
    lock.l_type = i16::try_from(kind).unwrap_or_default();
    lock
}

fn control(file: &File, command: i32, lock: &mut libc::flock) -> io::Result<()> {
    // SAFETY: the lock lives until the call returns.
    match unsafe { libc::fcntl(file.as_raw_fd(), command, &raw mut *lock) } {
        -1 => Err(io::Error::last_os_error()),
        _ => Ok(()),
    }
}
