//! Readers of standard output or standard error that disconnect (`| head`, a pager, a closed
//! terminal) are no failure: the run continues, and its exit code reports the tests.

use std::io::{self, Write};

/// EIO: the error of a terminal that was closed.
const INPUT_OUTPUT: i32 = 5;

/// Whether the reader has disconnected: the other end of a pipe, or the terminal, is closed.
#[must_use]
pub fn is_disconnect(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::BrokenPipe
        || (error.raw_os_error() == Some(INPUT_OUTPUT) && writes_to_device())
}

/// Whether standard output or standard error is a character device, as terminals
/// are. A closed terminal is not recognised as a terminal any more.
fn writes_to_device() -> bool {
    use std::os::unix::fs::FileTypeExt;
    let is_device = |path| std::fs::metadata(path).is_ok_and(|at| at.file_type().is_char_device());
    is_device("/proc/self/fd/1") || is_device("/proc/self/fd/2")
}

/// Writes until the reader disconnects, and discards everything after that.
pub(crate) struct UntilDisconnect {
    out: Option<Box<dyn Write + Send>>,
}

impl UntilDisconnect {
    pub fn new(out: Box<dyn Write + Send>) -> Self {
        Self { out: Some(out) }
    }

    fn try_with<T>(
        &mut self,
        discarded: T,
        act: impl FnOnce(&mut dyn Write) -> io::Result<T>,
    ) -> io::Result<T> {
        let Some(out) = &mut self.out else { return Ok(discarded) };
        match act(out) {
            Err(error) if is_disconnect(&error) => {
                self.out = None;
                Ok(discarded)
            }
            result => result,
        }
    }
}

impl Write for UntilDisconnect {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.try_with(bytes.len(), |out| out.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.try_with((), |out| out.flush())
    }
}
