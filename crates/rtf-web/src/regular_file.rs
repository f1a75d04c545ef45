//! Opens only regular files below a directory.
//!
//! Tests, which are not trusted, write to a run's directory: a link in it
//! may lead anywhere, and opening a FIFO or a device may block indefinitely. No part of
//! a path below the directory may be a link, not even one that stays inside.

use std::fs::File;
use std::io;
use std::path::{Component, Path};

use rustix::fd::{AsFd, OwnedFd};
use rustix::fs::{AtFlags, CWD, FileType, Mode, OFlags, fstat, openat, statat};

const DIRECTORY: OFlags = OFlags::RDONLY.union(OFlags::DIRECTORY).union(OFlags::CLOEXEC);
/// Does not wait for the writer of a FIFO, should the file have become one.
const FILE: OFlags =
    OFlags::RDONLY.union(OFlags::NOFOLLOW).union(OFlags::NONBLOCK).union(OFlags::CLOEXEC);

/// Opens the regular file at this path below `root`.
///
/// # Errors
/// There is none, it is something else, or a part of the path is a link.
pub fn open(root: &Path, path: &Path) -> io::Result<File> {
    let parts = parts(path)?;
    let Some((name, parents)) = parts.split_last() else { return Err(refused()) };
    let root = openat(CWD, root, DIRECTORY, Mode::empty())?;
    let parent = parent(root, parents)?;
    // Only what was regular a moment ago is opened at all: opening a device may do something.
    regular(statat(&parent, *name, AtFlags::SYMLINK_NOFOLLOW)?.st_mode)?;
    let file = openat(&parent, *name, FILE, Mode::empty())?;
    regular(fstat(&file)?.st_mode)?;
    Ok(file.into())
}

/// Whether there is a regular file at this path below `root`.
#[must_use]
pub fn is_file(root: &Path, path: &Path) -> bool {
    open(root, path).is_ok()
}

/// The parts of a path that goes nowhere but down.
fn parts(path: &Path) -> io::Result<Vec<&Path>> {
    let part = |part| match part {
        Component::Normal(name) => Ok(Path::new(name)),
        _ => Err(refused()),
    };
    path.components().map(part).collect()
}

fn parent(root: OwnedFd, parents: &[&Path]) -> io::Result<OwnedFd> {
    if parents.is_empty() {
        return Ok(root);
    }
    match resolve(&root, parents) {
        // An old kernel, or a sandbox that knows no newer one.
        Err(rustix::io::Errno::NOSYS | rustix::io::Errno::PERM) => Ok(walk(root, parents)?),
        found => Ok(found?),
    }
}

#[cfg(target_os = "linux")]
fn resolve(root: impl AsFd, parents: &[&Path]) -> rustix::io::Result<OwnedFd> {
    use rustix::fs::{ResolveFlags, openat2};
    let path: std::path::PathBuf = parents.iter().collect();
    let how = ResolveFlags::BENEATH | ResolveFlags::NO_SYMLINKS | ResolveFlags::NO_MAGICLINKS;
    openat2(root, &path, DIRECTORY, Mode::empty(), how)
}

#[cfg(not(target_os = "linux"))]
fn resolve(_root: impl AsFd, _parents: &[&Path]) -> rustix::io::Result<OwnedFd> {
    Err(rustix::io::Errno::NOSYS)
}

/// Goes down part by part, and follows no link.
fn walk(root: OwnedFd, parents: &[&Path]) -> rustix::io::Result<OwnedFd> {
    parents.iter().try_fold(root, |directory, part| {
        openat(directory, *part, DIRECTORY | OFlags::NOFOLLOW, Mode::empty())
    })
}

fn regular(mode: rustix::fs::RawMode) -> io::Result<()> {
    match FileType::from_raw_mode(mode) {
        FileType::RegularFile => Ok(()),
        _ => Err(refused()),
    }
}

fn refused() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, "it is not a regular file")
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    /// What every way down has to refuse.
    fn folder() -> tempfile::TempDir {
        let temp = tempfile::tempdir().unwrap();
        let inside = temp.path().join("run/deep");
        std::fs::create_dir_all(&inside).unwrap();
        for file in ["secret", "run/file", "run/deep/file"] {
            std::fs::write(temp.path().join(file), file).unwrap();
        }
        for (to, link) in [
            ("../../secret", "run/deep/out"),
            ("file", "run/deep/inside"),
            ("..", "run/deep/up"),
            ("deep", "run/linked"),
            ("/", "run/root"),
        ] {
            symlink(to, temp.path().join(link)).unwrap();
        }
        let fifo = temp.path().join("run/fifo");
        rustix::fs::mknodat(CWD, &fifo, FileType::Fifo, Mode::RUSR | Mode::WUSR, 0).unwrap();
        temp
    }

    #[test]
    fn only_regular_files_are_opened_and_no_link_is_followed() {
        let temp = folder();
        let root = temp.path().join("run");
        for good in ["file", "deep/file"] {
            assert!(is_file(&root, Path::new(good)), "{good}");
        }
        for bad in [
            "",
            "deep",
            "none",
            "fifo",
            "deep/out",
            "deep/inside",
            "deep/up/file",
            "linked/file",
            "../secret",
            "deep/../file",
            "/etc/passwd",
            "root/etc/passwd",
        ] {
            assert!(open(&root, Path::new(bad)).is_err(), "{bad}");
        }
        let other = temp.path().join("other");
        symlink("run", &other).unwrap();
        assert!(is_file(&other, Path::new("file")), "the directory itself is the user's choice");
    }

    #[test]
    fn an_old_kernel_follows_no_link_either() {
        let temp = folder();
        let root = || openat(CWD, temp.path(), DIRECTORY, Mode::empty()).unwrap();
        let walked = |parts: &[&str]| {
            let parts: Vec<_> = parts.iter().map(Path::new).collect();
            walk(root(), &parts).is_ok()
        };
        assert!(walked(&["run", "deep"]));
        for bad in [&["run", "linked"][..], &["run", "deep", "up"], &["run", "root", "etc"]] {
            assert!(!walked(bad), "{bad:?}");
        }
    }
}
