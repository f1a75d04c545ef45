//! Locks on what there is only once, such as a robot: between the suites of a
//! run, and between all runs and users of a machine.
//!
//! A lock is a lock of the kernel on a file, so that it is never given twice,
//! and ends with the last process that has it: the runner, or after its death
//! the guard, which parks the robot first. What stands in the file says for
//! people who has it; who gives it back empties the file. So whoever gets a lock
//! whose file is not empty knows that runner and guard were killed, and stops what
//! they left. Files are never removed: who waits has them open.

mod orphans;
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

/// The variable that names another folder of locks.
pub const FOLDER_VARIABLE: &str = "RTF_LOCKS";

/// The folder of locks unless [`FOLDER_VARIABLE`] names another one: the same
/// for all users.
pub const FOLDER: &str = "/tmp/rtf-locks";

/// Who has a lock.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Owner {
    /// The user's name.
    pub user: String,
    /// The machine's name.
    pub host: String,
    /// The runner's process.
    pub pid: u32,
    /// Since when, as RFC 3339.
    pub since: String,
    /// The run.
    pub run: String,
    /// The suite.
    pub suite: String,
    /// What the scopes of its processes begin with.
    pub scope: String,
}

impl std::fmt::Display for Owner {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { user, host, pid, since, run, suite, scope: _ } = self;
        if self.run.is_empty() {
            return f.write_str("somebody");
        }
        write!(f, "{user}@{host} since {since} (suite {suite} of run {run}, process {pid})")
    }
}

/// The folder of a machine's locks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Locks {
    folder: PathBuf,
}

/// A lock that is ours. It ends with [`Lock::release`], or with the last
/// process that has its descriptor.
#[derive(Debug)]
pub struct Lock {
    file: File,
    /// Who had it before and never gave it back: runner and guard were killed.
    abandoned: Option<Owner>,
}

/// A lock that somebody has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Held {
    /// The resource.
    pub name: String,
    /// Which of several of the kind, from 1.
    pub slot: u32,
    /// Who has it.
    pub owner: Owner,
}

impl Locks {
    /// The locks of a folder, which is made for everybody if it is not there.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn open(folder: &Path) -> io::Result<Self> {
        match DirBuilder::new().mode(0o777).create(folder) {
            // As `/tmp`: everybody may add a file, nobody removes another's.
            Ok(()) => std::fs::set_permissions(folder, Permissions::from_mode(0o1777))?,
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
        Ok(Self { folder: folder.to_owned() })
    }

    /// Takes a lock; or says who has all there are.
    ///
    /// # Errors
    /// A file cannot be opened, locked or written.
    pub fn take(
        &self,
        resource: &RequiredResource,
        owner: &Owner,
    ) -> io::Result<Result<Lock, Vec<Held>>> {
        let mut held = Vec::new();
        for slot in 1..=resource.slots {
            let mut file = open(&self.folder.join(format!("{}.{slot}", resource.name)))?;
            if unix::lock(&file)? {
                let abandoned = Some(read(&mut file)).filter(|before| !before.scope.is_empty());
                let text = serde_json::to_string(owner)?;
                file.set_len(0)?;
                file.rewind()?;
                file.write_all(text.as_bytes())?;
                return Ok(Ok(Lock { file, abandoned }));
            }
            held.push(Held { name: resource.name.clone(), slot, owner: read(&mut file) });
        }
        Ok(Err(held))
    }

    /// All that somebody has, by name.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn held(&self) -> io::Result<Vec<Held>> {
        let mut all = Vec::new();
        for entry in std::fs::read_dir(&self.folder)? {
            let name = entry?.file_name();
            let known = name.to_str().and_then(|name| name.rsplit_once('.'));
            let Some((name, Ok(slot))) = known.map(|(name, slot)| (name, slot.parse())) else {
                continue;
            };
            let mut file = open(&self.folder.join(format!("{name}.{slot}")))?;
            if unix::is_locked(&file)? {
                all.push(Held { name: name.to_owned(), slot, owner: read(&mut file) });
            }
        }
        all.sort_by(|a, b| (&a.name, a.slot).cmp(&(&b.name, b.slot)));
        Ok(all)
    }
}

impl Lock {
    /// Gives it back, also if the guard has its descriptor.
    pub fn release(self) {
        let _ = clear(&self.file);
        // Who cannot unlock lets it end with the descriptors.
        let _ = unix::unlock(&self.file);
    }
}

impl AsFd for Lock {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.file.as_fd()
    }
}

/// Says that the one who has a lock gives it back in order. (The guard does so for
/// a runner that died.)
///
/// # Errors
/// It is not a lock.
pub fn clear(lock: impl AsFd) -> io::Result<()> {
    Ok(rustix::fs::ftruncate(lock, 0)?)
}

/// Opens a lock's file, or makes it for everybody. A link is not followed. (A
/// file of another user must not be opened with the flag that would make it:
/// Linux refuses that in folders like `/tmp`.)
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

/// What the file says; it may be being written.
fn read(file: &mut File) -> Owner {
    let mut text = String::new();
    let read = file.rewind().and_then(|()| file.take(64 * 1024).read_to_string(&mut text));
    read.ok().and_then(|_| serde_json::from_str(&text).ok()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_gets_a_lock_knows_whether_it_was_given_back() {
        let folder = tempfile::tempdir().unwrap();
        let locks = Locks::open(folder.path()).unwrap();
        let robot = RequiredResource { name: "robot".to_owned(), slots: 1 };
        let owner = |run: &str| Owner {
            run: run.to_owned(),
            scope: format!("{run}.0."),
            ..Owner::default()
        };
        let take = |run: &str| locks.take(&robot, &owner(run)).unwrap().unwrap();
        let one = take("one");
        assert_eq!(one.abandoned, None);
        one.release();
        let two = take("two");
        assert_eq!(two.abandoned, None);
        // As when it is killed.
        drop(two);
        let three = take("three");
        assert_eq!(three.abandoned, Some(owner("two")));
        assert_eq!(locks.held().unwrap()[0].owner, owner("three"));
    }

    #[test]
    fn there_are_as_many_as_the_suite_says() {
        let folder = tempfile::tempdir().unwrap();
        let locks = Locks::open(&folder.path().join("locks")).unwrap();
        let owner = Owner { user: "ada".to_owned(), run: "r".to_owned(), ..Owner::default() };
        let arm = RequiredResource { name: "arm:left".to_owned(), slots: 2 };
        let [one, two] = [(); 2].map(|()| locks.take(&arm, &owner).unwrap().unwrap());
        let held = locks.take(&arm, &Owner::default()).unwrap().unwrap_err();
        assert_eq!(held, locks.held().unwrap());
        let slots: Vec<_> = held.iter().map(|held| (held.slot, held.owner.clone())).collect();
        assert_eq!(slots, [(1, owner.clone()), (2, owner.clone())]);
        // The guard has a descriptor, too.
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
