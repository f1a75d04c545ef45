//! Detects that a file that is being written is removed, moved, replaced, or
//! changed by another process.

use std::fs::{self, File, Metadata};
use std::io;
use std::path::{Path, PathBuf};

/// The identity of the file since it was created.
#[derive(Debug)]
pub(super) struct Presence {
    /// Absolute: the working directory may change.
    path: PathBuf,
    /// Which file it is, where the file system reports the same one by path and by file.
    identity: Option<Identity>,
    /// Whether the file system counts the names of a file.
    counts_links: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Identity {
    device: u64,
    inode: u64,
}

impl Presence {
    /// Of a file that was just created at `path`.
    pub fn of(file: &File, path: &Path) -> io::Result<Self> {
        let path = std::path::absolute(path)?;
        let (by_file, by_path) = (file.metadata()?, fs::metadata(&path)?);
        let identity = identity(&by_file).filter(|found| Some(*found) == identity(&by_path));
        Ok(Self { path, identity, counts_links: links(&by_file).is_some_and(|links| links > 0) })
    }

    /// Checks that the file has a name, and `size` bytes.
    ///
    /// # Errors
    /// What happened to it, in words.
    pub fn check_file(&self, file: &File, size: u64) -> io::Result<()> {
        let found = file.metadata()?;
        if self.counts_links && links(&found) == Some(0) {
            return Err(io::Error::other("it was removed during the run"));
        }
        if found.len() != size {
            let found = found.len();
            let what = format!("it has {found} bytes instead of {size}: something else changed it");
            return Err(io::Error::other(what));
        }
        Ok(())
    }

    /// Checks that the path still leads to the file.
    ///
    /// # Errors
    /// What happened to it, in words.
    pub fn check_path(&self, file: &File) -> io::Result<()> {
        match fs::metadata(&self.path) {
            Ok(found) if self.identity.is_none() || identity(&found) == self.identity => Ok(()),
            Ok(_) => Err(self.moved("it was replaced during the run", file)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                Err(self.moved("it was moved during the run", file))
            }
            Err(error) => Err(error),
        }
    }

    fn moved(&self, what: &str, file: &File) -> io::Error {
        match current_path(file).filter(|path| *path != self.path) {
            Some(path) => io::Error::other(format!("{what}; it is now `{}`", path.display())),
            None => io::Error::other(what.to_owned()),
        }
    }
}

#[cfg(unix)]
fn identity(found: &Metadata) -> Option<Identity> {
    use std::os::unix::fs::MetadataExt;
    Some(Identity { device: found.dev(), inode: found.ino() })
}

#[cfg(unix)]
fn links(found: &Metadata) -> Option<u64> {
    use std::os::unix::fs::MetadataExt;
    Some(found.nlink())
}

#[cfg(not(unix))]
fn identity(_found: &Metadata) -> Option<Identity> {
    None
}

#[cfg(not(unix))]
fn links(_found: &Metadata) -> Option<u64> {
    None
}

/// Where an open file is now, as Linux knows it.
#[cfg(target_os = "linux")]
fn current_path(file: &File) -> Option<PathBuf> {
    use std::os::fd::AsRawFd;
    let path = fs::read_link(format!("/proc/self/fd/{}", file.as_raw_fd())).ok()?;
    path.is_file().then_some(path)
}

#[cfg(not(target_os = "linux"))]
fn current_path(_file: &File) -> Option<PathBuf> {
    None
}
