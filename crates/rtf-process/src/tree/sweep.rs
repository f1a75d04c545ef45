//! Kills orphans, even if they start new processes continuously.

use std::collections::HashSet;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use rtf_model::LeakedProcess;

use super::{
    OWN_TASKS, POLL_INTERVAL, SIGCONT, SIGKILL, STARTS, children_of, descendants, describe,
    has_known_environ, is_exiting, is_fork_server, is_own_child, is_stopped, is_zombie, scope_of,
    state_of, unix,
};

const SIGSTOP: i32 = 19;
/// How long a sweep continues while it finds new orphans.
const SWEEP_LIMIT: Duration = Duration::from_millis(500);
/// How long a sweep waits for exiting orphans, whose children are not orphans yet. The kernel
/// needs long for a process with much memory.
const EXIT_LIMIT: Duration = Duration::from_secs(5);
/// How long an orphan sleeps that is not about to end, and how long others may take.
const IDLE_LIMIT: Duration = Duration::from_millis(100);
const ENDING_LIMIT: Duration = Duration::from_secs(2);
/// The time between passes that found nothing.
const PASS_INTERVAL: Duration = Duration::from_micros(200);
/// The number of passes over a tree that grows while it is being stopped.
const STOP_PASSES: u32 = 100;

/// How many passes in a row have to find nothing new.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// One. The kernel's list of children may miss a process that is being orphaned in
    /// that instant; a later sweep finds it.
    Once,
    /// Several, with pauses: a leak must not be missed.
    Thorough,
}

impl Effort {
    fn quiet_passes(self) -> u32 {
        match self {
            Self::Once => 1,
            Self::Thorough => 10,
        }
    }
}

/// The orphans that this process has adopted, alive or not.
pub fn orphans() -> impl Iterator<Item = i32> {
    children_of(OWN_TASKS).into_iter().filter(|pid| !is_own_child(*pid))
}

/// Waits for the orphans that belong to something and are about to end: the helpers of a library
/// notice the end of their program. Others sleep.
pub fn await_ending(belongs: impl Fn(i32) -> bool) {
    let mut wait = EndingWait::default();
    while wait.goes_on(orphans().filter(|pid| belongs(*pid))) {
        std::thread::sleep(POLL_INTERVAL);
    }
}

/// The same for the remaining processes that `left` finds, in a task.
pub async fn await_ending_of(left: impl Fn() -> Vec<i32>) {
    let mut wait = EndingWait::default();
    while wait.goes_on(left().into_iter()) {
        tokio::time::sleep(POLL_INTERVAL).await;
    }
}

pub fn orphans_of(scope: &str) -> Vec<i32> {
    let belongs = |pid: &i32| scope_of(*pid).is_some_and(|found| found == scope.as_bytes());
    orphans().filter(belongs).collect()
}

/// A wait for processes that are about to end.
struct EndingWait {
    start: Instant,
    last_activity: Instant,
}

impl Default for EndingWait {
    fn default() -> Self {
        let now = Instant::now();
        Self { start: now, last_activity: now }
    }
}

impl EndingWait {
    /// Whether some are left that may end soon. Reaps those that have ended.
    fn goes_on(&mut self, left: impl Iterator<Item = i32>) -> bool {
        let mut left = left.peekable();
        if left.peek().is_none() {
            return false;
        }
        let now = Instant::now();
        for pid in left {
            match state_of(pid) {
                Some('Z') => unix::reap(pid),
                Some('S' | 'I' | 'T' | 't') => {}
                _ => self.last_activity = now,
            }
        }
        now - self.last_activity < IDLE_LIMIT && now - self.start < ENDING_LIMIT
    }
}

