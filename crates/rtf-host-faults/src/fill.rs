//! Fills memory and file systems. Both belong to this process: the kernel frees them when it
//! ends.

use std::fs::File;
use std::io;
use std::os::unix::fs::{FileExt, MetadataExt, OpenOptionsExt};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use rtf_model::FaultAmount;
use rtf_model::protocol::RUN_DIR_VARIABLE;
use rustix::fs::{FallocateFlags, OFlags, fallocate, fstatvfs};
use rustix::io::Errno;

const MIB: u64 = 1024 * 1024;
/// Memory is allocated, and written to, in pieces of this size.
const MEMORY_PIECE: u64 = 16 * MIB;
/// Space is allocated in pieces of at most this size.
const DISK_PIECE: u64 = 1024 * MIB;
/// The smallest piece: a block of most file systems.
const BLOCK: u64 = 4096;
/// What stays free on the file system of the results.
const RESERVE: u64 = 64 * MIB;

/// Makes the system end this process first when memory runs out.
pub(crate) fn be_first_victim() {
    // A process may always raise its own value.
    let _ = std::fs::write("/proc/self/oom_score_adj", "1000");
}

/// Allocates memory and writes to it, until `is_cancelled`.
pub(crate) fn memory(
    amount: FaultAmount,
    is_cancelled: &AtomicBool,
) -> Result<Vec<Vec<u8>>, String> {
    let available = available_memory().ok_or("`/proc/meminfo` does not show the free memory")?;
    let size = size_of(amount, available, "memory")?;
    let pattern = vec![0xa5; MIB as usize];
    let mut pieces = Vec::new();
    let mut left = size;
    while left > 0 && !is_cancelled.load(Ordering::Acquire) {
        let length = left.min(MEMORY_PIECE);
        let mut piece = Vec::new();
        let bytes = usize::try_from(length).unwrap_or(usize::MAX);
        if piece.try_reserve_exact(bytes).is_err() {
            return Err(format!("the system refused memory after {}", text_of(size - left)));
        }
        while piece.len() < bytes {
            piece.extend_from_slice(&pattern[..pattern.len().min(bytes - piece.len())]);
        }
        pieces.push(piece);
        left -= length;
    }
    Ok(pieces)
}

/// Allocates space in the file system of a directory, until `is_cancelled`.
pub(crate) fn disk(
    dir: &Path,
    amount: FaultAmount,
    is_cancelled: &AtomicBool,
) -> Result<File, String> {
    let failed = |error: io::Error| format!("cannot write in `{}`: {error}", dir.display());
    let file = unnamed_file(dir).map_err(failed)?;
    let space = free_space(&file).map_err(failed)?;
    let size = size_of(amount, space, "space")?;
    if space - size < RESERVE && has_results(&file) {
        return Err(format!(
            "less than {} would stay free on the file system of the results; hint: use a \
             separate file system, for example a `tmpfs`",
            text_of(RESERVE)
        ));
    }
    allocate(&file, size, is_cancelled).map_err(failed)?;
    Ok(file)
}

fn size_of(amount: FaultAmount, available: u64, what: &str) -> Result<u64, String> {
    match amount {
        FaultAmount::Size(size) if size > available => Err(format!(
            "only {} of {what} are free, and {} are to be filled",
            text_of(available),
            text_of(size)
        )),
        FaultAmount::Size(size) => Ok(size),
        FaultAmount::Leave(leave) => Ok(available.saturating_sub(leave)),
    }
}

/// A size for display.
pub(crate) fn text_of(bytes: u64) -> String {
    match bytes {
        0..MIB => format!("{bytes} B"),
        _ => format!("{} MiB", bytes / MIB),
    }
}

fn available_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kib: u64 = line.split_ascii_whitespace().next()?.parse().ok()?;
    Some(kib * 1024)
}

/// A file that vanishes with its last descriptor.
fn unnamed_file(dir: &Path) -> io::Result<File> {
    let flags = i32::from_ne_bytes(OFlags::TMPFILE.bits().to_ne_bytes());
    match File::options().write(true).mode(0o600).custom_flags(flags).open(dir) {
        // Not every file system has such files, and some report a directory.
        Err(error)
            if matches!(Errno::from_io_error(&error), Some(Errno::OPNOTSUPP | Errno::ISDIR)) =>
        {
            let path = dir.join(format!(".rtf-fault-{}", std::process::id()));
            let file = File::options().write(true).create_new(true).mode(0o600).open(&path)?;
            std::fs::remove_file(&path)?;
            Ok(file)
        }
        opened => opened,
    }
}

/// The space that a process of this user can use.
fn free_space(file: &File) -> io::Result<u64> {
    let space = fstatvfs(file)?;
    let is_root = rustix::process::geteuid().is_root();
    Ok(space.f_frsize * if is_root { space.f_bfree } else { space.f_bavail })
}

fn has_results(file: &File) -> bool {
    let results = std::env::var_os(RUN_DIR_VARIABLE).map(std::fs::metadata);
    match (results, file.metadata()) {
        (Some(Ok(results)), Ok(file)) => results.dev() == file.dev(),
        _ => true,
    }
}

fn allocate(file: &File, size: u64, is_cancelled: &AtomicBool) -> io::Result<()> {
    let (mut done, mut piece) = (0, DISK_PIECE);
    while done < size && !is_cancelled.load(Ordering::Acquire) {
        let length = piece.min(size - done);
        match fallocate(file, FallocateFlags::empty(), done, length) {
            Ok(()) => done += length,
            Err(Errno::INTR) => {}
            // The last blocks: the file system needs some for the file itself.
            Err(Errno::NOSPC) if length > BLOCK => piece = (length / 2).max(BLOCK),
            Err(Errno::NOSPC) => break,
            Err(Errno::OPNOTSUPP) => return write(file, size, is_cancelled),
            Err(error) => return Err(error.into()),
        }
    }
    Ok(())
}

fn write(file: &File, size: u64, is_cancelled: &AtomicBool) -> io::Result<()> {
    let bytes = vec![0xa5; MIB as usize];
    let mut done = 0;
    while done < size && !is_cancelled.load(Ordering::Acquire) {
        let length = usize::try_from(size - done).unwrap_or(usize::MAX).min(bytes.len());
        match file.write_at(&bytes[..length], done) {
            Ok(written) => done += written as u64,
            Err(error) if error.kind() == io::ErrorKind::StorageFull => break,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}
