//! The state of one suite.

use super::episode::EpisodeRecord;
use super::host::{self, HostRecord};
use crate::{FixtureId, Growth, HookId, Micros, SuitePlanned, SuitePrepared, TestId};

/// The state of one suite.
#[derive(Clone, Debug, Default)]
pub struct SuiteRecord {
    /// How it was planned.
    pub plan: SuitePlanned,
    /// Its fixtures, in the order of the plan.
    pub fixtures: Vec<FixtureId>,
    /// Its hooks, in the order of the plan.
    pub hooks: Vec<HookId>,
    /// Its tests, in the order of the plan.
    pub tests: Vec<TestId>,
    /// The shared hosts, the oldest first; recorded when tests are repeated.
    pub hosts: Vec<HostRecord>,
    /// Its newest episodes in a campaign, the oldest first.
    pub episodes: Vec<EpisodeRecord>,
    /// Those that are cases and have not finished, in the order in which they started.
    pub(super) open_episodes: Vec<EpisodeRecord>,
    /// Its private network, ports and variables, if it has any.
    pub prepared: Option<SuitePrepared>,
    /// When it started.
    pub started: Option<Micros>,
    /// When it finished.
    pub finished: Option<Micros>,
}

impl SuiteRecord {
    /// The number of episodes that are kept at least.
    pub const EPISODES_KEPT: usize = 256;

    pub(super) fn new(plan: SuitePlanned) -> Self {
        Self { plan, ..Self::default() }
    }

    /// Adds an episode, and forgets old ones, which the journal has.
    pub(super) fn keep_episode(&mut self, episode: EpisodeRecord) {
        if self.episodes.len() >= 2 * Self::EPISODES_KEPT {
            self.episodes.drain(..Self::EPISODES_KEPT);
        }
        self.episodes.push(episode);
    }

    /// The shared hosts whose resources grew. Of several hosts that served the
    /// same tests, the one with the most measurements counts.
    #[must_use]
    pub fn growing_hosts(&self) -> Vec<(&HostRecord, Vec<Growth>)> {
        host::growing(&self.hosts)
    }
}
