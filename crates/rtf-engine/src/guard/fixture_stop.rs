//! Stops the fixtures of a dead runner, all at the same time: a robot that is moving parks as it
//! does in an orderly tear-down. Plug-ins cannot be torn down: their hosts end, and the processes
//! that they started get SIGTERM.

use std::collections::HashMap;
use std::net::Shutdown;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use rtf_process::task::ProcessStream;
use rtf_process::tree::{SignalReach, Tree};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use serde::{Deserialize, Serialize};

use super::hook_process::StreamEnds;
use super::unix::GuardSignals;

/// The interval between checks of the processes.
const POLL_INTERVAL: Duration = Duration::from_millis(5);
/// The number of requests to end the run after which nothing is torn down.
const KILL_REQUESTS: u32 = 2;

/// How a fixture's process is stopped.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FixtureStop {
    pub scope: String,
    /// The signal for its process group; none for a host, or a process on a remote machine, which
    /// end when their channel is closed.
    pub signal: Option<i32>,
    /// The signal for processes that remain; none for a process on a remote machine.
    pub tree_signal: Option<i32>,
    /// The time from then to the kill.
    pub grace: Duration,
}

/// A fixture's process under the dead runner.
#[derive(Debug)]
pub struct GuardedFixture {
    pub streams: StreamEnds,
    pub stop: FixtureStop,
}

impl GuardedFixture {
    /// Removes the streams, which have to be read, and leaves the channel, which has to be closed.
    pub fn take_streams(&mut self) -> Vec<OwnedFd> {
        let streams = std::mem::take(&mut self.streams);
        let channel = |(stream, end): &(ProcessStream, OwnedFd)| match stream {
            ProcessStream::Channel => Some((*stream, end.try_clone().ok()?)),
            ProcessStream::Stdout | ProcessStream::Stderr => None,
        };
        self.streams = streams.iter().filter_map(channel).collect();
        streams.into_iter().map(|(_, end)| end).collect()
    }
}

/// Whether the user wants everything to be killed.
pub fn is_kill_requested(signals: &mut GuardSignals) -> bool {
    signals.read();
    signals.requests.count() >= KILL_REQUESTS
}

/// Asks all fixtures to stop, and waits until their last processes have ended, or their grace has
/// passed.
pub fn stop_fixtures(fixtures: HashMap<i32, GuardedFixture>, signals: &mut GuardSignals) {
    if is_kill_requested(signals) {
        return;
    }
    let mut stops: Vec<_> =
        fixtures.into_iter().map(|(pid, it)| TreeStop::begin(pid, it)).collect();
    loop {
        stops.retain_mut(TreeStop::continues);
        if stops.is_empty() || is_kill_requested(signals) {
            return;
        }
        let timeout = Timespec::try_from(POLL_INTERVAL).ok();
        let _ = poll(&mut [PollFd::new(&*signals, PollFlags::IN)], timeout.as_ref());
    }
}

struct TreeStop {
    tree: Tree,
    stop: FixtureStop,
    begun: Instant,
    is_asked: bool,
}

impl TreeStop {
    fn begin(pid: i32, fixture: GuardedFixture) -> Self {
        let GuardedFixture { streams, stop } = fixture;
        let mut tree = Tree::new(pid, &stop.scope);
        tree.begin_stop(&[]);
        if let Some(signal) = stop.signal.filter(|_| tree.leader_lives()) {
            tree.signal(signal, SignalReach::Group, &[]);
        }
        for (_, channel) in streams {
            let _ = UnixStream::from(channel).shutdown(Shutdown::Write);
        }
        Self { tree, stop, begun: Instant::now(), is_asked: false }
    }

    /// Takes the next step; false if the tree has stopped, or its grace has passed.
    fn continues(&mut self) -> bool {
        let has_leader = self.tree.leader_lives();
        let elapsed = self.begun.elapsed();
        if (!has_leader && self.tree.living(&[]).is_empty()) || elapsed >= self.stop.grace {
            return false;
        }
        if !self.is_asked && (!has_leader || elapsed >= self.stop.grace / 2) {
            self.is_asked = true;
            // Processes that the stop has started may park the robot.
            let reach = self.stop.signal.map_or(SignalReach::Tree, |_| SignalReach::Left);
            if let Some(signal) = self.stop.tree_signal {
                self.tree.signal(signal, reach, &[]);
            }
        }
        true
    }
}
