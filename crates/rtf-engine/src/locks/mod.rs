//! Locks on exclusive resources, such as a robot, between all runs and users of a machine.
//!
//! A lock is a kernel lock on a file. It ends with the last process that holds it: the runner,
//! or after its death the guard, which runs the hooks first. The file names the owner for users;
//! a release empties it. So a run that gets the lock of a file with contents knows that runner
//! and guard of the owner were killed, and stops their processes if the owner's user has a
//! record of it ([`own_record`]). Files are never removed, because waiting runs have them open.

mod abandoned_run;
mod own_record;
mod unix;
mod wait;

use std::fs::{DirBuilder, File, OpenOptions, Permissions};
use std::io::{self, Read, Seek, Write};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::fs::{DirBuilderExt, OpenOptionsExt, PermissionsExt};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

pub use wait::{LockOptions, wait};

use rtf_plan::plan::RequiredResource;

/// The variable that names another directory of locks.
pub const DIR_VARIABLE: &str = "RTF_LOCKS";

/// The default directory of locks, which is the same for all users.
pub const DEFAULT_DIR: &str = "/tmp/rtf-locks";

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct LockOwner {
    pub user: String,
    /// The machine's name.
    pub host: String,
    /// The runner's process.
    pub pid: u32,
    /// Since when, as RFC 3339.
    pub since: String,
    pub run: String,
    pub suite: String,
    /// The prefix of the scopes of its processes.
    pub scope: String,
}

impl std::fmt::Display for LockOwner {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { user, host, pid, since, run, suite, scope: _ } = self;
        if self.run.is_empty() {
            return f.write_str("somebody");
        }
        write!(f, "{user}@{host} since {since} (suite {suite} of run {run}, process {pid})")
    }
}

/// The directory of a machine's locks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Locks {
    dir: PathBuf,
}

/// A lock that this process holds, until [`Lock::release`] or until the last process with its
/// descriptor ends.
#[derive(Debug)]
pub struct Lock {
    file: File,
    /// The previous owner, if it did not release the lock because runner and guard were killed.
    /// Its scope is empty if this user has no record of it.
    abandoned: Option<LockOwner>,
}

/// A lock that another run holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HeldLock {
    /// The resource.
    pub name: String,
    /// The slot of the resource, from 1.
    pub slot: u32,
    pub owner: LockOwner,
}

impl Locks {
    /// Opens a directory of locks, and creates it for all users if it is missing.
    ///
    /// # Errors
    /// It cannot be created.
    pub fn open(dir: &Path) -> io::Result<Self> {
        match DirBuilder::new().mode(0o777).create(dir) {
            // As for `/tmp`: all users may add files, and only owners remove them.
            Ok(()) => std::fs::set_permissions(dir, Permissions::from_mode(0o1777))?,
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
        Ok(Self { dir: dir.to_owned() })
    }

    /// Acquires a lock of a resource, or returns its owners.
    ///
    /// # Errors
    /// A file cannot be opened, locked or written.
    pub fn try_acquire(
        &self,
        resource: &RequiredResource,
        owner: &LockOwner,
    ) -> io::Result<Result<Lock, Vec<HeldLock>>> {
        let mut held = Vec::new();
        for slot in 1..=resource.slots {
            let path = self.dir.join(format!("{}.{slot}", resource.name));
            let mut file = open(&path)?;
            if unix::lock(&file)? {
                let abandoned = Some(read(&mut file)).filter(|before| !before.scope.is_empty());
                // Without a record, the lock protects the robot as well.
                let recorded = own_record::replace(&path, &owner.scope).unwrap_or_default();
                let abandoned = abandoned.map(|before| match before.scope == recorded {
                    true => before,
                    false => LockOwner { scope: String::new(), ..before },
                });
                let text = serde_json::to_string(owner)?;
                file.set_len(0)?;
                file.rewind()?;
                file.write_all(text.as_bytes())?;
                return Ok(Ok(Lock { file, abandoned }));
            }
            held.push(HeldLock { name: resource.name.clone(), slot, owner: read(&mut file) });
        }
        Ok(Err(held))
    }

    /// Returns all held locks, by name.
    ///
    /// # Errors
    /// The directory cannot be read.
    pub fn held(&self) -> io::Result<Vec<HeldLock>> {
        let mut all = Vec::new();
        for entry in std::fs::read_dir(&self.dir)? {
            let name = entry?.file_name();
            let known = name.to_str().and_then(|name| name.rsplit_once('.'));
            let Some((name, Ok(slot))) = known.map(|(name, slot)| (name, slot.parse())) else {
                continue;
            };
            let mut file = open(&self.dir.join(format!("{name}.{slot}")))?;
            if unix::is_locked(&file)? {
                all.push(HeldLock { name: name.to_owned(), slot, owner: read(&mut file) });
            }
        }
        all.sort_by(|a, b| (&a.name, a.slot).cmp(&(&b.name, b.slot)));
        Ok(all)
    }
}

impl Lock {
    /// Releases the lock, even if the guard has its descriptor.
    pub fn release(self) {
        let _ = clear(&self.file);
        // If this fails, the lock ends with its descriptors.
        let _ = unix::unlock(&self.file);
    }
}

impl AsFd for Lock {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.file.as_fd()
    }
}

