//! Reads each journal once: what the runs have together, and where each suite is in which
//! journal. Holds one line of one journal at a time.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;

use rtf_model::{
    Diagnostic, Event, EventKind, LeakedProcess, Micros, OrderChecker, OrderError, RunState,
    SuiteId,
};

use super::kept_attachments::{AttachingAttempt, Keep, KeptAttempts, OpenAttempts};
use super::manifest::JoinedManifests;
use super::piece::Piece;
use super::place::Ids;
use super::plan::JoinedPlans;
use super::suite::MergedSuite;
use super::{MergeInput, MergeProblem};
use crate::journal::{self, LinePosition};

/// What the runs have together. The events of suites are still in the journals.
#[derive(Debug, Default)]
pub(super) struct FirstPass {
    pub plans: JoinedPlans,
    pub manifests: JoinedManifests,
    pub suites: Vec<MergedSuite>,
    /// Those that belong to no suite.
    pub warnings: Vec<Diagnostic>,
    pub kept: KeptAttempts,
    pub ends: RunEnds,
}

#[derive(Debug, Default)]
pub(super) struct RunEnds {
    interrupted: Option<String>,
    died: Vec<String>,
    leaked: Vec<LeakedProcess>,
}

impl RunEnds {
    /// The last event of the merged run.
    pub fn into_event(self) -> EventKind {
        match self.died.is_empty() {
            true => EventKind::RunFinished { interrupted: self.interrupted },
            false => EventKind::RunnerDied { reason: self.died.join("; "), leaked: self.leaked },
        }
    }
}

impl FirstPass {
    /// No run was read yet.
    pub fn of(keep: Keep) -> Self {
        Self { kept: KeptAttempts::of(keep), ..Self::default() }
    }

    /// A problem for each test that more than one of these runs has. Runs with other episodes
    /// may have the same tests, but they must not be the same run.
    pub fn duplicates(&self, runs: &[MergeInput]) -> Vec<MergeProblem> {
        let has_episodes =
            |suite: SuiteId| self.suites.get(suite.index()).is_some_and(|suite| suite.has_episodes);
        let (joined, others): (Vec<_>, Vec<_>) =
            self.plans.duplicates.iter().partition(|it| it.timed && has_episodes(it.suite));
        let repeated: BTreeSet<_> =
            joined.iter().filter_map(|it| self.manifests.same_run(it.runs[1])).collect();
        let name = |run: usize| runs[run].name.clone();
        let twice = others.into_iter().map(|it| MergeProblem::Twice {
            test: it.test.clone(),
            first: name(it.runs[0]),
            second: name(it.runs[1]),
        });
        let same = repeated.into_iter().map(|[first, second]| MergeProblem::SameRun {
            first: name(first),
            second: name(second),
        });
        twice.chain(same).collect()
    }

    /// Reads the next run.
    ///
    /// # Errors
    /// It cannot be a part of a merged run.
    pub fn read(&mut self, run: &MergeInput) -> Result<(), MergeProblem> {
        let mut reading = PartReading::new(self, &run.name);
        let stored = journal::read_events(&run.journal, |line, event| reading.line(line, event))?;
        let name = || run.name.clone();
        if let Some(damage) = stored.record.damages.into_iter().next() {
            return Err(MergeProblem::Damaged { run: name(), damage });
        }
        if stored.record.state == RunState::Running
            && File::open(&run.journal).is_ok_and(|journal| journal::is_written(&journal))
        {
            return Err(MergeProblem::Running { run: name() });
        }
        if !reading.has_begun {
            return Err(MergeProblem::NoBeginning { run: name() });
        }
        match reading.disorder.take() {
            Some(source) => Err(MergeProblem::Order { run: name(), source }),
            None => {
                reading.finish();
                Ok(())
            }
        }
    }
}

/// One journal that is being read.
struct PartReading<'a> {
    pass: &'a mut FirstPass,
    name: &'a str,
    part: usize,
    /// Where the next line begins.
    position: LinePosition,
    order: OrderChecker,
    disorder: Option<OrderError>,
    has_begun: bool,
    has_ended: bool,
    /// The suite of the last event that belongs to one.
    suite: Option<SuiteId>,
    pieces: BTreeMap<SuiteId, Piece>,
    attempts: OpenAttempts,
    /// The last episodes of suites.
    episodes: BTreeMap<SuiteId, u64>,
}

impl<'a> PartReading<'a> {
    fn new(pass: &'a mut FirstPass, name: &'a str) -> Self {
        let part = pass.plans.begin_part();
        Self {
            pass,
            name,
            part,
            position: LinePosition::default(),
            order: OrderChecker::default(),
            disorder: None,
            has_begun: false,
            has_ended: false,
            suite: None,
            pieces: BTreeMap::new(),
            attempts: OpenAttempts::of(part),
            episodes: BTreeMap::new(),
        }
    }

