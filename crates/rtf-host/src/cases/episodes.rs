//! The episodes of a test with slots: top-level cases, several of which are open at a time,
//! and which threads enter and leave.

use std::collections::HashMap;
use std::sync::atomic::Ordering;
use std::sync::{MutexGuard, PoisonError};
use std::time::Duration;

use rtf_model::protocol::{EpisodeSlots, Notification};
use rtf_model::{CaseEpisode, CaseId, CaseStart, Episode, EpisodeEnd, Location, Outcome, Phase};

use super::{AttemptSettings, CaseError, Cases, OpenCase, with_innermost, with_open};

/// The longest text for a first observation, in characters.
const OBSERVATION_LIMIT: usize = 64;

/// The result of an episode.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EpisodeResult {
    /// The outcome, unless a problem that was reported in the episode is worse.
    pub outcome: Outcome,
    /// Why it did not pass, without effect otherwise; empty if the messages of the episode contain it.
    pub reason: String,
    /// Its steps, simulated time and first observation.
    pub end: EpisodeEnd,
    /// Where the plug-in finishes it, for an error.
    pub location: Option<Location>,
}

/// An episode that has started and not finished.
#[derive(Debug)]
pub(super) struct OpenEpisode {
    case: CaseId,
    /// How often threads have entered it without leaving it.
    entered: usize,
    skip_reason: Option<String>,
    has_problem: bool,
}

impl OpenEpisode {
    /// Adds what a thread recorded that had entered it.
    fn merge(&mut self, entry: &mut OpenCase) {
        self.has_problem |= entry.has_problem;
        self.skip_reason = self.skip_reason.take().or(entry.skip_reason.take());
    }

    /// The outcome and its reason.
    fn judge(self, result: &EpisodeResult, slots: EpisodeSlots) -> (Outcome, Option<String>) {
        let (outcome, end) = (result.outcome, &result.end);
        if let Some(limit) = slots.max_steps.filter(|limit| end.steps > Some(*limit)) {
            return (Outcome::TimedOut, Some(format!("not done after {limit} steps")));
        }
        if let Some(limit) = slots.max_time_us.filter(|limit| end.time_us > Some(*limit)) {
            let limit = Duration::from_micros(limit).as_secs_f64();
            let reason = format!("not done after {limit} s of simulated time");
            return (Outcome::TimedOut, Some(reason));
        }
        if outcome != Outcome::Passed {
            return (outcome, Some(result.reason.clone()).filter(|reason| !reason.is_empty()));
        }
        let unknown = match (slots.max_steps, slots.max_time_us) {
            (Some(_), _) if end.steps.is_none() => Some(("number of steps", "max-steps")),
            (_, Some(_)) if end.time_us.is_none() => Some(("simulated time", "max-time")),
            _ => None,
        };
        match (self.skip_reason, unknown) {
            (Some(reason), _) => (Outcome::Skipped, Some(reason)),
            (None, Some((number, limit))) if !self.has_problem => {
                let reason = format!("its {number} is unknown, but the suite has `{limit}`");
                (Outcome::Error, Some(reason))
            }
            _ => (Outcome::Passed, None),
        }
    }
}

impl Cases {
    /// Checks that the calling thread may take an episode.
    pub(crate) fn check_episodes(&self) -> Result<(), CaseError> {
        let settings = self.settings();
        settings.slots.ok_or(CaseError::NoSlots)?;
        check_phase(&settings)?;
        if self.is_forked_child() { Err(CaseError::ForkedEpisode) } else { Ok(()) }
    }

    /// Starts the next episode.
    pub(crate) fn start_episode(
        &self,
        next: impl FnOnce() -> Option<Episode>,
        send: impl FnOnce(&Notification) -> bool,
    ) -> Result<Option<Episode>, CaseError> {
        let settings = self.settings();
        check_phase(&settings)?;
        let mut started = self.started.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(episode) = next() else { return Ok(None) };
        *started += 1;
        let (case, id) = (CaseId(*started), episode.id);
        let open = OpenEpisode { case, entered: 0, skip_reason: None, has_problem: false };
        self.episodes().insert(id, open);
        let reference = Some(CaseEpisode { id, seed: 0 });
        let start = CaseStart { episode: reference, ..CaseStart::new(case, id.to_string()) };
        send(&Notification::CaseStarted(start));
        Ok(Some(episode))
    }

    /// From now on, what this thread reports belongs to the episode.
    pub(crate) fn enter_episode(&self, id: u64) -> Result<(), CaseError> {
        let settings = self.settings();
        let mut episodes = self.episodes();
        let episode = episodes.get_mut(&id).ok_or(CaseError::EpisodeNotOpen(id))?;
        episode.entered += 1;
        let entry = OpenCase {
            episode: Some(id),
            ..OpenCase::new(settings.attempt, Some(episode.case), id.to_string())
        };
        drop(episodes);
        self.push(entry);
        Ok(())
    }

