//! What happened in a suite, one part after the other.

use std::collections::BTreeMap;

use rtf_model::{EventKind, FixtureId, HookId, SuiteId, SuitePrepared};

use super::Merging;
use super::episode_tests::EpisodeTests;
use super::piece::{Parts, Piece};
use crate::journal::JournalError;

/// The reason of fixtures and hooks that the death of a runner left open.
pub(super) const DIED: &str = "the runner died";

/// A suite of the merged run.
#[derive(Debug, Default)]
pub(super) struct MergedSuite {
    /// Its waits for locks, with their new ids.
    pub waiting: Vec<EventKind>,
    /// The private resources of the first part, with their new ids.
    pub prepared: Option<SuitePrepared>,
    /// Whether any run has episodes of it.
    pub has_episodes: bool,
    /// One for each run that has this suite.
    pub pieces: Vec<Piece>,
}

/// The states of fixtures and hooks, and events that are delayed until no
/// part follows that starts them again.
#[derive(Debug, Default)]
pub(super) struct Lives {
    /// Whether several runs have the suite.
    pub is_joined: bool,
    /// The tests, if several runs have episodes of the suite.
    pub episode_tests: Option<EpisodeTests>,
    fixtures: BTreeMap<FixtureId, Life>,
    open_hooks: Vec<HookId>,
    /// Why fixtures broke, in each part in which they did.
    broken: BTreeMap<FixtureId, Vec<String>>,
}

#[derive(Debug, Default)]
struct Life {
    starts: u32,
    stage: Stage,
}

#[derive(Debug, Default, PartialEq, Eq)]
enum Stage {
    #[default]
    Stopped,
    Up,
    Stopping,
}

impl Lives {
    /// Follows an event; a fixture's starts count up over the parts.
    pub fn follow(&mut self, kind: &mut EventKind) {
        match kind {
            EventKind::FixtureStarting { fixture, attempt } => {
                let life = self.fixtures.entry(*fixture).or_default();
                life.starts += 1;
                *attempt = life.starts;
                life.stage = Stage::Up;
            }
            EventKind::FixtureStopping { fixture } => {
                self.fixtures.entry(*fixture).or_default().stage = Stage::Stopping;
            }
            EventKind::FixtureStopped { fixture, .. } => {
                self.fixtures.entry(*fixture).or_default().stage = Stage::Stopped;
            }
            EventKind::HookStarted { hook, .. } => self.open_hooks.push(*hook),
            EventKind::HookFinished { hook, .. } => self.open_hooks.retain(|open| open != hook),
            _ => {}
        }
    }

    /// A fixture broke in a part. The next one may start it again.
    pub fn broke(&mut self, fixture: FixtureId, reason: String) {
        let reasons = self.broken.entry(fixture).or_default();
        if !reasons.contains(&reason) {
            reasons.push(reason);
        }
    }

    /// The ends of what a runner that died left open. The next part follows.
    pub fn end_part(&mut self) -> Vec<EventKind> {
        let problem = || Some(DIED.to_owned());
        let tests = self.episode_tests.as_mut().map(EpisodeTests::end_part);
        let mut ends = tests.unwrap_or_default();
        let hooks = self.open_hooks.iter();
        ends.extend(hooks.map(|hook| EventKind::HookFinished { hook: *hook, problem: problem() }));
        for (&fixture, life) in &self.fixtures {
            if life.stage == Stage::Up {
                ends.push(EventKind::FixtureStopping { fixture });
            }
            if life.stage != Stage::Stopped {
                let log_tail = Vec::new();
                ends.push(EventKind::FixtureStopped { fixture, problem: problem(), log_tail });
            }
        }
        ends
    }
}

impl MergedSuite {
    /// Writes the suite, which starts and finishes once.
    pub fn write(
        self,
        suite: SuiteId,
        parts: &Parts<'_>,
        out: &mut Merging<'_>,
    ) -> Result<(), JournalError> {
        self.waiting.into_iter().try_for_each(|kind| out.push(kind))?;
        if self.pieces.iter().all(|piece| piece.started.is_none()) {
            return Ok(());
        }
        out.push(EventKind::SuiteStarted { suite })?;
        let prepared = self.prepared.map(EventKind::SuitePrepared);
        prepared.into_iter().try_for_each(|kind| out.push(kind))?;
        let is_joined = self.pieces.len() > 1;
        let episode_tests = (is_joined && self.has_episodes).then(EpisodeTests::default);
        let mut lives = Lives { is_joined, episode_tests, ..Lives::default() };
        for piece in &self.pieces {
            piece.write((parts, suite), &mut lives, out)?;
        }
        for (fixture, reasons) in lives.broken {
            out.push(EventKind::FixtureBroken { fixture, reason: reasons.join("; later: ") })?;
        }
        if !self.pieces.iter().all(|piece| piece.is_whole) {
            return Ok(());
        }
        let tests = lives.episode_tests.into_iter().flat_map(EpisodeTests::ends);
        tests.into_iter().try_for_each(|kind| out.push(kind))?;
        out.push(EventKind::SuiteFinished { suite })
    }
}
