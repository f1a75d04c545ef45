//! Control groups (version 2), which contain everything that a process started.
//!
//! Where the runner may create groups below its own, each process gets one. A daemon that
//! left its process group and session, emptied its environment and has another parent is
//! still in it, and `cgroup.kill` ends all processes in one step. Without permission,
//! [`super::tree`] is the only means; it also finds processes that were forked before
//! their parent joined its group.

use std::path::{Path, PathBuf};
use std::time::Duration;

use rtf_model::LeakedProcess;

use crate::tree;

/// The number of polls for killed processes, and the time between them.
const POLLS: u32 = 100;
const POLL_INTERVAL: Duration = Duration::from_millis(1);

/// The groups of a run.
#[derive(Debug)]
pub struct Cgroups {
    dir: PathBuf,
}

impl Cgroups {
    /// Creates a group for the groups of this process; `None` without permission. Removes
    /// the groups of killed runners.
    pub fn create() -> Option<Self> {
        let own = own_dir()?;
        remove_stale(&own);
        let dir = own.join(name_of(std::process::id()));
        std::fs::create_dir(&dir).ok()?;
        // Requires Linux 5.14.
        let groups = Self { dir };
        groups.dir.join("cgroup.kill").exists().then_some(groups)
    }

    /// Moves a process that was just started into a new group.
    pub fn enter(&self, name: &str, pid: i32) -> Option<Cgroup> {
        let group = Cgroup { dir: self.dir.join(name) };
        std::fs::create_dir(&group.dir).ok()?;
        // Fails if the process has ended.
        std::fs::write(group.dir.join("cgroup.procs"), pid.to_string()).ok()?;
        Some(group)
    }
}

impl Drop for Cgroups {
    fn drop(&mut self) {
        remove(&self.dir);
    }
}

/// The group of one process and everything that it started. Removed on drop if empty.
#[derive(Debug)]
pub struct Cgroup {
    dir: PathBuf,
}

impl Cgroup {
    pub fn kill(&self) {
        let _ = std::fs::write(self.dir.join("cgroup.kill"), "1");
    }

    pub fn members(&self) -> Vec<i32> {
        members(&self.dir)
    }

    /// Kills all its processes, waits up to 100 ms for their end, and returns them.
    pub async fn clear(&self) -> Vec<LeakedProcess> {
        let mut left = Vec::new();
        for _ in 0..POLLS {
            let members = members(&self.dir);
            if members.is_empty() {
                break;
            }
            tree::add_new(&mut left, members.into_iter().map(tree::describe).collect());
            self.kill();
            tokio::time::sleep(POLL_INTERVAL).await;
        }
        left
    }
}

impl Drop for Cgroup {
    fn drop(&mut self) {
        remove(&self.dir);
    }
}

/// Removes the groups of a runner that died.
pub fn remove_groups_of(runner: i32) {
    if let (Some(own), Ok(runner)) = (own_dir(), u32::try_from(runner)) {
        remove(&own.join(name_of(runner)));
    }
}

fn name_of(runner: u32) -> String {
    format!("rtf-{runner}")
}

fn remove_stale(own: &Path) {
    for entry in std::fs::read_dir(own).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let runner = name.to_str().and_then(|name| name.strip_prefix("rtf-")?.parse::<u32>().ok());
        if runner.is_some_and(|runner| !Path::new("/proc").join(runner.to_string()).exists()) {
            remove(&entry.path());
        }
    }
}

/// The groups in a group: a process may have created some.
fn groups_in(dir: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(dir).into_iter().flatten().flatten();
    let dirs = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_dir()));
    dirs.map(|entry| entry.path()).collect()
}

fn members(dir: &Path) -> Vec<i32> {
    let list = std::fs::read_to_string(dir.join("cgroup.procs")).unwrap_or_default();
    let inner = groups_in(dir);
    let own = list.lines().filter_map(|pid| pid.parse().ok());
    own.chain(inner.iter().flat_map(|inner| members(inner))).collect()
}

