//! The files to which a program writes its report. Their directory belongs to the process that
//! opens the report first: afterwards, all others find links to `/dev/null`. So a program that
//! executes itself again with its own arguments does not write into its own report. See
//! "Descendants" in `spec/frameworks.md`.
//!
//! `sdk/cpp/preload/report.c` takes the report in the program. Without it, each process finds the
//! files.

use std::ffi::OsString;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::framework::{Launch, OpenChannel};
use crate::{elf, preload};

/// The library that takes the report.
pub const LIBRARY: &str = "librtf-report.so";

/// `PORT:DIRECTORY`: a port on the loopback interface, or 0, and the directory.
const VARIABLE: &str = "RTF_REPORT";

/// A link to one of the following.
const DIRECTORY: &str = "report";
/// The directory for the process that has the report.
const OPEN: &str = "report.open";
/// The directory for all others.
const CLOSED: &str = "report.closed";
/// A link to it, which replaces [`DIRECTORY`].
const TAKEN: &str = "report.taken";

/// A stream, which is read while the program runs.
const LOG: &str = "log";
/// A file, which is read after its end.
const RESULTS: &str = "results";

const NOWHERE: &str = "/dev/null";

/// The path of the stream, for the command line.
#[must_use]
pub fn log(scratch: &Path) -> PathBuf {
    scratch.join(DIRECTORY).join(LOG)
}

/// The path of the file, for the command line.
#[must_use]
pub fn results(scratch: &Path) -> PathBuf {
    scratch.join(DIRECTORY).join(RESULTS)
}

/// The file itself.
#[must_use]
pub fn results_file(scratch: &Path) -> PathBuf {
    scratch.join(OPEN).join(RESULTS)
}

/// Offers a new report, whose stream is at this path.
///
/// # Errors
/// A file or link cannot be made.
pub fn offer(scratch: &Path, log: Option<&Path>) -> std::io::Result<()> {
    for directory in [OPEN, CLOSED] {
        let directory = scratch.join(directory);
        // Of the process before.
        drop(std::fs::remove_dir_all(&directory));
        std::fs::create_dir(directory)?;
    }
    for name in [LOG, RESULTS] {
        symlink(NOWHERE, scratch.join(CLOSED).join(name))?;
    }
    if let Some(log) = log {
        symlink(log, scratch.join(OPEN).join(LOG))?;
    }
    for (link, directory) in [(DIRECTORY, OPEN), (TAKEN, CLOSED)] {
        drop(std::fs::remove_file(scratch.join(link)));
        symlink(directory, scratch.join(link))?;
    }
    Ok(())
}

/// Prepares a command whose report was offered: a process takes it with a variable, and a library
/// that the program loads, if it can. A program that is forked has the library already.
///
/// # Errors
/// See [`preload::add`].
pub fn prepare(
    command: &mut Command,
    launch: &Launch<'_>,
    is_executed: bool,
) -> Result<(), String> {
    let port = match &launch.channel {
        OpenChannel::Socket(address) => address.port(),
        OpenChannel::Descriptor(_) => 0,
        OpenChannel::None | OpenChannel::Stdout => return Ok(()),
    };
    let mut value = OsString::from(format!("{port}:"));
    value.push(launch.scratch.join(DIRECTORY));
    command.env(VARIABLE, value);
    match preload::library(LIBRARY) {
        Some(library)
            if is_executed && elf::may_load_libraries(Path::new(command.get_program())) =>
        {
            preload::add(command, &[library], launch.scratch)
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_first_process_takes_a_report() {
        let scratch = tempfile::tempdir().unwrap();
        let scratch = scratch.path();
        for _ in 0..2 {
            offer(scratch, Some(Path::new("/dev/fd/7"))).unwrap();
            let target = || std::fs::read_link(log(scratch)).unwrap();
            assert_eq!(target(), Path::new("/dev/fd/7"));
            std::fs::write(results(scratch), "1").unwrap();
            let take = || std::fs::rename(scratch.join(TAKEN), scratch.join(DIRECTORY));
            assert!(take().is_ok() && take().is_err());
            assert_eq!(target(), Path::new(NOWHERE));
            std::fs::write(results(scratch), "2").unwrap();
            assert_eq!(std::fs::read_to_string(results_file(scratch)).unwrap(), "1");
        }
    }
}