    /// A run that was killed may end anywhere; what is there has to be in order.
    fn line(&mut self, line: &[u8], event: Event) {
        let start = self.position.clone();
        self.position.advance(line);
        if self.disorder.is_none() {
            match self.order.check(&event) {
                Ok(()) => self.event(start, event),
                Err(error) => self.disorder = Some(error),
            }
        }
    }

    fn event(&mut self, start: LinePosition, Event { at, mut kind, .. }: Event) {
        self.pass.plans.add(&kind);
        let attempt = self.attempts.follow(&kind);
        attempt.into_iter().for_each(|attempt| self.choose(&attempt));
        let ids = Ids { plan: &self.pass.plans.plan, part: self.part };
        self.suite = ids.translate(&mut kind).or(self.suite);
        match (kind, self.suite) {
            (EventKind::RunStarted(run), _) => {
                self.has_begun = true;
                self.pass.manifests.add(&run);
            }
            (EventKind::RunFinished { interrupted }, _) => {
                self.has_ended = true;
                let ends = &mut self.pass.ends;
                ends.interrupted = ends.interrupted.take().or(interrupted);
            }
            (EventKind::RunnerDied { reason, leaked }, _) => {
                self.has_ended = true;
                self.pass.ends.died.push(format!("{reason} in {}", self.name));
                self.pass.ends.leaked.extend(leaked);
            }
            (kind, Some(suite)) => self.suite_event(suite, (start, at), kind),
            // The same files give the same warnings in each part.
            (EventKind::Warning { diagnostic }, None)
                if !self.pass.warnings.contains(&diagnostic) =>
            {
                self.pass.warnings.push(diagnostic);
            }
            _ => {}
        }
    }

    fn suite_event(
        &mut self,
        suite: SuiteId,
        (start, at): (LinePosition, Micros),
        kind: EventKind,
    ) {
        let merged = self.merged_suite(suite);
        match kind {
            // It may be far from the other events of its suite.
            EventKind::SuiteWaiting { .. } => merged.waiting.push(kind),
            EventKind::SuitePrepared(prepared) => {
                merged.prepared.get_or_insert(prepared);
            }
            _ => {
                let episode = episode_of(&kind);
                let part = self.part;
                let piece = self.pieces.entry(suite).or_insert_with(|| Piece::of(part));
                piece.extend(start, &self.position);
                match kind {
                    EventKind::SuiteStarted { .. } => piece.started = Some(at),
                    EventKind::SuiteFinished { .. } => piece.is_whole = true,
                    _ => {}
                }
                if let Some(episode) = episode {
                    self.episodes.insert(suite, episode);
                    self.merged_suite(suite).has_episodes = true;
                }
            }
        }
    }

    /// Keeps the attachments of an attempt, or not.
    fn choose(&mut self, attempt: &AttachingAttempt) {
        let plan = &self.pass.plans.plan;
        let test = &plan.tests[plan.maps[self.part].tests[attempt.id.test.index()].index()];
        let suite = &plan.suites[test.suite.index()].name;
        let episode = self.episodes.get(&test.suite);
        let number = episode.copied().unwrap_or(attempt.id.repetition.into());
        self.pass.kept.add(attempt, (suite, &test.name, number));
    }

    fn merged_suite(&mut self, suite: SuiteId) -> &mut MergedSuite {
        let suites = &mut self.pass.suites;
        (suites.len()..=suite.index()).for_each(|_| suites.push(MergedSuite::default()));
        &mut suites[suite.index()]
    }

    /// Each suite of this run has a piece, even if nothing of it happened.
    fn finish(mut self) {
        if !self.has_ended {
            self.pass.ends.died.push(format!("killed with its guard in {}", self.name));
        }
        for attempt in std::mem::take(&mut self.attempts).unfinished() {
            self.choose(&attempt);
        }
        let ids = Ids { plan: &self.pass.plans.plan, part: self.part };
        for suite in ids.suites().collect::<Vec<_>>() {
            let piece = self.pieces.remove(&suite).unwrap_or_else(|| Piece::of(self.part));
            self.merged_suite(suite).pieces.push(piece);
        }
    }
}
/// The episode that an event starts.
fn episode_of(kind: &EventKind) -> Option<u64> {
    match kind {
        EventKind::EpisodeStarted(started) => Some(started.episode.id),
        EventKind::CaseStarted(started) => Some(started.start.episode?.id),
        _ => None,
    }
}
