//! The living processes of one tree, also after the end of its leader.
//!
//! A process belongs to the tree if it is below the leader or another member, in the leader's
//! process group, in its control group, or an orphan with its scope. Members are remembered
//! with their start time: one that left the session and cleared its environment is still
//! known when its parent ends.

use std::collections::{HashMap, HashSet};

use super::{OWN_TASKS, children_of, is_own_child, scope_of, stat_of, unix};

/// The fields of `/proc/PID/stat` after the name.
const STATE: usize = 0;
const GROUP: usize = 2;
const START_TIME: usize = 19;

/// Which members of a tree get a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SignalReach {
    /// The process group of the leader.
    Group,
    /// The members that were there when the stop began, and that no signal has reached.
    Left,
    /// All members that no signal has reached.
    Tree,
}

/// The processes that a leader and those below it have started.
#[derive(Debug)]
pub struct Tree {
    leader: i32,
    scope: String,
    has_leader: bool,
    /// The start times of the known members.
    known: HashMap<i32, u64>,
    /// The members that were there when the stop began.
    at_stop: Option<HashSet<i32>>,
    /// The members that got a signal.
    signalled: HashSet<i32>,
}

/// The state of a process that matters here.
struct Status {
    is_alive: bool,
    group: i32,
    started: u64,
}

impl Tree {
    /// A tree whose leader is alive.
    pub fn new(leader: i32, scope: &str) -> Self {
        Self {
            leader,
            scope: scope.to_owned(),
            has_leader: true,
            known: HashMap::new(),
            at_stop: None,
            signalled: HashSet::new(),
        }
    }

    /// The leader has ended, and was reaped: its id may be used again.
    pub fn leader_ended(&mut self) {
        self.has_leader = false;
    }

    /// Whether the leader is alive, or was not reaped.
    pub fn has_leader(&self) -> bool {
        self.has_leader
    }

    pub fn leader_lives(&mut self) -> bool {
        self.has_leader &= status_of(self.leader).is_some_and(|status| status.is_alive);
        self.has_leader
    }

    /// Returns the living members without the leader. `others` are further members, such as
    /// those of its control group.
    pub fn living(&mut self, others: &[i32]) -> Vec<i32> {
        let mut found: HashMap<i32, u64> = HashMap::new();
        let mut queue: Vec<i32> = others.to_vec();
        queue.extend(self.has_leader.then_some(self.leader));
        queue.extend(self.orphans());
        queue.extend(self.known.keys());
        let mut seen = HashSet::new();
        while let Some(pid) = queue.pop() {
            let is_leader = self.has_leader && pid == self.leader;
            let status = (!is_leader).then(|| status_of(pid)).flatten();
            if !seen.insert(pid) || !(is_leader || status.is_some()) {
                continue;
            }
            if let Some(Status { is_alive, started, .. }) = status {
                let is_reused = self.known.get(&pid).is_some_and(|known| *known != started);
                if is_reused {
                    continue;
                }
                if is_alive {
                    found.insert(pid, started);
                }
            }
            queue.extend(children_of(format!("/proc/{pid}/task")));
        }
        self.known = found;
        let mut pids: Vec<i32> = self.known.keys().copied().collect();
        pids.sort_unstable();
        pids
    }

    /// The adopted orphans of the tree.
    fn orphans(&self) -> Vec<i32> {
        let belongs = |pid: &i32| {
            self.known.contains_key(pid)
                || status_of(*pid).is_some_and(|status| status.group == self.leader)
                || scope_of(*pid).is_some_and(|scope| scope == self.scope.as_bytes())
        };
        let orphans = children_of(OWN_TASKS).into_iter().filter(|pid| !is_own_child(*pid));
        orphans.filter(belongs).collect()
    }

    /// The tree is asked to stop. Only the first call counts.
    pub fn begin_stop(&mut self, others: &[i32]) {
        if self.at_stop.is_none() {
            let living = self.living(others);
            self.at_stop = Some(living.into_iter().collect());
        }
    }

    /// Sends a signal to those members that it is to reach.
    pub fn signal(&mut self, signal: i32, reach: SignalReach, others: &[i32]) {
        self.begin_stop(others);
        let living = self.living(others);
        // A group without a leader may be another process's.
        let signals_group = self.has_leader && self.signalled.insert(self.leader);
        if signals_group || (self.has_leader && reach == SignalReach::Group) {
            let in_group = |pid: &&i32| status_of(**pid).is_some_and(|it| it.group == self.leader);
            self.signalled.extend(living.iter().filter(in_group));
            unix::signal_group(self.leader, signal);
        }
        let at_stop = self.at_stop.as_ref();
        for pid in living {
            let is_reached = match reach {
                SignalReach::Group => false,
                SignalReach::Left => at_stop.is_some_and(|members| members.contains(&pid)),
                SignalReach::Tree => true,
            };
            if is_reached && self.signalled.insert(pid) {
                unix::signal_process(pid, signal);
            }
        }
    }

    /// Kills the leader, its group, and all members.
    pub fn kill(&mut self, others: &[i32]) {
        let living = self.living(others);
        if self.has_leader {
            super::kill_tree(self.leader);
        }
        living.into_iter().for_each(|pid| unix::signal_process(pid, super::SIGKILL));
    }
}

fn status_of(pid: i32) -> Option<Status> {
    let stat = stat_of(pid)?;
    let fields: Vec<&str> = stat.split(' ').collect();
    Some(Status {
        is_alive: !matches!(*fields.get(STATE)?, "Z" | "X" | "x"),
        group: fields.get(GROUP)?.parse().ok()?,
        started: fields.get(START_TIME)?.parse().ok()?,
    })
}