    /// Leaves the episode, which is the innermost one of this thread.
    pub(crate) fn leave_episode(&self, id: u64) -> Result<(), CaseError> {
        let is_innermost = |last: &mut OpenCase| last.episode == Some(id);
        let left = with_open(|open| open.pop_if(is_innermost)).flatten();
        let mut left = left.ok_or(CaseError::EpisodeNotInnermost(id))?;
        let settings = self.settings();
        if left.attempt != settings.attempt {
            return Ok(());
        }
        if let Some(episode) = self.episodes().get_mut(&id) {
            episode.entered -= 1;
            episode.merge(&mut left);
        }
        self.open.fetch_sub(1, Ordering::Relaxed);
        self.update_main_case(settings.attempt);
        Ok(())
    }

    /// Finishes an episode. What this thread reports in it afterwards belongs to the test.
    pub(crate) fn finish_episode(
        &self,
        id: u64,
        result: EpisodeResult,
        is_stopping: bool,
        send: impl Fn(&Notification) -> bool,
    ) -> Result<(), CaseError> {
        let settings = self.settings();
        check_phase(&settings)?;
        let length = result.end.first_observation.as_ref().map_or(0, |text| text.chars().count());
        if length > OBSERVATION_LIMIT {
            return Err(CaseError::LongObservation(id, length));
        }
        let slots = settings.slots.ok_or(CaseError::NoSlots)?;
        let closed = self.close_episode(settings.attempt, id)?;
        let case = closed.case;
        self.update_main_case(settings.attempt);
        self.is_abandoned.fetch_or(is_stopping, Ordering::Relaxed);
        if self.is_forked_child() || self.is_abandoned.load(Ordering::Relaxed) {
            return Ok(());
        }
        let (outcome, reason) = closed.judge(&result, slots);
        let end = result.end;
        let finished = |reason| Notification::CaseFinished {
            case,
            outcome: Some(outcome),
            reason,
            duration_us: None,
            rerun: false,
            episode: (end != EpisodeEnd::default()).then(|| Box::new(end.clone())),
        };
        if !send(&finished(reason)) {
            send(&finished(None));
        }
        Ok(())
    }

    /// Removes an episode from the open ones.
    fn close_episode(&self, attempt: u64, id: u64) -> Result<OpenEpisode, CaseError> {
        let mut episodes = self.episodes();
        let open = episodes.get(&id).ok_or(CaseError::EpisodeNotOpen(id))?;
        let own = with_open(|open| count_entries(open, attempt, id)).unwrap_or(Ok(0))?;
        if open.entered > own {
            return Err(CaseError::EpisodeEntered(id));
        }
        let mut closed = episodes.remove(&id).ok_or(CaseError::EpisodeNotOpen(id))?;
        drop(episodes);
        with_open(|open| {
            for entry in open.iter_mut().filter(|entry| entry.is_in(attempt, id)) {
                closed.merge(entry);
                entry.case = None;
            }
        });
        Ok(closed)
    }

    /// The ids of the open episodes, in order.
    pub(crate) fn open_episodes(&self) -> Vec<u64> {
        let mut ids: Vec<u64> = self.episodes().keys().copied().collect();
        ids.sort_unstable();
        ids
    }

    pub(super) fn episodes(&self) -> MutexGuard<'_, HashMap<u64, OpenEpisode>> {
        self.episodes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sets the innermost case of the thread that runs the test, if this is that thread.
    pub(super) fn update_main_case(&self, attempt: u64) {
        self.set_main_case(attempt, with_innermost(attempt, |open| open.case).flatten());
    }
}

impl OpenCase {
    /// Whether it is an entry of this episode.
    fn is_in(&self, attempt: u64, id: u64) -> bool {
        self.attempt == attempt && self.episode == Some(id)
    }
}

/// How often this thread has entered an episode. A case that is open in it is an error.
fn count_entries(open: &[OpenCase], attempt: u64, id: u64) -> Result<usize, CaseError> {
    let (mut count, mut is_inside) = (0, false);
    for entry in open {
        if entry.episode.is_some() {
            is_inside = entry.is_in(attempt, id);
            count += usize::from(is_inside);
        } else if is_inside {
            return Err(CaseError::EpisodeHasCase(id));
        }
    }
    Ok(count)
}

fn check_phase(settings: &AttemptSettings) -> Result<(), CaseError> {
    if settings.phase == Some(Phase::Run) { Ok(()) } else { Err(CaseError::EpisodeOutsideRun) }
}
