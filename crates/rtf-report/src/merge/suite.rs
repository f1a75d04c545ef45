//! What happened in a suite, one part after the other.

use rtf_model::{EventKind, SuiteId, SuitePrepared};

use super::Merging;
use super::episode_tests::EpisodeTests;
use super::lives::Lives;
use super::piece::{Parts, Piece};
use crate::journal::JournalError;

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
        let mut lives = Lives::of(self.pieces.len() > 1, self.has_episodes);
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
