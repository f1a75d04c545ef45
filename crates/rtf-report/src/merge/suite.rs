//! What happened in a suite, one part after the other.

use std::collections::BTreeMap;

use rtf_model::{EventKind, FixtureId, HookId, Micros, SuiteId};

use super::Merging;

/// The reason of fixtures and hooks that the death of a runner left open.
const DIED: &str = "the runner died";

/// The events of a suite, with their new ids.
#[derive(Debug)]
pub(super) struct MergedSuite {
    id: SuiteId,
    /// One for each run that has this suite.
    pieces: Vec<Piece>,
}

/// What one run says of a suite, with the times of the run.
#[derive(Debug, Default)]
pub(super) struct Piece {
    events: Vec<(Micros, EventKind)>,
}

/// The states of fixtures and hooks, and events that are delayed until no
/// part follows that starts them again.
#[derive(Debug, Default)]
struct Lives {
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
    fn follow(&mut self, kind: &mut EventKind) {
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

    /// The ends of what a runner that died left open.
    fn ends(&self) -> Vec<EventKind> {
        let problem = || Some(DIED.to_owned());
        let hooks = self.open_hooks.iter();
        let mut ends: Vec<_> =
            hooks.map(|hook| EventKind::HookFinished { hook: *hook, problem: problem() }).collect();
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
    /// A suite of which nothing is known yet.
    pub fn new(id: SuiteId) -> Self {
        Self { id, pieces: Vec::new() }
    }

    /// Another run has this suite.
    pub fn begin_piece(&mut self) {
        self.pieces.push(Piece::default());
    }

    /// The next event of the last run that has this suite.
    pub fn add(&mut self, at: Micros, kind: EventKind) {
        if let Some(piece) = self.pieces.last_mut() {
            piece.events.push((at, kind));
        }
    }

    /// Writes the suite, which starts and finishes once.
    pub fn write(self, out: &mut Merging) {
        let pieces = &self.pieces;
        let events = || pieces.iter().flat_map(|piece| piece.events.iter().map(|(_, kind)| kind));
        let waiting = |kind: &&EventKind| matches!(kind, EventKind::SuiteWaiting { .. });
        events().filter(waiting).for_each(|kind| out.push(kind.clone()));
        if !events().any(|kind| matches!(kind, EventKind::SuiteStarted { .. })) {
            return;
        }
        out.push(EventKind::SuiteStarted { suite: self.id });
        // The private resources of the first part are kept.
        let prepared = events().find(|kind| matches!(kind, EventKind::SuitePrepared(_)));
        prepared.into_iter().for_each(|kind| out.push(kind.clone()));
        let is_whole = pieces.iter().all(Piece::is_whole);
        let is_joined = pieces.len() > 1;
        let mut lives = Lives::default();
        for piece in self.pieces {
            piece.write(out, &mut lives, is_joined);
        }
        for (fixture, reasons) in lives.broken {
            out.push(EventKind::FixtureBroken { fixture, reason: reasons.join("; later: ") });
        }
        if is_whole {
            out.push(EventKind::SuiteFinished { suite: self.id });
        }
    }
}

impl Piece {
    fn is_whole(&self) -> bool {
        self.events.iter().any(|(_, kind)| matches!(kind, EventKind::SuiteFinished { .. }))
    }

    /// When the suite started, in the times of the run.
    fn started(&self) -> Option<Micros> {
        let start = |kind: &EventKind| matches!(kind, EventKind::SuiteStarted { .. });
        self.events.iter().find(|(_, kind)| start(kind)).map(|(at, _)| *at)
    }

    fn write(self, out: &mut Merging, lives: &mut Lives, is_joined: bool) {
        let Some(began) = self.started() else { return };
        for mut end in lives.ends() {
            lives.follow(&mut end);
            out.push(end);
        }
        let begins = out.now;
        for (at, mut kind) in self.events {
            lives.follow(&mut kind);
            out.now = Micros(begins.0 + at.0.saturating_sub(began.0));
            match kind {
                EventKind::SuiteWaiting { .. }
                | EventKind::SuiteStarted { .. }
                | EventKind::SuitePrepared(_)
                | EventKind::SuiteFinished { .. } => {}
                EventKind::FixtureBroken { fixture, reason } if is_joined => {
                    let reasons = lives.broken.entry(fixture).or_default();
                    if !reasons.contains(&reason) {
                        reasons.push(reason);
                    }
                }
                kind => out.push(kind),
            }
        }
    }
}
