//! The processes of a tree that outlive its leader. A tree that is asked to stop has stopped when
//! its last process has ended; the runner decides when it is killed.

use std::os::fd::OwnedFd;
use std::time::Duration;

use rtf_model::{ExitStatus, LeakedProcess};
use tokio::io::unix::AsyncFd;

use super::streams::Buffers;
use super::{ProcessEvent, ProcessTask};
use crate::spawn_request::ProcessRole;
use crate::tree::{self, SignalReach, Tree};
use crate::unix;

/// The limit for reading what an ended leader has written: others may hold its outputs open.
const LEADER_DRAIN_LIMIT: Duration = Duration::from_millis(20);
/// The kernel's list of children may miss a process.
const SCANS: usize = 2;

/// A tree, and how far its stop is.
#[derive(Debug)]
pub(super) struct TreeStop {
    pub(super) tree: Tree,
    /// The status of the leader, while others are awaited.
    leader: Option<ExitStatus>,
    /// The end of one of the others.
    next: Option<AsyncFd<OwnedFd>>,
    /// The processes that were killed.
    killed: Option<Vec<i32>>,
    /// Those that outlived the leader and had to be killed.
    unstopped: Vec<LeakedProcess>,
}

impl TreeStop {
    pub(super) fn new(tree: Tree) -> Self {
        Self { tree, leader: None, next: None, killed: None, unstopped: Vec::new() }
    }

    /// The status of the leader, if it has ended and others are awaited.
    pub(super) fn leader(&self) -> Option<ExitStatus> {
        self.leader
    }

    /// Waits for the end of an awaited process.
    pub(super) async fn next_end(&self) {
        match &self.next {
            // Its failure leads to a further scan.
            Some(process) => drop(process.readable().await),
            None => std::future::pending().await,
        }
    }

    /// The leaked processes, in place of those that a sweep has found: a killed process may still
    /// be ending.
    pub(super) fn leaked(&mut self, found: Vec<LeakedProcess>) -> Vec<LeakedProcess> {
        let Some(killed) = &self.killed else { return found };
        let mut left = std::mem::take(&mut self.unstopped);
        left.extend(found.into_iter().filter(|process| !killed.contains(&process.pid)));
        left
    }
}

impl ProcessTask {
    /// The leader has ended. Returns its status if nothing else is awaited.
    pub(super) async fn on_leader_end(
        &mut self,
        status: ExitStatus,
        buffers: &mut Buffers,
    ) -> Option<ExitStatus> {
        self.stop.tree.leader_ended();
        let is_fixture = self.role() == Some(ProcessRole::Fixture);
        if self.stop.killed.is_some() || !(is_fixture || self.throttle.is_stopping) {
            return Some(status);
        }
        let left = self.living();
        if left.is_empty() {
            return Some(status);
        }
        self.background.abort_all();
        self.process.foreground = None;
        let left = left.into_iter().map(tree::describe).collect();
        self.drain(buffers, LEADER_DRAIN_LIMIT).await;
        self.report(ProcessEvent::LeaderEnded(status, left)).await;
        self.stop.leader = Some(status);
        self.await_next()
    }

    /// Prepares to wait for the end of a process of the tree. Returns the leader's status if none
    /// is left.
    pub(super) fn await_next(&mut self) -> Option<ExitStatus> {
        loop {
            let Some(first) = self.living().first().copied() else { return self.stop.leader };
            // Fails if it was reaped since.
            if let Ok(process) = unix::open_process(first) {
                self.stop.next = Some(process);
                return None;
            }
        }
    }

    /// The living processes of the tree, without its leader.
    fn living(&mut self) -> Vec<i32> {
        for _ in 0..SCANS {
            let others = self.group_members();
            let living = self.stop.tree.living(&others);
            if !living.is_empty() {
                return living;
            }
        }
        Vec::new()
    }

    /// After a process has ended by itself, waits for the helpers of its libraries, which end after
    /// it.
    pub(super) async fn await_helpers(&self) {
        if !self.throttle.is_stopping && self.stop.killed.is_none() {
            self.job.launch.await_helpers().await;
        }
    }

    /// The processes of its control group, if it has one.
    fn group_members(&self) -> Vec<i32> {
        self.job.launch.cgroup.as_ref().map(|group| group.members()).unwrap_or_default()
    }

    /// Its tree is asked to stop: these processes may have to be signalled later.
    pub(super) fn begin_tree_stop(&mut self) {
        let others = self.group_members();
        self.stop.tree.begin_stop(&others);
    }

    pub(super) fn signal_tree(&mut self, signal: i32, reach: SignalReach) {
        let others = self.group_members();
        self.stop.tree.signal(signal, reach, &others);
    }

    /// Kills the process and its tree.
    pub(super) fn kill_tree(&mut self) {
        let living = self.living();
        if !self.stop.tree.has_leader() && self.stop.unstopped.is_empty() {
            self.stop.unstopped = living.iter().copied().map(tree::describe).collect();
        }
        self.stop.killed.get_or_insert_default().extend(&living);
        if let Some(group) = &self.job.launch.cgroup {
            group.kill();
        }
        self.stop.tree.kill(&living);
    }
}
