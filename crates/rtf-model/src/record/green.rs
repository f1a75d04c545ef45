//! What makes a run red.

use super::{HookRecord, Record, RunState, TestRecord};
use crate::{Significance, SuiteId};

impl Record {
    /// The problems of a suite apart from its tests: fixtures that
    /// collapsed, broke, or could not be torn down, and hooks that failed.
    #[must_use]
    pub fn suite_problems(&self, suite: SuiteId) -> Vec<String> {
        let mut problems = self.fixture_problems(suite);
        let hooks = self.suites.get(suite.index()).into_iter().flat_map(|it| self.hooks_of(it));
        problems.extend(hooks.flat_map(HookRecord::problems));
        problems
    }

    /// The problems of a suite's fixtures.
    #[must_use]
    pub fn fixture_problems(&self, suite: SuiteId) -> Vec<String> {
        let Some(suite) = self.suites.get(suite.index()) else { return Vec::new() };
        let tolerant = suite.plan.tolerates_collapse;
        self.fixtures_of(suite).flat_map(|fixture| fixture.problems(tolerant)).collect()
    }

    /// Whether there is no problem with the robot or the bench: the run
    /// finished, has tests, each of them passed, no fixture or hook failed,
    /// and its journal is not damaged.
    #[must_use]
    pub fn is_green(&self) -> bool {
        self.is_green_without_tests()
            && !self.tests.is_empty()
            && self.tests.iter().all(|test| self.has_green_result(test))
    }

    /// Whether there is no problem apart from the tests: the run finished, no fixture or
    /// hook failed, and its journal is not damaged.
    #[must_use]
    pub fn is_green_without_tests(&self) -> bool {
        !self.is_damaged()
            && self.state == RunState::Finished { interrupted: None }
            && self.suites.iter().all(|s| self.suite_problems(s.plan.suite).is_empty())
    }

    /// Whether a test has finished and does not make the run red.
    #[must_use]
    pub fn has_green_result(&self, test: &TestRecord) -> bool {
        test.verdict().is_some()
            && self.is_test_green(test)
            && !(self.flaky_fails() && test.is_flaky())
    }

    /// Whether a test does not make the run red: it passed, its failure is known, or it
    /// skipped itself. One that has not finished is not green.
    #[must_use]
    pub fn is_test_green(&self, test: &TestRecord) -> bool {
        let skips_fail = self.skips_fail(test);
        match test.significance() {
            Significance::Expected | Significance::Quarantined => true,
            Significance::UnexpectedPass => false,
            Significance::SkippedItself => !skips_fail,
            Significance::Counts => {
                test.final_verdict().is_green() && !(skips_fail && test.has_skipped_cases())
            }
        }
    }

    /// Whether the run is red if the test, or a case of it, skips itself.
    #[must_use]
    pub fn skips_fail(&self, test: &TestRecord) -> bool {
        let suite = self.suites.get(test.plan.suite.index());
        suite.is_some_and(|suite| suite.plan.skips_fail)
            || self.run.as_ref().is_some_and(|run| run.manifest.no_skips)
    }

    /// Whether a test that passed only after a retry counts as failed.
    #[must_use]
    pub fn flaky_fails(&self) -> bool {
        self.run.as_ref().is_some_and(|run| run.manifest.flaky_fails)
    }
}