/// Removes a group with those in it. The kernel refuses to remove a group with processes.
fn remove(dir: &Path) {
    groups_in(dir).iter().for_each(|inner| remove(inner));
    let _ = std::fs::remove_dir(dir);
}

fn own_dir() -> Option<PathBuf> {
    let groups = std::fs::read_to_string("/proc/self/cgroup").ok()?;
    let mounts = std::fs::read_to_string("/proc/self/mountinfo").ok()?;
    group_dir(&groups, &mounts)
}

/// The directory of the group of version 2, from `/proc/PID/cgroup` and
/// `/proc/PID/mountinfo`.
fn group_dir(groups: &str, mounts: &str) -> Option<PathBuf> {
    let own = Path::new(groups.lines().find_map(|line| line.strip_prefix("0::"))?);
    mounts.lines().find_map(|line| {
        let (before, after) = line.split_once(" - ")?;
        let mut fields = before.split(' ').skip(3);
        let (root, mounted) = (fields.next()?, fields.next()?);
        let inside = after.starts_with("cgroup2 ").then(|| own.strip_prefix(root).ok())??;
        Some(Path::new(mounted).join(inside))
    })
}

#[cfg(test)]
mod tests {
    use std::io::BufRead as _;
    use std::os::unix::process::CommandExt as _;
    use std::process::{Command, Stdio};

    use super::*;

    #[test]
    fn the_group_of_this_process_is_found_in_each_kind_of_mount() {
        let unified = "41 31 0:38 / /sys/fs/cgroup rw,relatime - cgroup2 cgroup2 rw\n";
        let hybrid = "30 20 0:1 / /sys/fs/cgroup/pids rw - cgroup cgroup rw,pids\n\
            41 31 0:38 / /sys/fs/cgroup/unified rw shared:9 - cgroup2 cgroup2 rw\n";
        let part = "41 31 0:38 /docker/1 /sys/fs/cgroup rw - cgroup2 cgroup rw\n";
        for (groups, mounts, dir) in [
            ("0::/user.slice/a b\n", unified, Some("/sys/fs/cgroup/user.slice/a b")),
            ("8:pids:/x\n0::/y\n", hybrid, Some("/sys/fs/cgroup/unified/y")),
            ("0::/docker/1/z\n", part, Some("/sys/fs/cgroup/z")),
            ("0::/elsewhere\n", part, None),
            ("8:pids:/x\n", hybrid, None),
            ("0::/\n", "", None),
        ] {
            assert_eq!(group_dir(groups, mounts), dir.map(PathBuf::from), "{groups}");
        }
    }

    /// Without groups, the test checks that this process may not create one.
    #[tokio::test]
    async fn a_detached_daemon_with_an_empty_environment_is_killed() {
        let Some(groups) = Cgroups::create() else {
            let made = own_dir().map(|own| std::fs::create_dir(own.join("rtf-test")));
            assert!(!matches!(made, Some(Ok(()))), "groups can be created here");
            return;
        };
        let script = "read -r _; setsid env -i sh -c 'sleep 1000 & echo $!'; exit 0";
        let mut shell = Command::new("sh")
            .args(["-c", script])
            .process_group(0)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let group = groups.enter("daemon", i32::try_from(shell.id()).unwrap()).unwrap();
        drop(shell.stdin.take());
        let mut printed = std::io::BufReader::new(shell.stdout.take().unwrap());
        let mut daemon = String::new();
        printed.read_line(&mut daemon).unwrap();
        shell.wait().unwrap();
        let left = group.clear().await;
        let left: Vec<String> = left.iter().map(|left| left.pid.to_string()).collect();
        assert_eq!(left, [daemon.trim()]);
        assert!(members(&group.dir).is_empty());
        let dir = groups.dir.clone();
        drop((group, groups));
        assert!(!dir.exists(), "its groups are removed");
    }
}
