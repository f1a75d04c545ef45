//! What is known of one suite.

use super::host::{self, HostRecord};
use crate::{FixtureId, Growth, HookId, Micros, SuitePlanned, SuitePrepared, TestId};

/// What is known of one suite.
#[derive(Clone, Debug)]
pub struct SuiteRecord {
    /// How it was planned.
    pub plan: SuitePlanned,
    /// Its fixtures, in the order of the plan.
    pub fixtures: Vec<FixtureId>,
    /// Its hooks, in the order of the plan.
    pub hooks: Vec<HookId>,
    /// Its tests, in the order of the plan.
    pub tests: Vec<TestId>,
    /// The hosts that its tests shared, the oldest first; known when tests are repeated.
    pub hosts: Vec<HostRecord>,
    /// What it got for itself, if anything.
    pub prepared: Option<SuitePrepared>,
    /// When it started.
    pub started: Option<Micros>,
    /// When it ended.
    pub finished: Option<Micros>,
}

impl SuiteRecord {
    pub(super) fn new(plan: SuitePlanned) -> Self {
        Self {
            plan,
            fixtures: Vec::new(),
            hooks: Vec::new(),
            tests: Vec::new(),
            hosts: Vec::new(),
            prepared: None,
            started: None,
            finished: None,
        }
    }

    /// The shared hosts that used more and more, and what; of those that served the
    /// same tests, the one that was measured most.
    #[must_use]
    pub fn growing_hosts(&self) -> Vec<(&HostRecord, Vec<Growth>)> {
        host::growing(&self.hosts)
    }
}
