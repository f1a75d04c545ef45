//! Calls of a fork server to the operating system.
#![expect(unsafe_code, reason = "a clone that no library has, and the initial environment")]

use std::ffi::{CString, OsString};
use std::io;
use std::mem::MaybeUninit;
use std::os::fd::{BorrowedFd, FromRawFd, OwnedFd, RawFd};
use std::os::unix::ffi::OsStringExt;

use rtf_model::protocol::ForkRequest;
use rustix::net::{
    RecvAncillaryBuffer, RecvAncillaryMessage, RecvFlags, ReturnFlags, SendFlags, recvmsg,
};

use crate::unix::restore_sigpipe;

/// The memory of a variable in the process's initial environment, which
/// `/proc/PID/environ` shows.
#[derive(Debug)]
pub(crate) struct InitialVariable {
    start: *mut u8,
    length: usize,
}

impl InitialVariable {
    /// Removes a variable from the environment. Returns its value and its memory.
    pub(crate) fn take(name: &str) -> Option<(String, Self)> {
        let c_name = CString::new(name).ok()?;
        // SAFETY: the process has one thread, which copies the value at once.
        // The variable has not been set since the start, so `NAME=` is before the value in
        // the same writable memory, which is never freed.
        let (value, variable) = unsafe {
            let value = libc::getenv(c_name.as_ptr());
            if value.is_null() {
                return None;
            }
            let length = libc::strlen(value);
            let bytes = std::slice::from_raw_parts(value.cast::<u8>(), length).to_vec();
            let start = value.cast::<u8>().sub(name.len() + 1);
            libc::unsetenv(c_name.as_ptr());
            (bytes, Self { start, length: name.len() + 1 + length })
        };
        Some((OsString::from_vec(value).to_string_lossy().into_owned(), variable))
    }

    /// Writes variables there, as long as there is space.
    fn write<'a>(&self, variables: impl Iterator<Item = (&'a String, &'a String)>) {
        let mut bytes = Vec::with_capacity(self.length);
        for (name, value) in variables {
            let entry = format!("{name}={value}\0");
            if bytes.len() + entry.len() <= self.length {
                bytes.extend_from_slice(entry.as_bytes());
            }
        }
        bytes.resize(self.length, 0);
        // SAFETY: the memory of `take`, to which there are no other references.
        unsafe { std::ptr::copy_nonoverlapping(bytes.as_ptr(), self.start, self.length) };
    }
}

/// The C library's data about the only thread.
#[derive(Debug)]
pub(crate) struct MainThread {
    /// The address of the thread's id in the C library.
    tid: *mut libc::pid_t,
    robust_list: *mut libc::c_void,
    robust_list_bytes: usize,
}

/// The result of a fork.
pub(crate) enum Forked {
    /// This is the new process.
    Child,
    /// This is the server, and the new process has this id.
    Parent(i32),
}

#[cfg(target_os = "linux")]
impl MainThread {
    /// Reads the data that the C library's `fork` would restore.
    pub(crate) fn read() -> io::Result<Self> {
        let mut thread = Self {
            tid: std::ptr::null_mut(),
            robust_list: std::ptr::null_mut(),
            robust_list_bytes: 0,
        };
        // The C library passes on all arguments, also those that this operation does not use.
        let unused: libc::c_ulong = 0;
        // SAFETY: both calls write to variables of the right size.
        let refused = unsafe {
            libc::prctl(libc::PR_GET_TID_ADDRESS, &raw mut thread.tid, unused, unused, unused) != 0
                || libc::syscall(
                    libc::SYS_get_robust_list,
                    0,
                    &raw mut thread.robust_list,
                    &raw mut thread.robust_list_bytes,
                ) != 0
        };
        if refused {
            return Err(io::Error::last_os_error());
        }
        // SAFETY: the address that the C library has given to the kernel.
        if thread.tid.is_null() || unsafe { *thread.tid } != rustix::thread::gettid().as_raw_pid() {
            return Err(io::Error::other("the C library's address of the thread's id is unknown"));
        }
        Ok(thread)
    }

