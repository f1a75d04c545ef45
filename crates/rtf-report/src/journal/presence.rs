//! Detects that a file that is being written is removed, moved, replaced, or
//! changed by another process.

use std::fs::{self, File, Metadata};
use std::io;
use std::os::fd::AsRawFd;
use std::os::unix::fs::MetadataExt;
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

/// The device and the inode.
type Identity = (u64, u64);

impl Presence {
    /// Of a file that was just created at `path`.
    pub fn of(file: &File, path: &Path) -> io::Result<Self> {
        let path = std::path::absolute(path)?;
        let (by_file, by_path) = (file.metadata()?, fs::metadata(&path)?);
        let identity = Some(identity(&by_file)).filter(|found| *found == identity(&by_path));
        Ok(Self { path, identity, counts_links: by_file.nlink() > 0 })
    }

    /// Checks that the file has a name, and `size` bytes.
    ///
    /// # Errors
    /// What happened to it, in words.
    pub fn check_file(&self, file: &File, size: u64) -> io::Result<()> {
        let found = file.metadata()?;
        if self.counts_links && found.nlink() == 0 {
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
            Ok(found) if self.identity.is_none_or(|known| known == identity(&found)) => Ok(()),
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

fn identity(found: &Metadata) -> Identity {
    (found.dev(), found.ino())
}

/// Where an open file is now, as Linux knows it.
fn current_path(file: &File) -> Option<PathBuf> {
    let path = fs::read_link(format!("/proc/self/fd/{}", file.as_raw_fd())).ok()?;
    path.is_file().then_some(path)
}
