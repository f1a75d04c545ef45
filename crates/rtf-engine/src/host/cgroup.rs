//! Control groups (version 2): all that a process started, wherever it went.
//!
//! Where the runner may make groups below its own, each process that it starts
//! gets one. A daemon that left its group and session, emptied its environment
//! and came to another parent is still in it, and `cgroup.kill` ends all of them
//! in one step. Where that cannot be had, [`super::tree`] does it alone; it also
//! finds what was forked before the process was in its group.

use std::path::{Path, PathBuf};
use std::time::Duration;

use rtf_model::LeakedProcess;

use super::tree;

/// How often, and how long apart, killed processes are looked for.
const LOOKS: u32 = 100;
const ENDING: Duration = Duration::from_millis(1);

/// The groups of a run.
#[derive(Debug)]
pub struct Cgroups {
    folder: PathBuf,
}

impl Cgroups {
    /// Makes a group for the groups of this process; `None` where it may not.
    /// Groups of runners that were killed are removed.
    #[must_use]
    pub fn get() -> Option<Self> {
        let own = own_folder()?;
        remove_stale(&own);
        let folder = own.join(name_of(std::process::id()));
        std::fs::create_dir(&folder).ok()?;
        // Linux has it since 5.14.
        let groups = Self { folder };
        groups.folder.join("cgroup.kill").exists().then_some(groups)
    }

    /// Puts a process that was just started into a new group.
    #[must_use]
    pub fn enter(&self, name: &str, pid: i32) -> Option<Cgroup> {
        let group = Cgroup { folder: self.folder.join(name) };
        std::fs::create_dir(&group.folder).ok()?;
        // One that has ended already is in none.
        std::fs::write(group.folder.join("cgroup.procs"), pid.to_string()).ok()?;
        Some(group)
    }
}

impl Drop for Cgroups {
    fn drop(&mut self) {
        remove(&self.folder);
    }
}

/// The group of one process and all that it started. It is removed on drop if
/// nothing is in it.
#[derive(Debug)]
pub struct Cgroup {
    folder: PathBuf,
}

impl Cgroup {
    /// Kills all that is in it.
    pub fn kill(&self) {
        let _ = std::fs::write(self.folder.join("cgroup.kill"), "1");
    }

    /// Kills all that is in it, and waits a moment for its end. Returns what was
    /// killed.
    pub async fn clear(&self) -> Vec<LeakedProcess> {
        let mut left = Vec::new();
        for _ in 0..LOOKS {
            let members = members(&self.folder);
            if members.is_empty() {
                break;
            }
            tree::add(&mut left, members.into_iter().map(tree::described).collect());
            self.kill();
            tokio::time::sleep(ENDING).await;
        }
        left
    }
}

impl Drop for Cgroup {
    fn drop(&mut self) {
        remove(&self.folder);
    }
}

/// Removes what a runner that died left of its groups.
pub fn remove_groups_of(runner: i32) {
    if let (Some(own), Ok(runner)) = (own_folder(), u32::try_from(runner)) {
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

/// The groups in a group: a process may have made some.
fn groups_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let folders = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_dir()));
    folders.map(|entry| entry.path()).collect()
}

fn members(folder: &Path) -> Vec<i32> {
    let list = std::fs::read_to_string(folder.join("cgroup.procs")).unwrap_or_default();
    let inner = groups_in(folder);
    let own = list.lines().filter_map(|pid| pid.parse().ok());
    own.chain(inner.iter().flat_map(|inner| members(inner))).collect()
}

/// The kernel refuses to remove a group in which something lives.
fn remove(folder: &Path) {
    groups_in(folder).iter().for_each(|inner| remove(inner));
    let _ = std::fs::remove_dir(folder);
}

fn own_folder() -> Option<PathBuf> {
    let groups = std::fs::read_to_string("/proc/self/cgroup").ok()?;
    let mounts = std::fs::read_to_string("/proc/self/mountinfo").ok()?;
    folder_of(&groups, &mounts)
}

/// The folder of the group of version 2, from `/proc/PID/cgroup` and
/// `/proc/PID/mountinfo`.
fn folder_of(groups: &str, mounts: &str) -> Option<PathBuf> {
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
    fn the_own_group_is_found_in_whatever_is_mounted() {
        let unified = "41 31 0:38 / /sys/fs/cgroup rw,relatime - cgroup2 cgroup2 rw\n";
        let hybrid = "30 20 0:1 / /sys/fs/cgroup/pids rw - cgroup cgroup rw,pids\n\
            41 31 0:38 / /sys/fs/cgroup/unified rw shared:9 - cgroup2 cgroup2 rw\n";
        let part = "41 31 0:38 /docker/1 /sys/fs/cgroup rw - cgroup2 cgroup rw\n";
        for (groups, mounts, folder) in [
            ("0::/user.slice/a b\n", unified, Some("/sys/fs/cgroup/user.slice/a b")),
            ("8:pids:/x\n0::/y\n", hybrid, Some("/sys/fs/cgroup/unified/y")),
            ("0::/docker/1/z\n", part, Some("/sys/fs/cgroup/z")),
            ("0::/elsewhere\n", part, None),
            ("8:pids:/x\n", hybrid, None),
            ("0::/\n", "", None),
        ] {
            assert_eq!(folder_of(groups, mounts), folder.map(PathBuf::from), "{groups}");
        }
    }

    /// Where there are groups, nothing escapes; where there are none, that is
    /// because this process may not make one.
    #[tokio::test]
    async fn a_daemon_without_a_trace_is_found_and_killed() {
        let Some(groups) = Cgroups::get() else {
            let made = own_folder().map(|own| std::fs::create_dir(own.join("rtf-test")));
            assert!(!matches!(made, Some(Ok(()))), "groups can be made here");
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
        assert!(members(&group.folder).is_empty());
        let folder = groups.folder.clone();
        drop((group, groups));
        assert!(!folder.exists(), "its groups are removed");
    }
}
