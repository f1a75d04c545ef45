//! The progress of the run, its suites, fixtures and tests in an event stream.

use std::collections::BTreeSet;

use super::cases::CaseProgress;
use crate::SuiteId;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum StreamStage {
    #[default]
    Before,
    Planning,
    Running,
    After,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SuiteStage {
    Planned,
    /// Started, and nothing of the suite has happened yet.
    Fresh,
    Open,
    Closed,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum FixtureStage {
    #[default]
    Stopped,
    Starting,
    Ready,
    Collapsed,
    Stopping,
}

#[derive(Clone, Debug, Default)]
pub(super) struct FixtureProgress {
    pub suite: SuiteId,
    pub stage: FixtureStage,
    pub attempt: u32,
    pub broken: bool,
    /// The names of the values of this set-up.
    pub provided: BTreeSet<String>,
}

#[derive(Clone, Debug, Default)]
pub(super) struct TestProgress {
    pub suite: SuiteId,
    /// At most so many; `None` when it is repeated for a time.
    pub repetitions: Option<u32>,
    pub open: bool,
    /// It is judged, and open because fixtures are still being notified.
    pub judged: bool,
    pub last: Option<(u32, u32)>,
    /// The last attempt announced another one when it finished.
    pub rerun: bool,
    /// It was skipped, or will not be repeated.
    pub ended: bool,
    pub cases: CaseProgress,
    /// The numbers of the questions that wait for an answer.
    pub open_questions: BTreeSet<u32>,
    /// The faults that last.
    pub faults: BTreeSet<String>,
}

impl TestProgress {
    /// Whether its verdict is final.
    pub fn is_decided(&self) -> bool {
        let all_done = self.last.is_some_and(|(r, _)| Some(r) == self.repetitions);
        self.ended || (all_done && !self.rerun)
    }
}
