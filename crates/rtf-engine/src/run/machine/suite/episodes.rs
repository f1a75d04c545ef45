//! The episodes of a campaign: rounds of the suite with different parameters. Between two
//! episodes, each fixture is reset or restarted.

use std::collections::VecDeque;

use rtf_model::{Episode, EpisodeStarted, EventKind};

use super::SuiteMachine;
use crate::run::machine::context::Context;
use crate::run::machine::io::Deadline;
use crate::run::machine::test::EpisodeSource;
use rtf_plan::plan::SuitePlan;

/// Without episodes, a suite runs once.
#[derive(Debug)]
pub(super) struct Episodes<'p> {
    left: std::slice::Iter<'p, Episode>,
    /// Those that have arrived since the suite started.
    arrived: VecDeque<Episode>,
    /// Whether further ones may arrive.
    is_open: bool,
    /// Whether a test runs many of them at a time, in one round of the suite.
    is_batch: bool,
    running: Option<u64>,
    /// Whether the fixtures are used up by the running episode.
    is_ending: bool,
}

impl<'p> Episodes<'p> {
    pub fn new(plan: &'p SuitePlan) -> Self {
        Self {
            left: plan.episodes.iter(),
            arrived: VecDeque::new(),
            is_open: plan.awaits_episodes,
            is_batch: plan.tests.iter().any(|test| test.slots.is_some()),
            running: None,
            is_ending: false,
        }
    }

    /// Whether another round with an episode follows, or may follow.
    pub fn any_round_left(&self) -> bool {
        !self.is_batch && self.any_left()
    }

    fn any_known(&self) -> bool {
        !self.left.as_slice().is_empty() || !self.arrived.is_empty()
    }

    /// Adds an episode; `None` if no further one follows.
    pub fn add(&mut self, episode: Option<Episode>) {
        match episode {
            Some(episode) => self.arrived.push_back(episode),
            None => self.is_open = false,
        }
    }

    /// Whether all episodes so far have finished, and further ones may arrive.
    #[cfg(debug_assertions)]
    pub fn is_waiting(&self) -> bool {
        self.is_ending && self.running.is_none() && !self.any_known() && self.is_open
    }

    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// The running episode was interrupted: it has no result.
    pub fn abandon(&mut self) {
        self.running = None;
    }
}

impl EpisodeSource for Episodes<'_> {
    fn peek(&self) -> Option<&Episode> {
        self.left.as_slice().first().or(self.arrived.front())
    }

    fn take(&mut self) -> Option<Episode> {
        self.left.next().cloned().or_else(|| self.arrived.pop_front())
    }

    fn any_left(&self) -> bool {
        self.any_known() || self.is_open
    }
}

impl SuiteMachine<'_> {
    /// Sends episodes to the test that runs many of them.
    pub(super) fn hand_out_episodes(&mut self, cx: &mut Context<'_>) {
        if self.episodes.is_batch {
            let episodes = &mut self.episodes;
            self.scheduler.runs_mut().for_each(|run| run.hand_out(episodes, cx));
        }
    }

    /// Hides what blinded trials must not show, which is the same for all of them.
    fn hide_versions(&self, cx: &mut Context<'_>) {
        let masked = self.episodes.peek().map(|first| first.masked.clone()).unwrap_or_default();
        if !masked.is_empty() {
            cx.begin_episode(Episode { masked, ..Episode::new(0, 0, Vec::new()) });
        }
    }

    /// Begins the next round with an episode, if there is one.
    pub(super) fn begin_episode(&mut self, cx: &mut Context<'_>) {
        if self.episodes.is_batch {
            return self.hide_versions(cx);
        }
        let Some(episode) = self.episodes.take() else { return };
        (self.episodes.running, self.episodes.is_ending) = (Some(episode.id), false);
        self.scheduler.shared_host.serves_episodes = self.episodes.any_round_left();
        cx.begin_episode(episode.clone());
        let suite = self.plan.id;
        cx.emit(EventKind::EpisodeStarted(EpisodeStarted { suite, episode }));
    }

    /// All tests of an episode have ended, and another one follows: once the fixtures that are
    /// not reset are torn down, which belongs to the old episode, begins the new one. False while
    /// they are being torn down, and while the next episode has not arrived: then no limit runs.
    pub(super) fn next_episode(&mut self, cx: &mut Context<'_>) -> bool {
        if !std::mem::replace(&mut self.episodes.is_ending, true) {
            self.fixtures.end_episode();
            self.is_checked = false;
        }
        if !self.fixtures.stop_due(cx) {
            return false;
        }
        self.finish_episode(cx);
        if !self.episodes.any_known() {
            cx.clear(Deadline::Suite);
            return false;
        }
        self.scheduler.restart();
        self.begin_episode(cx);
        self.set_timeout(cx);
        true
    }

    /// Finishes the running episode, unless it was interrupted.
    pub(super) fn finish_episode(&mut self, cx: &mut Context<'_>) {
        if let Some(episode) = self.episodes.running.take() {
            cx.emit(EventKind::EpisodeFinished { suite: self.plan.id, episode });
        }
    }
}
