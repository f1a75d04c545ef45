//! How far everything in a stream is.

use crate::SuiteId;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Stage {
    #[default]
    Before,
    Planning,
    Running,
    After,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bracket {
    Planned,
    /// Started, and nothing of the suite has happened yet.
    Fresh,
    Open,
    Closed,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FixtureStage {
    Stopped,
    Starting,
    Ready,
    Collapsed,
    Stopping,
}

#[derive(Clone, Debug)]
pub(super) struct Fixture {
    pub suite: SuiteId,
    pub stage: FixtureStage,
    pub attempt: u32,
    pub broken: bool,
}

#[derive(Clone, Debug)]
pub(super) struct Test {
    pub suite: SuiteId,
    /// How many at the most; none when it is repeated until a time is over.
    pub repetitions: Option<u32>,
    pub open: bool,
    /// Whether it is judged already, and open because fixtures are told.
    pub judged: bool,
    pub last: Option<(u32, u32)>,
    /// Whether the last attempt's end announced another one.
    pub rerun: bool,
    /// Skipped, or told to be repeated no more.
    pub over: bool,
}

impl Test {
    pub fn new(suite: SuiteId, repetitions: Option<u32>) -> Self {
        let (open, judged, rerun, over) = (false, false, false, false);
        Self { suite, repetitions, open, judged, last: None, rerun, over }
    }

    /// Whether its last word is spoken.
    pub fn is_decided(&self) -> bool {
        let all_done = self.last.is_some_and(|(r, _)| Some(r) == self.repetitions);
        self.over || (all_done && !self.rerun)
    }
}
