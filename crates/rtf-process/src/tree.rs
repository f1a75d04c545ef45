//! Finds and kills everything below a process, and its orphans.
//!
//! A process group is not a kill tree: a child that called `setsid` is not in it. So this
//! module walks the tree in `/proc` while its root is alive. The runner is a child
//! subreaper: it adopts orphans, and identifies them by the scope variable in their
//! environment.

mod members;
mod sweep;

use std::collections::HashSet;
use std::ffi::OsStr;
use std::os::fd::AsRawFd;
use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use rtf_model::LeakedProcess;
use rtf_model::protocol::{FORK_SERVER_VARIABLE, OWNER_VARIABLE, SCOPE_VARIABLE};

use crate::unix;
pub use members::{SignalReach, Tree};
pub use sweep::{Effort, await_ending, await_ending_of, orphans, orphans_of, sweep_if};

const SIGKILL: i32 = 9;
const SIGTERM: i32 = 15;
const SIGCONT: i32 = 18;
/// How long [`kill_program`] waits.
const KILL_LIMIT: Duration = Duration::from_secs(1);
/// The time between polls for processes that are ending.
const POLL_INTERVAL: Duration = Duration::from_millis(1);
/// Lists the children of this process.
const OWN_TASKS: &str = "/proc/self/task";
/// The number of polls of an environment that appears empty, and the time between them.
const EXEC_POLLS: u32 = 50;
const EXEC_POLL_INTERVAL: Duration = Duration::from_micros(200);

/// The processes that the runner started, and for which it will wait.
static OWN_CHILDREN: LazyLock<Mutex<HashSet<i32>>> = LazyLock::new(Mutex::default);

fn own_children() -> MutexGuard<'static, HashSet<i32>> {
    OWN_CHILDREN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Odd while a process is being started: it is already a child, but not yet registered.
static STARTS: AtomicUsize = AtomicUsize::new(0);

/// Starts a process for which the runner will wait, and registers it. Call it from one
/// thread only.
pub fn start_own_child<T>(start: impl FnOnce() -> T, pid_of: impl FnOnce(&T) -> Option<i32>) -> T {
    STARTS.fetch_add(1, Ordering::SeqCst);
    let started = start();
    if let Some(pid) = pid_of(&started) {
        own_children().insert(pid);
    }
    STARTS.fetch_add(1, Ordering::SeqCst);
    started
}

/// Unregisters a process for which the runner has waited.
pub fn remove_own_child(pid: i32) {
    own_children().remove(&pid);
}

/// Whether the runner started a process and has not waited for it yet.
pub fn is_own_child(pid: i32) -> bool {
    own_children().contains(&pid)
}

/// Kills a process, its group, and everything below it.
pub fn kill_tree(root: i32) {
    // A killed process cannot start another; the sweep finds orphans of this moment.
    for pid in descendants(root) {
        unix::signal_process(pid, SIGKILL);
    }
    unix::signal_group(root, SIGKILL);
    unix::signal_process(root, SIGKILL);
}

/// Kills the orphans of a scope and everything below them. Returns the killed processes.
pub fn sweep(scope: &str, effort: Effort) -> Vec<LeakedProcess> {
    sweep_if(effort, |pid| scope_of(pid).is_some_and(|found| found == scope.as_bytes()))
}

/// Kills every process below this one, including those for which the runner waits.
pub fn kill_everything() -> Vec<LeakedProcess> {
    own_children().clear();
    sweep_all()
}

/// Kills every process below this one, except those for which the runner waits.
pub fn sweep_all() -> Vec<LeakedProcess> {
    sweep_if(Effort::Once, |_| true)
}

/// Kills every process below this one, repeatedly until none is left or the limit has
/// passed. Returns the killed processes.
pub fn kill_until_none_is_left(limit: Duration) -> Vec<LeakedProcess> {
    let end = Instant::now() + limit;
    let mut left = Vec::new();
    loop {
        add_new(&mut left, kill_everything());
        if children_of(OWN_TASKS).is_empty() || Instant::now() >= end {
            return left;
        }
        std::thread::sleep(POLL_INTERVAL);
    }
}

/// Adds the processes that are not in the list yet.
pub fn add_new(known: &mut Vec<LeakedProcess>, more: Vec<LeakedProcess>) {
    let pids: HashSet<i32> = known.iter().map(|process| process.pid).collect();
    known.extend(more.into_iter().filter(|process| !pids.contains(&process.pid)));
}

