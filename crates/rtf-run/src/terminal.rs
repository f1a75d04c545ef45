//! Writes to standard output and standard error. A reader that has closed its end
//! (`| head`, a pager, a closed terminal) is not an error.

use std::fmt::Display;
use std::io::{self, BufWriter, Write};

use crate::error::Failure;

/// Writes text for people to standard output.
pub fn stdout(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    finish(BufWriter::new(anstream::stdout().lock()), |out| write(out))
}

/// Writes data to standard output, byte for byte.
pub fn raw_stdout(
    write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
) -> Result<(), Failure> {
    finish(BufWriter::new(io::stdout()), |out| write(out))
}

/// Writes text for people to standard error.
pub fn stderr(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    finish(anstream::stderr().lock(), |out| write(out))
}

/// Prints a line to standard error, for callers that can do nothing about an error.
///
/// It is written at once: other threads print to the same terminal through standard output.
pub fn notice(line: impl Display) {
    let _ = anstream::stderr().write_all(format!("{line}\n").as_bytes());
}

fn finish<W: Write>(
    mut out: W,
    write: impl FnOnce(&mut W) -> io::Result<()>,
) -> Result<(), Failure> {
    match write(&mut out).and_then(|()| out.flush()) {
        Err(error) if rtf_report::is_disconnect(&error) => Ok(()),
        written => written.map_err(Failure::internal),
    }
}