/// Marks a lock as released in order. (The guard does so after the death of the runner.)
///
/// # Errors
/// It is not a lock.
pub fn clear(lock: impl AsFd) -> io::Result<()> {
    Ok(rustix::fs::ftruncate(lock, 0)?)
}

/// Opens a lock's file, or creates it for all users. Does not follow links. (Linux refuses to
/// open another user's file with `O_CREAT` in directories such as `/tmp`.)
fn open(path: &Path) -> io::Result<File> {
    let with = |flags| {
        let mut options = OpenOptions::new();
        options.read(true).write(true).custom_flags(libc::O_NOFOLLOW);
        options.mode(0o666).create_new(flags);
        options
    };
    loop {
        match with(false).open(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            opened => return opened,
        }
        match with(true).open(path) {
            Ok(file) => {
                file.set_permissions(Permissions::from_mode(0o666))?;
                return Ok(file);
            }
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}

/// Reads the owner; the default while the file is being written.
fn read(file: &mut File) -> LockOwner {
    let mut text = String::new();
    let read = file.rewind().and_then(|()| file.take(64 * 1024).read_to_string(&mut text));
    read.ok().and_then(|_| serde_json::from_str(&text).ok()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_acquired_lock_knows_whether_it_was_released() {
        let dir = tempfile::tempdir().unwrap();
        let locks = Locks::open(dir.path()).unwrap();
        let robot = RequiredResource { name: "robot".to_owned(), slots: 1 };
        let owner = |run: &str| LockOwner {
            run: run.to_owned(),
            scope: format!("{run}.0."),
            ..LockOwner::default()
        };
        let take = |run: &str| locks.try_acquire(&robot, &owner(run)).unwrap().unwrap();
        let one = take("one");
        assert_eq!(one.abandoned, None);
        one.release();
        let two = take("two");
        assert_eq!(two.abandoned, None);
        // As after a kill.
        drop(two);
        let three = take("three");
        assert_eq!(three.abandoned, Some(owner("two")));
        assert_eq!(locks.held().unwrap()[0].owner, owner("three"));
    }

    #[test]
    fn what_others_write_into_a_lock_stops_no_process() {
        let dir = tempfile::tempdir().unwrap();
        let locks = Locks::open(dir.path()).unwrap();
        let robot = RequiredResource { name: "robot".to_owned(), slots: 1 };
        let forged = LockOwner {
            run: "a live run".to_owned(),
            scope: "2026-11-25T02-50-00Z-1f3a.0.".to_owned(),
            ..LockOwner::default()
        };
        let text = serde_json::to_string(&forged).unwrap();
        std::fs::write(dir.path().join("robot.1"), text).unwrap();
        let taken = locks.try_acquire(&robot, &LockOwner::default()).unwrap().unwrap();
        let expected = LockOwner { scope: String::new(), ..forged };
        assert_eq!(taken.abandoned, Some(expected), "it is told, but not believed");
        assert!(locks.held().unwrap().iter().all(|held| held.name == "robot"));
    }

    #[test]
    fn a_resource_has_as_many_locks_as_slots() {
        let dir = tempfile::tempdir().unwrap();
        let locks = Locks::open(&dir.path().join("locks")).unwrap();
        let owner =
            LockOwner { user: "ada".to_owned(), run: "r".to_owned(), ..LockOwner::default() };
        let arm = RequiredResource { name: "arm:left".to_owned(), slots: 2 };
        let [one, two] = [(); 2].map(|()| locks.try_acquire(&arm, &owner).unwrap().unwrap());
        let held = locks.try_acquire(&arm, &LockOwner::default()).unwrap().unwrap_err();
        assert_eq!(held, locks.held().unwrap());
        let slots: Vec<_> = held.iter().map(|held| (held.slot, held.owner.clone())).collect();
        assert_eq!(slots, [(1, owner.clone()), (2, owner.clone())]);
        // As for a descriptor of the guard.
        let kept = one.file.try_clone().unwrap();
        drop(one);
        assert_eq!(locks.held().unwrap().len(), 2);
        drop(kept);
        assert_eq!(locks.held().unwrap().len(), 1);
        let kept = two.file.try_clone().unwrap();
        two.release();
        assert!(locks.held().unwrap().is_empty());
        drop(kept);
    }
}