/// Sends SIGTERM to the processes below this one whose owner has this prefix, and waits for
/// their end.
pub fn terminate_owned(prefix: &str, limit: Duration) {
    owned(prefix).into_iter().for_each(|pid| unix::signal_process(pid, SIGTERM));
    let end = Instant::now() + limit;
    while !owned(prefix).is_empty() && Instant::now() < end {
        std::thread::sleep(POLL_INTERVAL);
    }
}

/// Returns the living processes below this one whose owner has this prefix.
fn owned(prefix: &str) -> Vec<i32> {
    // The children of a runner that hangs in the kernel are not orphans yet.
    let own = rustix::process::getpid().as_raw_nonzero().get();
    let living = descendants(own).into_iter().filter(|pid| !is_zombie(*pid));
    living.filter(|pid| owner_of(*pid).is_some_and(|owner| owner.starts_with(prefix))).collect()
}

/// Kills the processes below this one whose owner has this prefix, and everything below
/// them. Returns the killed processes. Reaps none.
pub fn kill_owned(prefix: &str) -> Vec<LeakedProcess> {
    let mut left = Vec::new();
    loop {
        let found = owned(prefix).into_iter().flat_map(with_descendants).map(describe).collect();
        let before = left.len();
        add_new(&mut left, found);
        for process in &left[before..] {
            unix::signal_process(process.pid, SIGKILL);
        }
        if left.len() == before {
            return left;
        }
    }
}

/// Kills the processes below this one with this program, and waits for their end. Returns
/// whether there were some.
pub fn kill_program(name: &str) -> bool {
    let own = rustix::process::getpid().as_raw_nonzero().get();
    let is_named = |pid: &i32| {
        let comm = std::fs::read_to_string(format!("/proc/{pid}/comm")).unwrap_or_default();
        comm.trim_end() == name
    };
    let found: Vec<i32> = descendants(own).into_iter().filter(is_named).collect();
    found.iter().for_each(|pid| unix::signal_process(*pid, SIGKILL));
    let end = Instant::now() + KILL_LIMIT;
    let runs = |pid: &i32| state_of(*pid).is_some_and(|state| state != 'Z');
    while found.iter().any(runs) && Instant::now() < end {
        std::thread::sleep(POLL_INTERVAL);
    }
    !found.is_empty()
}

/// Continues all processes below this one. A process that is about to stop does not show it yet.
pub fn continue_all() {
    let own = rustix::process::getpid().as_raw_nonzero().get();
    descendants(own).into_iter().for_each(|pid| unix::signal_process(pid, SIGCONT));
}

/// Kills and reaps a child of this process.
pub fn kill_child(child: i32) {
    if is_child(child) {
        unix::signal_process(child, SIGKILL);
        unix::await_end(child);
    }
}

/// Returns the child of this process with this scope.
pub fn child_of_scope(scope: &str) -> Option<i32> {
    let belongs = |pid: &i32| scope_of(*pid).is_some_and(|found| found == scope.as_bytes());
    children_of(OWN_TASKS).into_iter().find(belongs)
}

/// Whether a process is a child of this one, alive or not.
pub fn is_child(pid: i32) -> bool {
    children_of(OWN_TASKS).contains(&pid)
}

/// Makes the host's end of a channel inheritable by the next process that is started.
/// Returns its address, as the host expects it in its environment.
///
/// # Errors
/// The descriptor is not open.
pub fn inheritable(channel: &std::os::unix::net::UnixStream) -> std::io::Result<String> {
    unix::let_inherit(channel)?;
    Ok(format!("fd:{}", channel.as_raw_fd()))
}

/// Whether a process is a fork server, which belongs to the runner.
fn is_fork_server(pid: i32) -> bool {
    variable_of(pid, FORK_SERVER_VARIABLE).is_some()
}

/// Returns a process, the adopted orphans of its scope, and everything below them.
pub fn members(root: i32, scope: &str) -> Vec<i32> {
    let roots = std::iter::once(root).chain(orphans_of(scope));
    roots.flat_map(with_descendants).collect()
}