/// Kills the adopted orphans that belong to something, and everything below them. Returns the
/// killed processes. Repeats passes until enough of them found nothing new, or the limit has
/// passed.
pub fn sweep_if(effort: Effort, belongs: impl Fn(i32) -> bool) -> Vec<LeakedProcess> {
    let start = Instant::now();
    let mut sweep = Sweep::default();
    let mut quiet = 0;
    loop {
        quiet = if sweep.pass(&belongs) { 0 } else { quiet + 1 };
        if quiet >= effort.quiet_passes() {
            break;
        }
        let limit = if sweep.awaits_exit { EXIT_LIMIT } else { SWEEP_LIMIT };
        if start.elapsed() >= limit {
            sweep.report_missed();
            break;
        }
        if quiet > 0 || sweep.awaits_exit {
            std::thread::sleep(PASS_INTERVAL);
        }
    }
    sweep.left
}

/// The results of a sweep.
#[derive(Default)]
struct Sweep {
    left: Vec<LeakedProcess>,
    killed: HashSet<i32>,
    zombies: HashSet<i32>,
    /// Orphans that belong to something else.
    others: HashSet<i32>,
    /// Orphans that were stopped and whose owner is not known yet.
    stopped: HashSet<i32>,
    /// Whether the last pass found an orphan that is exiting.
    awaits_exit: bool,
    passes: u32,
    /// The last process that ended before its scope could be read.
    missed: Option<i32>,
}

impl Sweep {
    /// Kills the orphans that belong to the scope. Returns whether there was a new process.
    fn pass(&mut self, belongs: &impl Fn(i32) -> bool) -> bool {
        self.passes += 1;
        self.awaits_exit = false;
        let starts = STARTS.load(Ordering::SeqCst);
        let orphans = children_of(OWN_TASKS);
        // A process that is being started may appear as a dead orphan.
        let is_quiet = starts.is_multiple_of(2) && STARTS.load(Ordering::SeqCst) == starts;
        let mut changed = false;
        for pid in orphans.into_iter().filter(|pid| !is_own_child(*pid)) {
            if is_zombie(pid) {
                changed |= self.zombies.insert(pid);
                if !self.killed.contains(&pid) {
                    self.missed = Some(pid);
                }
                if is_quiet {
                    unix::reap(pid);
                }
            } else if !self.others.contains(&pid) && !self.killed.contains(&pid) {
                changed |= self.examine(pid, belongs);
            }
        }
        changed
    }

    /// Kills an orphan and everything below it if it belongs to the scope. Processes that
    /// keep replacing themselves are only caught if they are stopped first.
    fn examine(&mut self, pid: i32, belongs: &impl Fn(i32) -> bool) -> bool {
        if self.passes > 1 && !is_stopped(pid) {
            unix::signal_process(pid, SIGSTOP);
            self.stopped.insert(pid);
        }
        if belongs(pid) {
            return self.kill(pid);
        }
        if is_zombie(pid) || !has_known_environ(pid) {
            self.awaits_exit |= is_exiting(pid);
            return true;
        }
        self.others.insert(pid);
        if self.stopped.remove(&pid) {
            unix::signal_process(pid, SIGCONT);
        }
        false
    }

    /// Stops a process and everything below it, so that they start no others, and then
    /// kills them.
    fn kill(&mut self, root: i32) -> bool {
        let mut doomed = HashSet::new();
        for _ in 0..STOP_PASSES {
            let tree = std::iter::once(root).chain(descendants(root));
            let new: Vec<i32> = tree.filter(|pid| doomed.insert(*pid)).collect();
            if new.is_empty() {
                break;
            }
            for pid in new {
                unix::signal_process(pid, SIGSTOP);
                if self.killed.insert(pid) && !is_zombie(pid) && !is_fork_server(pid) {
                    self.left.push(describe(pid));
                }
            }
        }
        for pid in doomed {
            unix::signal_process(pid, SIGKILL);
        }
        true
    }

    /// Reports an orphan that was not killed, unless it may belong to another scope.
    fn report_missed(&mut self) {
        if let (true, Some(pid)) = (self.others.is_empty(), self.missed) {
            let command = "(not killed: processes that start each other and end at once)";
            self.left.push(LeakedProcess { pid, command: command.to_owned(), owner: None });
        }
    }
}
