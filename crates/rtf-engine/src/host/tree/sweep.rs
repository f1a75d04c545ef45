//! Killing what a process left, also when it starts new processes all the time.

use std::collections::HashSet;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use rtf_model::LeakedProcess;

use super::{
    OWN, SIGKILL, STARTS, children_of, descendants, described, is_fork_server, is_own_child,
    is_settled, is_stopped, is_zombie, unix,
};

const SIGCONT: i32 = 18;
const SIGSTOP: i32 = 19;
/// How long orphans are looked for as long as there are new ones.
const SWEEP_LIMIT: Duration = Duration::from_millis(500);
/// Between looks that found nothing.
const PAUSE: Duration = Duration::from_micros(200);
/// How often a tree is looked at that grows while it is stopped.
const ROUNDS: u32 = 100;

/// How many looks have to find nothing new.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// One. The kernel's list of children may lack a process that is being orphaned in
    /// that instant, which is then found by a later sweep.
    Once,
    /// Several, with pauses: a leak must not be missed.
    Thorough,
}

impl Effort {
    fn looks(self) -> u32 {
        match self {
            Self::Once => 1,
            Self::Thorough => 10,
        }
    }
}

/// Looks again and again, until enough looks found nothing new or the time is over.
pub(super) fn sweep_if(effort: Effort, belongs: impl Fn(i32) -> bool) -> Vec<LeakedProcess> {
    let end = Instant::now() + SWEEP_LIMIT;
    let mut sweep = Sweep::default();
    let mut quiet = 0;
    loop {
        quiet = if sweep.look(&belongs) { 0 } else { quiet + 1 };
        if quiet >= effort.looks() {
            break;
        }
        if Instant::now() >= end {
            sweep.give_up();
            break;
        }
        if quiet > 0 {
            std::thread::sleep(PAUSE);
        }
    }
    sweep.left
}

/// What a sweep has found so far.
#[derive(Default)]
struct Sweep {
    left: Vec<LeakedProcess>,
    killed: HashSet<i32>,
    zombies: HashSet<i32>,
    /// Orphans that belong to something else.
    others: HashSet<i32>,
    looks: u32,
    /// The last of those that ended before it was known whose they were.
    missed: Option<i32>,
}

impl Sweep {
    /// Kills what belongs; whether anything was there that was not there before.
    fn look(&mut self, belongs: &impl Fn(i32) -> bool) -> bool {
        self.looks += 1;
        let starts = STARTS.load(Ordering::SeqCst);
        let orphans = children_of(OWN);
        // One that is just being started may look like a dead orphan.
        let is_quiet = starts.is_multiple_of(2) && STARTS.load(Ordering::SeqCst) == starts;
        let mut moved = false;
        for pid in orphans.into_iter().filter(|pid| !is_own_child(*pid)) {
            if is_zombie(pid) {
                moved |= self.zombies.insert(pid);
                if !self.killed.contains(&pid) {
                    self.missed = Some(pid);
                }
                if is_quiet {
                    unix::reap(pid);
                }
            } else if !self.others.contains(&pid) && !self.killed.contains(&pid) {
                moved |= self.look_at(pid, belongs);
            }
        }
        moved
    }

    /// Kills an orphan and all below it if it belongs. One that starts another and
    /// ends, again and again, is only caught when it is stopped first.
    fn look_at(&mut self, pid: i32, belongs: &impl Fn(i32) -> bool) -> bool {
        let stops = self.looks > 1 && !is_stopped(pid);
        if stops {
            unix::signal_process(pid, SIGSTOP);
        }
        if belongs(pid) {
            return self.kill(pid);
        }
        if is_zombie(pid) || !is_settled(pid) {
            return true;
        }
        self.others.insert(pid);
        if stops {
            unix::signal_process(pid, SIGCONT);
        }
        false
    }

    /// Stops a process and all below it, so that nothing is started meanwhile, and
    /// then kills them.
    fn kill(&mut self, root: i32) -> bool {
        let mut doomed = HashSet::new();
        for _ in 0..ROUNDS {
            let tree = std::iter::once(root).chain(descendants(root));
            let new: Vec<i32> = tree.filter(|pid| doomed.insert(*pid)).collect();
            if new.is_empty() {
                break;
            }
            for pid in new {
                unix::signal_process(pid, SIGSTOP);
                if self.killed.insert(pid) && !is_zombie(pid) && !is_fork_server(pid) {
                    self.left.push(described(pid));
                }
            }
        }
        for pid in doomed {
            unix::signal_process(pid, SIGKILL);
        }
        true
    }

    /// Says that something was there, unless it may have been another's.
    fn give_up(&mut self) {
        if let (true, Some(pid)) = (self.others.is_empty(), self.missed) {
            let command = "(not killed: processes that start each other and end at once)";
            self.left.push(LeakedProcess { pid, command: command.to_owned(), owner: None });
        }
    }
}