/// Returns this user's processes whose scope has this prefix, and everything below them.
pub fn find_by_scope(prefix: &str) -> Vec<LeakedProcess> {
    let own = rustix::process::geteuid().as_raw();
    let entries = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    let pids = entries.filter_map(|entry| {
        let pid = entry.file_name().to_str()?.parse::<i32>().ok()?;
        (entry.metadata().ok()?.uid() == own).then_some(pid)
    });
    let belongs = |pid: &i32| {
        // Read once: most processes have no scope.
        let environ = std::fs::read(format!("/proc/{pid}/environ")).unwrap_or_default();
        variable_in(&environ, SCOPE_VARIABLE)
            .is_some_and(|scope| scope.starts_with(prefix.as_bytes()))
    };
    let mut found = Vec::new();
    for pid in pids.filter(belongs) {
        let below = with_descendants(pid);
        add_new(&mut found, below.filter(|pid| !is_zombie(*pid)).map(describe).collect());
    }
    found
}

/// Returns a process and everything below it, parents before children.
pub fn with_descendants(root: i32) -> impl Iterator<Item = i32> {
    std::iter::once(root).chain(descendants(root))
}

/// Returns everything below a process, parents before children.
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

/// Returns the children of all threads of a process.
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
    state_of(pid) == Some('Z')
}

/// Whether a process is stopped, by a signal or a debugger.
pub fn is_stopped(pid: i32) -> bool {
    matches!(state_of(pid), Some('T' | 't'))
}

/// The state of a process, as a letter of `/proc/PID/stat`.
fn state_of(pid: i32) -> Option<char> {
    stat_of(pid)?.chars().next()
}

/// Whether a process is exiting: `PF_EXITING` of Linux' include/linux/sched.h.
fn is_exiting(pid: i32) -> bool {
    const EXITING: u64 = 0x4;
    let flags = stat_of(pid).and_then(|stat| stat.split(' ').nth(6)?.parse::<u64>().ok());
    flags.is_none_or(|flags| flags & EXITING != 0)
}

/// The fields of `/proc/PID/stat` from the state on.
fn stat_of(pid: i32) -> Option<String> {
    let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    Some(stat.rsplit_once(") ")?.1.to_owned())
}

/// Whether a process without a scope is known to have none. While a process executes a
/// program or exits, it is running and its environment appears empty, on a busy machine
/// for longer than [`environ_of`] waits.
fn has_known_environ(pid: i32) -> bool {
    match std::fs::read(format!("/proc/{pid}/environ")) {
        Ok(environ) if environ.is_empty() => matches!(state_of(pid), Some('S' | 'I' | 'T' | 't')),
        Ok(_) => true,
        // Another user's process, or, for an ordinary user, any process that has given its
        // memory back while it exits: its children are not orphans yet.
        Err(error) => error.kind() == std::io::ErrorKind::PermissionDenied && !is_exiting(pid),
    }
}

/// Reads the environment of a process. It appears empty for a moment while the process
/// executes a program; if it stays empty, the process has cleared it.
fn environ_of(pid: i32) -> Option<Vec<u8>> {
    static CLEARED: LazyLock<Mutex<HashSet<i32>>> = LazyLock::new(Mutex::default);
    let mut cleared = CLEARED.lock().unwrap_or_else(PoisonError::into_inner);
    let polls = if cleared.contains(&pid) { 1 } else { EXEC_POLLS };
    for _ in 0..polls {
        let environ = std::fs::read(format!("/proc/{pid}/environ")).ok()?;
        if !environ.is_empty() || is_zombie(pid) {
            return Some(environ);
        }
        std::thread::sleep(EXEC_POLL_INTERVAL);
    }
    cleared.insert(pid);
    None
}

/// Describes a process for reports.
pub(crate) fn describe(pid: i32) -> LeakedProcess {
    LeakedProcess { pid, command: command_of(pid), owner: owner_of(pid) }
}

/// Who started a process: `test arm/EncoderTest`.
fn owner_of(pid: i32) -> Option<String> {
    let owner = variable_of(pid, OWNER_VARIABLE)?;
    Some(String::from_utf8_lossy(&owner).into_owned())
}

/// The value of the scope variable of a process.
fn scope_of(pid: i32) -> Option<Vec<u8>> {
    variable_of(pid, SCOPE_VARIABLE)
}

/// The value of a variable in the environment of a process, as it was started.
fn variable_of(pid: i32, name: &str) -> Option<Vec<u8>> {
    variable_in(&environ_of(pid)?, name)
}

fn variable_in(environ: &[u8], name: &str) -> Option<Vec<u8>> {
    let prefix = format!("{name}=");
    let found =
        environ.split(|byte| *byte == 0).find_map(|entry| entry.strip_prefix(prefix.as_bytes()));
    found.map(<[u8]>::to_vec)
}

/// The command line of a process; its name if that is empty.
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
