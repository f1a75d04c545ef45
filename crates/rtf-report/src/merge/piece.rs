//! What one run has of a suite: where it is in the journal, and how it is written.

use rtf_model::{Event, EventKind, Micros, SuiteId};

use super::kept_attachments::{KeptAttempts, OpenAttempts};
use super::lives::Lives;
use super::place::Ids;
use super::plan::MergedPlan;
use super::{AttachedFile, MergeInput, Merging};
use crate::journal::{JournalError, LinePosition, Section};

/// What one run has of a suite.
#[derive(Debug)]
pub(super) struct Piece {
    /// The run's place.
    part: usize,
    /// When the suite started, in the times of the run.
    pub started: Option<Micros>,
    /// Whether the suite finished.
    pub is_whole: bool,
    /// From its first event to its last one. Suites that ran at the same time are in between.
    section: Option<Section>,
}

impl Piece {
    /// Nothing of a suite happened in this run.
    pub fn of(part: usize) -> Self {
        Self { part, started: None, is_whole: false, section: None }
    }

    /// Adds the line between these positions.
    pub fn extend(&mut self, start: LinePosition, end: &LinePosition) {
        self.section.get_or_insert_with(|| Section::starting_at(start)).extend_to(end);
    }

    /// Writes it from the journal, with the ids of the merged run. In a `joined` suite,
    /// other runs have pieces, too.
    pub fn write(
        &self,
        (parts, suite): (&Parts<'_>, SuiteId),
        lives: &mut Lives,
        out: &mut Merging<'_>,
    ) -> Result<(), JournalError> {
        let Some((began, section)) = self.started.zip(self.section.as_ref()) else {
            return Ok(());
        };
        for mut end in lives.end_part() {
            lives.follow(&mut end);
            out.push(end)?;
        }
        let (run, ids) = (&parts.runs[self.part], Ids { plan: parts.plan, part: self.part });
        let begins = out.now;
        let (mut belongs_to, mut attempts) = (Some(suite), OpenAttempts::of(self.part));
        section.read(&run.journal, |Event { at, mut kind, .. }| {
            attempts.follow(&kind);
            parts.kept.mark(&attempts, &mut kind);
            let file = AttachedFile::of(self.part, run, &kind);
            belongs_to = ids.translate(&mut kind).or(belongs_to);
            if belongs_to != Some(suite) {
                return Ok(());
            }
            lives.follow(&mut kind);
            let moved = |time: Micros| Micros(begins.0 + time.0.saturating_sub(began.0));
            out.now = moved(at);
            if let Some(since) = kind.since_mut() {
                *since = moved(*since);
            }
            if lives.episode_tests.as_mut().is_some_and(|tests| !tests.follow(&mut kind)) {
                return Ok(());
            }
            match kind {
                EventKind::SuiteWaiting { .. }
                | EventKind::SuiteStarted { .. }
                | EventKind::SuitePrepared(_)
                | EventKind::SuiteFinished { .. } => Ok(()),
                EventKind::FixtureBroken { fixture, reason } if lives.is_joined => {
                    lives.broke(fixture, reason);
                    Ok(())
                }
                kind => out.push_with(kind, file.as_ref()),
            }
        })
    }
}

/// The runs, and what they have together.
#[derive(Debug)]
pub(super) struct Parts<'a> {
    pub runs: &'a [MergeInput],
    pub plan: &'a MergedPlan,
    pub kept: &'a KeptAttempts,
}