    /// Forks a child of this process's parent, in 65 µs; two calls of the C library's `fork`
    /// take 330 µs. Like the C library, restores the thread's id and its list of robust
    /// mutexes. There are no other threads that could hold locks.
    pub(crate) fn fork(&self) -> io::Result<Forked> {
        let flags = libc::CLONE_PARENT | libc::CLONE_CHILD_SETTID | libc::CLONE_CHILD_CLEARTID;
        let flags = i64::from(flags | libc::SIGCHLD);
        // The order of the last two arguments depends on the processor; the one for
        // thread-local storage is ignored without its flag.
        let child_tid = self.tid;
        // The same stack, and no address for the id in the parent. The system call reads 64 bits.
        let none: libc::c_long = 0;
        // SAFETY: copies the memory and the stack, like `fork`.
        let pid =
            unsafe { libc::syscall(libc::SYS_clone, flags, none, none, child_tid, child_tid) };
        match i32::try_from(pid) {
            Ok(0) => {
                let (list, bytes) = (self.robust_list, self.robust_list_bytes);
                // SAFETY: the list that the C library had registered in the old process.
                unsafe { libc::syscall(libc::SYS_set_robust_list, list, bytes) };
                Ok(Forked::Child)
            }
            Ok(pid) if pid > 0 => Ok(Forked::Parent(pid)),
            _ => Err(io::Error::last_os_error()),
        }
    }
}

#[cfg(not(target_os = "linux"))]
impl MainThread {
    pub(crate) fn read() -> io::Result<Self> {
        Err(io::Error::from(io::ErrorKind::Unsupported))
    }

    pub(crate) fn fork(&self) -> io::Result<Forked> {
        Err(io::Error::from(io::ErrorKind::Unsupported))
    }
}

/// Turns a forked process into the same state as an executed one.
pub(crate) fn become_host(
    request: &ForkRequest,
    variable: &InitialVariable,
    stdout: &OwnedFd,
    stderr: &OwnedFd,
) -> io::Result<()> {
    rustix::process::setpgid(None, None)?;
    rustix::stdio::dup2_stdout(stdout)?;
    rustix::stdio::dup2_stderr(stderr)?;
    rustix::process::chdir(&request.working_dir)?;
    for (name, value) in &request.env {
        // SAFETY: the process has one thread.
        unsafe { std::env::set_var(name, value) };
    }
    variable.write(request.env.iter());
    restore_sigpipe();
    Ok(())
}

/// Takes over a descriptor that the runner left open for this process.
pub(crate) fn take_descriptor(fd: RawFd) -> io::Result<OwnedFd> {
    // SAFETY: if it is not open, the call fails.
    let borrowed = unsafe { BorrowedFd::borrow_raw(fd) };
    rustix::io::fcntl_setfd(borrowed, rustix::io::FdFlags::CLOEXEC)?;
    // SAFETY: it is open, and the variable with its number is removed.
    Ok(unsafe { OwnedFd::from_raw_fd(fd) })
}

/// Waits for a packet. Returns its length (0 at the end) and its descriptors.
pub(crate) fn receive(socket: &OwnedFd, packet: &mut [u8]) -> io::Result<(usize, Vec<OwnedFd>)> {
    let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(3))];
    let mut control = RecvAncillaryBuffer::new(&mut space);
    let mut into = [io::IoSliceMut::new(packet)];
    let received = rustix::io::retry_on_intr(|| {
        recvmsg(socket, &mut into, &mut control, RecvFlags::CMSG_CLOEXEC)
    })?;
    let mut descriptors = Vec::with_capacity(3);
    for message in control.drain() {
        if let RecvAncillaryMessage::ScmRights(rights) = message {
            descriptors.extend(rights);
        }
    }
    if received.flags.contains(ReturnFlags::TRUNC) {
        return Err(io::Error::other("a request is too long"));
    }
    Ok((received.bytes, descriptors))
}

pub(crate) fn send_packet(socket: &OwnedFd, packet: &[u8]) -> io::Result<()> {
    rustix::io::retry_on_intr(|| rustix::net::send(socket, packet, SendFlags::NOSIGNAL))?;
    Ok(())
}
