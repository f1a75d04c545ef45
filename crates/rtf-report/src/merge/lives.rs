//! What is open in a suite of the merged run: its fixtures, hooks and tests.

use std::collections::BTreeMap;

use rtf_model::{EventKind, FixtureId, HookId};

use super::episode_tests::{DIED, EpisodeTests};

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
    pub broken: BTreeMap<FixtureId, Vec<String>>,
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
    /// Nothing has started. A suite is joined if several runs have it.
    pub fn of(is_joined: bool, has_episodes: bool) -> Self {
        let episode_tests = (is_joined && has_episodes).then(EpisodeTests::default);
        Self { is_joined, episode_tests, ..Self::default() }
    }

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
