//! The episodes of a test with slots: which ones its host has, and the limit of each.

use std::collections::{HashMap, VecDeque};
use std::time::Duration;

use rtf_model::protocol::{EpisodeSlots, Request};
use rtf_model::{CaseEpisode, CaseId, CaseStart, Episode, Phase};

use super::TestRun;
use crate::run::machine::context::Context;
use crate::run::machine::io::{Deadline, TestTimer};

/// The episodes that the host has.
#[derive(Debug)]
pub(super) struct Slots {
    /// How many it runs at the same time.
    slots: usize,
    /// Those that were sent and have not started.
    sent: HashMap<u64, Episode>,
    /// The open ones, in the order in which they started.
    open: VecDeque<OpenEpisode>,
    /// Whether no further one is sent until the present ones have ended.
    is_alone: bool,
    /// Whether the host knows that no further one follows.
    is_closed: bool,
    /// When the last one was sent, started or ended.
    changed: Duration,
    /// When the limit is reached, as it was set last.
    limit: Option<Duration>,
}

#[derive(Debug)]
struct OpenEpisode {
    case: CaseId,
    id: u64,
    started: Duration,
}

impl Slots {
    pub fn new(plan: EpisodeSlots) -> Self {
        Self {
            slots: plan.slots as usize,
            sent: HashMap::new(),
            open: VecDeque::new(),
            is_alone: false,
            is_closed: false,
            changed: Duration::ZERO,
            // Any time: the first one is set.
            limit: Some(Duration::ZERO),
        }
    }

    fn outstanding(&self) -> usize {
        self.sent.len() + self.open.len()
    }

    /// Whether several are open, so that it is unknown which one ended the test.
    pub fn are_several_open(&self) -> bool {
        self.open.len() > 1
    }

    /// An episode starts as a case; the problem if it must not.
    fn start(&mut self, start: &mut CaseStart, now: Duration) -> Result<(), String> {
        let Some(CaseEpisode { id, .. }) = start.episode else {
            return Err(format!("started the case `{}` outside of an episode", start.name));
        };
        if self.open.len() >= self.slots {
            let slots = self.slots;
            return Err(format!("started episode {id} although all {slots} slots are in use"));
        }
        let Some(episode) = self.sent.remove(&id) else {
            return Err(format!("started episode {id}, which it did not get or started before"));
        };
        start.name = id.to_string();
        start.parameters = episode.parameters;
        start.episode = Some(CaseEpisode { id, seed: episode.seed });
        self.open.push_back(OpenEpisode { case: start.case, id, started: now });
        self.changed = now;
        Ok(())
    }

    /// A case has ended. It may be an episode.
    pub fn end(&mut self, case: CaseId, now: Duration) {
        if let Some(index) = self.open.iter().position(|open| open.case == case) {
            self.open.remove(index);
            self.changed = now;
            self.is_alone &= self.outstanding() > 0;
        }
    }

    /// Why a test that would pass does not: it did not run all episodes.
    pub fn problem(&self) -> Option<String> {
        match (self.sent.len(), self.is_closed) {
            (0, true) => None,
            (0, false) => Some("`run` ended before the last episode had arrived".to_owned()),
            (count, _) => Some(format!("`run` ended without {count} of the episodes that it got")),
        }
    }

    /// When the limit is reached; `None` while the test waits for episodes.
    fn due(&self, limit: Duration) -> Option<Duration> {
        let oldest = self.open.front().map(|open| open.started);
        let waits_for_test = || !self.sent.is_empty() || self.is_closed;
        oldest.or_else(|| waits_for_test().then_some(self.changed)).map(|since| since + limit)
    }

    pub fn timeout_reason(&self, limit: Duration) -> String {
        match self.open.front() {
            Some(OpenEpisode { id, .. }) if self.open.len() == 1 => {
                format!("episode {id} did not end within {limit:?}")
            }
            Some(OpenEpisode { id, .. }) => {
                let count = self.open.len();
                format!("episode {id}, one of {count} open ones, did not end within {limit:?}")
            }
            None if self.sent.is_empty() => {
                format!("run did not end within {limit:?} after the last episode")
            }
            None => format!("run started no episode within {limit:?}"),
        }
    }
}

impl TestRun<'_> {
    /// A case starts: an episode, if it has no parent. The problem, if it must not.
    pub(super) fn start_episode(
        &mut self,
        start: &mut CaseStart,
        now: Duration,
    ) -> Result<bool, String> {
        match &mut self.slots {
            Some(slots) if start.parent.is_none() => slots.start(start, now).map(|()| true),
            _ if start.episode.is_some() => {
                Err(format!("started the case `{}` as an episode, which it is not", start.name))
            }
            _ => Ok(false),
        }
    }

    fn is_running_episodes(&self) -> bool {
        self.phase == Phase::Run && self.step.is_none() && self.evidence.answer.is_none()
    }

    /// Whether it waits for episodes that have not arrived, so that no limit runs.
    #[cfg(debug_assertions)]
    pub fn awaits_episodes(&self) -> bool {
        let waits = |slots: &Slots| !slots.is_closed && slots.outstanding() == 0;
        self.is_running_episodes() && self.slots.as_deref().is_some_and(waits)
    }

    /// Sends further episodes if its host has few left, and sets the limit of the oldest one.
    pub fn hand_out(&mut self, episodes: &mut impl EpisodeSource, cx: &mut Context<'_>) {
        if !self.is_running_episodes() {
            return;
        }
        let (test, host, limit) = (self.plan.id, self.host, self.plan.limits.run);
        let Some(slots) = &mut self.slots else { return };
        let batch = slots.take(episodes);
        if !batch.is_empty() {
            slots.changed = cx.now();
            cx.send(host, None, Request::Episodes { episodes: batch });
        }
        if !slots.is_closed && !episodes.any_left() {
            (slots.is_closed, slots.changed) = (true, cx.now());
            cx.send(host, None, Request::EndOfEpisodes {});
        }
        let due = slots.due(limit);
        if due != std::mem::replace(&mut slots.limit, due) {
            let timer = Deadline::Test(test, TestTimer::Limit);
            match due {
                Some(due) => cx.set(timer, due.saturating_sub(cx.now())),
                None => cx.clear(timer),
            }
        }
    }
}

/// Where episodes come from.
pub trait EpisodeSource {
    /// The next episode, if it has arrived.
    fn peek(&self) -> Option<&Episode>;

    /// Takes the next episode.
    fn take(&mut self) -> Option<Episode>;

    /// Whether an episode follows, or may follow.
    fn any_left(&self) -> bool;
}

impl Slots {
    /// Takes episodes if few are left, so that the host needs not wait for the runner.
    fn take(&mut self, episodes: &mut impl EpisodeSource) -> Vec<Episode> {
        let mut batch = Vec::new();
        let free = (2 * self.slots).saturating_sub(self.outstanding());
        if self.is_alone || free < self.slots.div_ceil(2) {
            return batch;
        }
        while batch.len() < free
            && !self.is_alone
            && let Some(next) = episodes.peek()
            && !(next.alone && self.outstanding() > 0)
            && let Some(mut episode) = episodes.take()
        {
            self.is_alone = std::mem::take(&mut episode.alone);
            self.sent.insert(episode.id, episode.clone());
            batch.push(episode);
        }
        batch
    }
}
