//! A user's own record of the last run that had a lock.
//!
//! All users may write a lock's file, so that its contents prove nothing: another user could
//! write the scope of a live run there, and the next owner would stop its processes. The record
//! is a file that only this user can write, and that names its lock.

use std::fs::OpenOptions;
use std::io::{self, Read, Seek, Write};
use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

/// A longer file is no record.
const RECORD_BYTES: u64 = 4096;

/// The contents of the file.
#[derive(Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct OwnRecord {
    /// The name of the lock's file: a record may not be moved to another lock.
    lock: String,
    /// The scope of the run's suite.
    scope: String,
}

/// Records that a run of this user has a lock, and returns the scope of the last one that had it;
/// empty if there is none.
///
/// # Errors
/// The file belongs to another user, can be written by others, or cannot be written.
pub fn replace(lock: &Path, scope: &str) -> io::Result<String> {
    let mut file = OpenOptions::new()
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .custom_flags(libc::O_NOFOLLOW | libc::O_NONBLOCK)
        .mode(0o600)
        .open(path_of(lock))?;
    let found = file.metadata()?;
    let own = rustix::process::geteuid().as_raw();
    if !found.is_file() || found.uid() != own || found.mode() & 0o022 != 0 {
        return Err(io::Error::from(io::ErrorKind::PermissionDenied));
    }
    let name = lock.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut text = String::new();
    (&mut file).take(RECORD_BYTES).read_to_string(&mut text)?;
    let before: OwnRecord = serde_json::from_str(&text).unwrap_or_default();
    let last = if before.lock == name { before.scope } else { String::new() };
    let record = serde_json::to_string(&OwnRecord { lock: name, scope: scope.to_owned() })?;
    file.set_len(0)?;
    file.rewind()?;
    file.write_all(record.as_bytes())?;
    Ok(last)
}

/// The record's file, which is no name of a lock: those end with a number.
fn path_of(lock: &Path) -> PathBuf {
    let name = lock.file_name().unwrap_or_default().to_string_lossy();
    lock.with_file_name(format!("{name}.of-{}", rustix::process::geteuid().as_raw()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::{PermissionsExt, symlink};

    #[test]
    fn a_record_that_others_can_write_or_that_was_moved_is_not_believed() {
        let dir = tempfile::tempdir().unwrap();
        let [arm, leg] = ["arm.1", "leg.1"].map(|name| dir.path().join(name));
        assert_eq!(replace(&arm, "one.0.").unwrap(), "");
        assert_eq!(replace(&arm, "two.0.").unwrap(), "one.0.");
        std::fs::rename(path_of(&arm), path_of(&leg)).unwrap();
        assert_eq!(replace(&leg, "three.0.").unwrap(), "", "the record of another lock");
        let writable = std::fs::Permissions::from_mode(0o666);
        std::fs::set_permissions(path_of(&leg), writable).unwrap();
        assert!(replace(&leg, "four.0.").is_err());
        std::fs::remove_file(path_of(&leg)).unwrap();
        let target = dir.path().join("target");
        std::fs::write(&target, "text").unwrap();
        symlink(&target, path_of(&leg)).unwrap();
        assert!(replace(&leg, "five.0.").is_err());
        assert_eq!(std::fs::read_to_string(&target).unwrap(), "text");
    }
}
