//! The state of a shared host: the tests that were assigned to it, and whether it runs one.

use std::collections::VecDeque;

use super::active_test::AttemptNumber;
use crate::run::machine::io::HostId;
use rtf_plan::plan::{SuitePlan, TestPlan};

/// A host of successive tests.
#[derive(Debug)]
pub(super) struct SharedHost<'p> {
    /// Whether a test may be assigned while another one runs.
    pub assigns_ahead: bool,
    /// Whether it gets tests of a further episode.
    pub serves_episodes: bool,
    /// The tests that were assigned ahead, in order, and the host's id from the begin of each.
    pub assigned: VecDeque<(HostId, &'p TestPlan, AttemptNumber)>,
    /// The host has begun the assigned test, which is being started.
    pub begun: Option<HostId>,
    /// It has no test; it served this one last, with the fixtures' values of this version.
    pub idle: Option<(HostId, &'p TestPlan, u64)>,
    /// It was killed this many times and has not ended.
    pub killed: Option<(HostId, u32)>,
}

impl SharedHost<'_> {
    pub(super) fn new(suite: &SuitePlan) -> Self {
        let assigns_ahead = suite.fixtures.is_empty() && suite.hooks.is_empty() && !suite.repeats();
        let assigned = VecDeque::new();
        Self {
            assigns_ahead,
            serves_episodes: false,
            assigned,
            begun: None,
            idle: None,
            killed: None,
        }
    }
}
