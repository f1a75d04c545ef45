//! Whether somebody reads what is written to standard output or standard error.

use std::io;

/// EIO: what a terminal answers that was closed.
const INPUT_OUTPUT: i32 = 5;

/// Whether whoever read along has gone: the other end of a pipe is closed
/// (`| head`, a pager), or the terminal is. That is no failure.
#[must_use]
pub fn is_disconnect(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::BrokenPipe
        || (error.raw_os_error() == Some(INPUT_OUTPUT) && writes_to_device())
}

/// Whether standard output or standard error is a character device, as terminals
/// are. A terminal that was closed does not say any more that it is one.
#[cfg(target_os = "linux")]
fn writes_to_device() -> bool {
    use std::os::unix::fs::FileTypeExt;
    let is_device = |path| std::fs::metadata(path).is_ok_and(|at| at.file_type().is_char_device());
    is_device("/proc/self/fd/1") || is_device("/proc/self/fd/2")
}

#[cfg(not(target_os = "linux"))]
fn writes_to_device() -> bool {
    false
}
