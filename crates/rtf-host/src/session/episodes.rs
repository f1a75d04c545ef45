//! The episodes of a test with slots, as the runner sends them.

use std::collections::VecDeque;
use std::sync::PoisonError;

use rtf_model::Episode;
use rtf_model::protocol::{EpisodeSlots, Notification, Request};

use super::{Session, SessionState};
use crate::EpisodeResult;
use crate::cases::CaseError;
use crate::decode::Incoming;

/// The number of ids that a problem lists.
const IDS_SHOWN: usize = 5;

/// What a test gets that takes an episode.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TakenEpisode {
    /// An episode, which has started.
    Started(Episode),
    /// After a wait, no episode follows; otherwise, none has arrived, or no slot is free.
    None,
    /// A stop request, or an error that was reported.
    Stopped,
}

/// The episodes that the test has not taken.
#[derive(Debug, Default)]
pub(super) struct EpisodeQueue {
    slots: Option<EpisodeSlots>,
    arrived: VecDeque<Episode>,
    /// Whether no episode follows.
    is_complete: bool,
    /// The number of slots with an open episode.
    taken: u32,
}

impl EpisodeQueue {
    fn has_free_slot(&self) -> bool {
        self.slots.is_some_and(|own| self.taken < own.slots)
    }

    /// Whether no episode follows those that were taken.
    fn is_over(&self) -> bool {
        self.is_complete && self.arrived.is_empty()
    }

    fn next(&mut self) -> Option<Episode> {
        let episode = self.has_free_slot().then(|| self.arrived.pop_front()).flatten()?;
        self.taken += 1;
        Some(episode)
    }
}

impl Session {
    /// How the running test runs episodes; `None` if it does not.
    #[must_use]
    pub fn slots(&self) -> Option<EpisodeSlots> {
        self.state().episodes.slots
    }

    /// Takes the next episode and starts it, in `run` of a test with slots. With `wait`, waits
    /// until one has arrived, none follows, or the test is asked to stop.
    #[must_use]
    pub fn take_episode(&self, wait: bool) -> TakenEpisode {
        let taken = self.allowed(self.try_take(wait));
        taken.unwrap_or(TakenEpisode::Stopped)
    }

    fn try_take(&self, wait: bool) -> Result<TakenEpisode, CaseError> {
        self.0.cases.check_episodes()?;
        if wait {
            self.flush();
        }
        loop {
            if let Some(taken) = self.await_episode(wait)? {
                return Ok(taken);
            }
            // Another thread may have taken it: episodes start in the order in which they arrived.
            let next = || self.state().episodes.next();
            let started = self.0.cases.start_episode(next, |started| self.notify_case(started))?;
            if let Some(episode) = started {
                return Ok(TakenEpisode::Started(episode));
            }
        }
    }

    /// Returns what a test gets that cannot take an episode now; `None` if it can.
    fn await_episode(&self, wait: bool) -> Result<Option<TakenEpisode>, CaseError> {
        let must_wait = |state: &mut SessionState| {
            let queue = &state.episodes;
            let is_idle = queue.arrived.is_empty() && queue.has_free_slot();
            wait && state.stop_reason.is_none() && is_idle && !queue.is_complete
        };
        let waited = self.0.changed.wait_while(self.state(), must_wait);
        let state = waited.unwrap_or_else(PoisonError::into_inner);
        let queue = &state.episodes;
        if state.stop_reason.is_some() {
            Ok(Some(TakenEpisode::Stopped))
        } else if !queue.arrived.is_empty() && queue.has_free_slot() {
            Ok(None)
        } else if wait && !queue.is_over() {
            Err(CaseError::NoFreeSlot(queue.taken))
        } else {
            Ok(Some(TakenEpisode::None))
        }
    }

    /// From now on, what the calling thread reports belongs to the episode. False after an error
    /// that was reported.
    pub fn enter_episode(&self, id: u64) -> bool {
        self.allowed(self.0.cases.enter_episode(id)).is_some()
    }

    /// The calling thread leaves the episode that it has entered last. False after an error that
    /// was reported.
    pub fn leave_episode(&self, id: u64) -> bool {
        self.allowed(self.0.cases.leave_episode(id)).is_some()
    }

    /// Finishes an episode. False after an error that was reported.
    pub fn finish_episode(&self, id: u64, result: EpisodeResult) -> bool {
        let (is_stopping, location) = (self.interrupted(), result.location.clone());
        let send = |finished: &Notification| self.notify_case(finished);
        if let Err(error) = self.0.cases.finish_episode(id, result, is_stopping, send) {
            self.error(error.to_string(), location);
            return false;
        }
        let mut state = self.state();
        state.episodes.taken = state.episodes.taken.saturating_sub(1);
        true
    }

    pub(super) fn begin_episodes(&self, slots: Option<EpisodeSlots>) {
        self.state().episodes = EpisodeQueue { slots, ..EpisodeQueue::default() };
    }

    /// Episodes have arrived, or none follows.
    pub(crate) fn queue_episodes(&self, incoming: Incoming) {
        let Incoming::Request { request, .. } = incoming else { return };
        let mut state = self.state();
        match *request {
            Request::Episodes { episodes } => state.episodes.arrived.extend(episodes),
            _ => state.episodes.is_complete = true,
        }
        self.0.changed.notify_all();
    }

    /// `run` has returned: reports an error if episodes are left.
    pub(crate) fn require_all_episodes(&self) {
        let state = self.state();
        let queue = &state.episodes;
        if queue.slots.is_none() || state.stop_reason.is_some() {
            return;
        }
        let is_over = queue.is_over();
        drop(state);
        let open = self.0.cases.open_episodes();
        if !open.is_empty() {
            self.error(format!("`run` returned before it finished {}", list(&open)), None);
        } else if !is_over {
            let text = "`run` returned before the last episode: take episodes until none follows";
            self.error(text.to_owned(), None);
        }
    }
}

/// Some ids as a text.
fn list(ids: &[u64]) -> String {
    let shown: Vec<String> = ids.iter().take(IDS_SHOWN).map(u64::to_string).collect();
    let word = if ids.len() == 1 { "episode" } else { "episodes" };
    let dots = if ids.len() > IDS_SHOWN { ", …" } else { "" };
    format!("{word} {}{dots}", shown.join(", "))
}
