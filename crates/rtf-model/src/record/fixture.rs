//! The state and history of one fixture.

use super::EpisodeOutcome;
use crate::{
    EventKind, FixturePlanned, FixtureProvided, Growth, LeakedProcess, Message, MessageKind,
    Micros, UsageSeries,
};

/// The current state of a fixture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FixtureState {
    /// Not started yet.
    #[default]
    Pending,
    /// Being set up.
    Starting,
    /// Set up and supervised.
    Ready,
    /// It was ready and has failed.
    Collapsed,
    /// Being torn down.
    Stopping,
    /// Torn down.
    Stopped,
    /// It will not be started again.
    Broken,
}

/// One life of a fixture, from its set-up to the end of its tear-down.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FixtureLife {
    /// When its set-up began.
    pub starting: Micros,
    /// When its set-up succeeded.
    pub ready: Option<Micros>,
    /// When and why it collapsed.
    pub collapsed: Option<(Micros, String)>,
    /// When its tear-down began.
    pub stopping: Option<Micros>,
    /// When its tear-down ended.
    pub stopped: Option<Micros>,
    /// The problem in its set-up or tear-down.
    pub problem: Option<String>,
    /// Its resources at the end of each test, when tests are repeated.
    pub usage: UsageSeries,
}

/// The state and history of one fixture.
#[derive(Clone, Debug, Default)]
pub struct FixtureRecord {
    /// How it was planned.
    pub plan: FixturePlanned,
    /// Its current state.
    pub state: FixtureState,
    /// Number of starts.
    pub starts: u32,
    /// The last start.
    pub started: Option<Micros>,
    /// When the last set-up succeeded.
    pub ready: Option<Micros>,
    /// The values that it has provided since the last start.
    pub values: Vec<FixtureProvided>,
    /// Its lives, the oldest first.
    pub lives: Vec<FixtureLife>,
    /// Its collapses: when, and why.
    pub collapses: Vec<(Micros, String)>,
    /// The first cause, when it is broken.
    pub broken: Option<String>,
    /// Problems in set-ups and tear-downs, with their times.
    pub problems: Vec<(Micros, String)>,
    /// The last lines that it printed before the last problem.
    pub log_tail: Vec<String>,
    /// Its failures and errors.
    pub messages: Vec<Message>,
    /// Its processes that had to be killed.
    pub leaked: Vec<LeakedProcess>,
}

impl FixtureRecord {
    pub(super) fn new(plan: FixturePlanned) -> Self {
        Self { plan, ..Self::default() }
    }

    pub(super) fn apply(&mut self, at: Micros, kind: &EventKind) {
        self.apply_to_life(at, kind);
        match kind {
            EventKind::FixtureStarting { attempt, .. } => {
                self.starts = *attempt;
                self.started = Some(at);
                self.ready = None;
                self.values.clear();
                self.state = FixtureState::Starting;
            }
            EventKind::FixtureProvided(provided) => self.values.push(provided.clone()),
            EventKind::FixtureReady { .. } => {
                self.state = FixtureState::Ready;
                self.ready = Some(at);
            }
            EventKind::FixtureCollapsed { reason, log_tail, .. } => {
                self.state = FixtureState::Collapsed;
                self.collapses.push((at, reason.clone()));
                self.log_tail.clone_from(log_tail);
            }
            EventKind::FixtureStopping { .. } => self.state = FixtureState::Stopping,
            EventKind::FixtureStopped { problem, log_tail, .. } => {
                let broken = self.broken.is_some();
                self.state = if broken { FixtureState::Broken } else { FixtureState::Stopped };
                if let Some(problem) = problem {
                    self.problems.push((at, problem.clone()));
                    self.log_tail.clone_from(log_tail);
                }
            }
            EventKind::FixtureBroken { reason, .. } => {
                self.state = FixtureState::Broken;
                self.broken = Some(reason.clone());
            }
            EventKind::Message { message, .. } => self.keep_failure(message),
            EventKind::ProcessesLeaked { processes, .. } => {
                self.leaked.extend_from_slice(processes)
            }
            _ => {}
        }
    }

    fn apply_to_life(&mut self, at: Micros, kind: &EventKind) {
        if let EventKind::FixtureStarting { .. } = kind {
            self.lives.push(FixtureLife { starting: at, ..FixtureLife::default() });
        }
        let Some(life) = self.lives.last_mut() else { return };
        match kind {
            EventKind::FixtureReady { .. } => life.ready = Some(at),
            EventKind::FixtureCollapsed { reason, .. } => {
                life.collapsed = Some((at, reason.clone()));
            }
            EventKind::FixtureStopping { .. } => life.stopping = Some(at),
            EventKind::ResourcesMeasured { usage, .. } => life.usage.add(*usage),
            EventKind::FixtureStopped { problem, .. } => {
                life.stopped = Some(at);
                life.problem.clone_from(problem);
            }
            _ => {}
        }
    }

    fn keep_failure(&mut self, message: &Message) {
        if matches!(message.kind, MessageKind::Failure | MessageKind::Error) {
            self.messages.push(message.clone());
        }
    }

    /// The resources that grew, in the life with the most measurements.
    #[must_use]
    pub fn growth(&self) -> Vec<Growth> {
        let longest = self.lives.iter().max_by_key(|life| life.usage.seen());
        longest.map(|life| life.usage.growth()).unwrap_or_default()
    }

    /// The reasons why the suite is not green.
    #[must_use]
    pub fn problems(&self, tolerates_collapse: bool) -> Vec<String> {
        let problems = self.problems_since((0, 0), tolerates_collapse);
        problems.into_iter().map(|(_, text)| text).collect()
    }

    /// The same after this many collapses and other problems, with their results for an episode.
    pub(super) fn problems_since(
        &self,
        (collapses, others): (usize, usize),
        tolerates_collapse: bool,
    ) -> Vec<(EpisodeOutcome, String)> {
        let name = &self.plan.name;
        let mut problems = Vec::new();
        if let Some(reason) = &self.broken {
            let text = format!("fixture `{name}` is broken: {reason}");
            problems.push((EpisodeOutcome::Collapsed, text));
        }
        for (_, reason) in self.collapses.iter().skip(collapses).filter(|_| !tolerates_collapse) {
            let text = format!("fixture `{name}` collapsed: {reason}");
            problems.push((EpisodeOutcome::Collapsed, text));
        }
        for (_, problem) in self.problems.iter().skip(others) {
            if self.broken.as_ref() != Some(problem) {
                problems.push((EpisodeOutcome::Error, format!("fixture `{name}`: {problem}")));
            }
        }
        problems
    }
}
