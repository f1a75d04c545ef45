//! Everything below a process, and the orphans that it left.
//!
//! A process group is not a kill tree: a child that called `setsid` is not in
//! it. So the tree is walked through `/proc` while its root lives; what is
//! orphaned then comes to the runner, which is a child subreaper, and is told
//! apart by the scope variable in its environment.

use std::collections::HashSet;
use std::ffi::OsStr;
use std::path::Path;
use std::sync::{LazyLock, Mutex, PoisonError};

use rtf_model::LeftProcess;
use rtf_model::protocol::SCOPE_VARIABLE;

use super::unix;

const SIGKILL: i32 = 9;

/// The processes that this runner started itself and waits for itself.
static OWN_CHILDREN: LazyLock<Mutex<HashSet<i32>>> = LazyLock::new(Mutex::default);

/// Remembers a process that the runner started and will wait for.
pub fn add_own_child(pid: i32) {
    OWN_CHILDREN.lock().unwrap_or_else(PoisonError::into_inner).insert(pid);
}

/// Forgets a process that the runner has waited for.
pub fn remove_own_child(pid: i32) {
    OWN_CHILDREN.lock().unwrap_or_else(PoisonError::into_inner).remove(&pid);
}

fn is_own_child(pid: i32) -> bool {
    OWN_CHILDREN.lock().unwrap_or_else(PoisonError::into_inner).contains(&pid)
}

/// Kills a process, its group, and everything below it.
pub fn kill_tree(root: i32) {
    // What is found first cannot have children later than it is killed, what
    // is orphaned meanwhile is found by the sweep.
    for pid in descendants(root) {
        unix::signal_process(pid, SIGKILL);
    }
    unix::signal_group(root, SIGKILL);
    unix::signal_process(root, SIGKILL);
}

/// Kills the orphans of a scope and all that is below them. Returns what was killed.
#[must_use]
pub fn sweep(scope: &str) -> Vec<LeftProcess> {
    sweep_if(|pid| scope_of(pid).is_some_and(|found| found == scope.as_bytes()))
}

/// Kills every process below this one, also those that the runner waits for.
#[must_use]
pub fn kill_everything() -> Vec<LeftProcess> {
    OWN_CHILDREN.lock().unwrap_or_else(PoisonError::into_inner).clear();
    sweep_all()
}

/// Kills every process below this one that the runner does not wait for itself.
#[must_use]
pub fn sweep_all() -> Vec<LeftProcess> {
    sweep_if(|_| true)
}

fn sweep_if(belongs: impl Fn(i32) -> bool) -> Vec<LeftProcess> {
    let mut left = Vec::new();
    let mut seen = HashSet::new();
    loop {
        let orphans = children_of("/proc/self/task").into_iter();
        let found: Vec<i32> = orphans
            .filter(|pid| !is_own_child(*pid))
            .filter(|pid| is_zombie(*pid) || belongs(*pid))
            .flat_map(|pid| std::iter::once(pid).chain(descendants(pid)))
            .collect();
        let before = left.len();
        for pid in &found {
            if is_zombie(*pid) {
                unix::reap(*pid);
            } else if seen.insert(*pid) {
                left.push(LeftProcess { pid: *pid, command: command_of(*pid), owner: None });
                unix::signal_process(*pid, SIGKILL);
            }
        }
        if left.len() == before {
            return left;
        }
    }
}

/// Everything below a process, parents before children.
fn descendants(root: i32) -> Vec<i32> {
    let mut found = children_of(format!("/proc/{root}/task"));
    let mut next = 0;
    while next < found.len() {
        let children = children_of(format!("/proc/{}/task", found[next]));
        found.extend(children);
        next += 1;
    }
    found
}

/// The children of all threads of a process.
fn children_of(tasks: impl AsRef<Path>) -> Vec<i32> {
    let Ok(entries) = std::fs::read_dir(tasks) else {
        return Vec::new();
    };
    let lists =
        entries.flatten().map(|entry| std::fs::read_to_string(entry.path().join("children")));
    let lists: Vec<String> = lists.flatten().collect();
    lists
        .iter()
        .flat_map(|list| list.split_whitespace())
        .filter_map(|pid| pid.parse().ok())
        .collect()
}

fn is_zombie(pid: i32) -> bool {
    let Ok(stat) = std::fs::read_to_string(format!("/proc/{pid}/stat")) else {
        return false;
    };
    stat.rsplit_once(") ").is_some_and(|(_, rest)| rest.starts_with('Z'))
}

/// The value of the scope variable of a process.
fn scope_of(pid: i32) -> Option<Vec<u8>> {
    let environ = std::fs::read(format!("/proc/{pid}/environ")).ok()?;
    let prefix = format!("{SCOPE_VARIABLE}=");
    let found =
        environ.split(|byte| *byte == 0).find_map(|entry| entry.strip_prefix(prefix.as_bytes()));
    found.map(<[u8]>::to_vec)
}

/// A process's command line for people; its name when it has none.
fn command_of(pid: i32) -> String {
    let line = std::fs::read(format!("/proc/{pid}/cmdline")).unwrap_or_default();
    let words: Vec<_> = line
        .split(|byte| *byte == 0)
        .filter(|word| !word.is_empty())
        .map(String::from_utf8_lossy)
        .collect();
    if !words.is_empty() {
        return shell_words::join(words.iter().map(AsRef::<str>::as_ref));
    }
    let name = std::fs::read_to_string(format!("/proc/{pid}/comm")).unwrap_or_default();
    OsStr::new(name.trim()).to_string_lossy().into_owned()
}
