//! The order of tests by their past results.

use std::cmp::Reverse;
use std::collections::HashMap;
use std::time::Duration;

use crate::plan::{SuitePlan, TestPlan};

/// The assumed duration of tests if none of them has a known one.
const UNKNOWN: Duration = Duration::from_secs(1);

/// An order of tests by their past results. Equal tests keep the order of the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TestOrder {
    /// Tests whose last result is a problem, then the others.
    FailedFirst,
    SlowestFirst,
}

/// What is known about the past runs of a test.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PastResult {
    /// Whether its last result is a problem, or a pass on a retry.
    pub failed: bool,
    /// The usual duration, with all its repetitions.
    pub duration: Option<Duration>,
}

/// The past results of tests, by the names of suite and test.
pub type PastResults = HashMap<(String, String), PastResult>;

impl TestOrder {
    /// Sorts suites, and the tests of each. What is critical keeps its position, and tests
    /// that share a host stay together.
    pub(super) fn apply(self, suites: &mut Vec<SuitePlan>, past: &PastResults) {
        let durations = Durations::new(suites, past);
        let test_key = |suite: &str, test: &TestPlan| match self {
            Self::FailedFirst => {
                let result = past.get(&(suite.to_owned(), test.name.clone()));
                Duration::from_secs(result.is_some_and(|result| result.failed).into())
            }
            Self::SlowestFirst => durations.of(suite, test),
        };
        // Of the parts of a block: whether any of them has failed, or how long they take.
        let sum = |keys: &mut dyn Iterator<Item = Duration>| match self {
            Self::FailedFirst => keys.max().unwrap_or_default(),
            Self::SlowestFirst => keys.sum(),
        };
        for suite in &mut *suites {
            let name = suite.name.clone();
            let share = suite.settings.parallel == 1;
            let tests = std::mem::take(&mut suite.tests);
            let mut blocks = blocks(tests, share);
            for block in &mut blocks {
                block.sort_by_cached_key(|test| Reverse(test_key(&name, test)));
            }
            sort_between(
                &mut blocks,
                |block| block[0].settings.critical,
                |block| sum(&mut block.iter().map(|test| test_key(&name, test))),
            );
            suite.tests = blocks.into_iter().flatten().collect();
        }
        let stops_run = |suite: &SuitePlan| {
            suite.settings.critical_stops_run && suite.tests.iter().any(|it| it.settings.critical)
        };
        sort_between(suites, stops_run, |suite| {
            sum(&mut suite.tests.iter().map(|test| test_key(&suite.name, test)))
        });
    }
}

/// Consecutive tests that share a host; a critical test is a block by itself.
fn blocks(tests: Vec<TestPlan>, share: bool) -> Vec<Vec<TestPlan>> {
    let mut blocks: Vec<Vec<TestPlan>> = Vec::new();
    for test in tests {
        let joins = |block: &Vec<TestPlan>| {
            let critical = block[0].settings.critical || test.settings.critical;
            share && !critical && block[0].can_share_host(&test)
        };
        match blocks.last_mut().filter(|block| joins(block)) {
            Some(block) => block.push(test),
            None => blocks.push(vec![test]),
        }
    }
    blocks
}

/// Sorts the items between those that keep their positions by a key, the largest first.
fn sort_between<T>(items: &mut [T], is_fixed: impl Fn(&T) -> bool, key: impl Fn(&T) -> Duration) {
    for part in items.split_mut(is_fixed) {
        part.sort_by_cached_key(|item| Reverse(key(item)));
    }
}

/// The expected durations of tests.
pub(super) struct Durations<'a> {
    past: &'a PastResults,
    /// Of a test without results: the median of the others.
    unknown: Duration,
}

impl<'a> Durations<'a> {
    pub(super) fn new(suites: &[SuitePlan], past: &'a PastResults) -> Self {
        let mut durations = Self { past, unknown: UNKNOWN };
        let tests = suites.iter().flat_map(|suite| suite.tests.iter().map(move |t| (suite, t)));
        let mut known: Vec<_> =
            tests.filter_map(|(suite, test)| durations.known(&suite.name, test)).collect();
        known.sort_unstable();
        durations.unknown = known.get(known.len() / 2).copied().unwrap_or(UNKNOWN);
        durations
    }

    fn known(&self, suite: &str, test: &TestPlan) -> Option<Duration> {
        self.past.get(&(suite.to_owned(), test.name.clone()))?.duration
    }

    pub(super) fn of(&self, suite: &str, test: &TestPlan) -> Duration {
        self.known(suite, test).unwrap_or(self.unknown)
    }
}
