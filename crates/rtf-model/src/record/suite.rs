//! What is known of one suite.

use crate::{FixtureId, HookId, Micros, SuitePlanned, SuitePrepared, TestId};

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
            prepared: None,
            started: None,
            finished: None,
        }
    }
}
