//! The episodes of a campaign: rounds of the suite with different parameters. Between two
//! episodes, each fixture is reset or restarted.

use rtf_model::{Episode, EpisodeStarted, EventKind};

use super::SuiteMachine;
use crate::run::machine::context::Context;
use rtf_plan::plan::SuitePlan;

/// Without episodes, a suite runs once.
#[derive(Debug)]
pub(super) struct Episodes<'p> {
    left: std::slice::Iter<'p, Episode>,
    running: Option<u64>,
    /// Whether the fixtures are used up by the running episode.
    is_ending: bool,
}

impl<'p> Episodes<'p> {
    pub fn new(plan: &'p SuitePlan) -> Self {
        Self { left: plan.episodes.iter(), running: None, is_ending: false }
    }

    /// Whether an episode follows.
    pub fn any_left(&self) -> bool {
        !self.left.as_slice().is_empty()
    }

    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// The running episode was interrupted: it has no result.
    pub fn abandon(&mut self) {
        self.running = None;
    }
}

impl SuiteMachine<'_> {
    /// Begins the next episode, if there is one.
    pub(super) fn begin_episode(&mut self, cx: &mut Context<'_>) {
        let Some(episode) = self.episodes.left.next() else { return };
        (self.episodes.running, self.episodes.is_ending) = (Some(episode.id), false);
        cx.begin_episode(episode.clone());
        let (suite, episode) = (self.plan.id, episode.clone());
        cx.emit(EventKind::EpisodeStarted(EpisodeStarted { suite, episode }));
    }

    /// All tests of an episode have ended, and another one follows: once the fixtures that are
    /// not reset are torn down, which belongs to the old episode, begins the new one. False while
    /// they are being torn down.
    pub(super) fn next_episode(&mut self, cx: &mut Context<'_>) -> bool {
        if !std::mem::replace(&mut self.episodes.is_ending, true) {
            self.fixtures.end_episode();
            self.is_checked = false;
        }
        if !self.fixtures.stop_due(cx) {
            return false;
        }
        self.finish_episode(cx);
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
