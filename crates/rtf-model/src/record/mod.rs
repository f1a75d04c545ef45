//! The state of a run: the fold over its events.
//!
//! [`Record::apply`] is the only place that counts. The console's summary, the
//! JUnit file and every other report read a `Record`; none keeps separate state.

mod case;
mod case_episode;
mod counts;
mod episode;
mod fixture;
mod green;
mod hook;
mod host;
mod leaked_processes;
mod missing_plans;
mod question;
mod signal;
pub(crate) mod source;
mod suite;
mod test;

pub use case::{AttemptCases, CaseRecord, PlannedCases};
pub use counts::AttemptCounts;
pub use episode::{EpisodeOutcome, EpisodeRecord, TestAttempt};
pub use fixture::{FixtureLife, FixtureRecord, FixtureState};
pub use hook::{HookRecord, HookRunRecord};
pub use host::HostRecord;
pub(crate) use missing_plans::is_likely as is_likely_gap;
pub use question::QuestionRecord;
pub use signal::SignalSummary;
pub use suite::SuiteRecord;
pub use test::{AttemptRecord, TestRecord};

use crate::{
    Damage, Diagnostic, Event, EventKind, FixtureId, HookId, Micros, RunStarted, Source, SuiteId,
    TestId, Verdict,
};

/// The most tests for which memory is reserved when a run starts.
const RESERVED_TESTS: usize = 1 << 17;

/// The state of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum RunState {
    /// There is no `run-finished` yet: the run continues, or it was killed.
    #[default]
    Running,
    /// The run has finished.
    Finished {
        /// The signal or request that interrupted it.
        interrupted: Option<String>,
    },
    /// The runner died; the guard killed leftover processes. The record is incomplete.
    Died {
        /// How the runner ended.
        reason: String,
    },
}

/// Number of tests by state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TestTotals {
    /// Tests that were declared.
    pub planned: u32,
    /// Tests without a final verdict that are not running.
    pub pending: u32,
    /// Tests that are running.
    pub running: u32,
    counts: [u32; Verdict::ALL.len()],
}

impl TestTotals {
    /// Number of tests with this final verdict.
    #[must_use]
    pub fn of(&self, verdict: Verdict) -> u32 {
        self.counts[verdict as usize]
    }

    /// Number of tests with a final verdict.
    #[must_use]
    pub fn done(&self) -> u32 {
        self.counts.iter().sum()
    }
}

/// Everything that reports need to know about a run.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// The first event, once it has arrived.
    pub run: Option<RunStarted>,
    /// The state of the run.
    pub state: RunState,
    /// The time of the last event.
    pub last_at: Micros,
    /// Number of applied events.
    pub events: u64,
    /// The suites, by their ids.
    pub suites: Vec<SuiteRecord>,
    /// The fixtures, by their ids.
    pub fixtures: Vec<FixtureRecord>,
    /// The hooks, by their ids.
    pub hooks: Vec<HookRecord>,
    /// The tests, by their ids.
    pub tests: Vec<TestRecord>,
    /// The processes that the guard killed after the runner had died.
    pub leaked: Vec<crate::LeakedProcess>,
    /// Warnings for the user.
    pub warnings: Vec<Diagnostic>,
    /// Damaged places of the journal that this was read from, up to
    /// [`Damage::KEPT`]. A record of a damaged journal cannot be trusted.
    pub damages: Vec<Damage>,
    lean: bool,
    passed_cases_kept: u64,
}

impl Record {
    /// A record that counts messages, output, measurements and attachments, and
    /// keeps none of them: for readers that keep the journal open.
    #[must_use]
    pub fn lean() -> Self {
        Self { lean: true, ..Self::default() }
    }

    /// Applies the next event. An event about something that was never
    /// planned is ignored: [`crate::OrderChecker`] reports it.
    pub fn apply(&mut self, event: &Event) {
        self.last_at = event.at;
        self.events += 1;
        let at = event.at;
        match &event.kind {
            EventKind::RunStarted(run) => {
                // Not more because of a damaged number.
                self.tests.reserve_exact((run.tests as usize).min(RESERVED_TESTS));
                self.run = Some(run.clone());
            }
            EventKind::Warning { diagnostic } => self.warnings.push(diagnostic.clone()),
            EventKind::RunFinished { interrupted } => {
                self.state = RunState::Finished { interrupted: interrupted.clone() };
            }
            EventKind::SuiteStarted { suite } => self.suite(*suite, |s| s.started = Some(at)),
            EventKind::SuitePrepared(prepared) => {
                self.suite(prepared.suite, |s| s.prepared = Some(prepared.clone()));
            }
            EventKind::SuiteFinished { suite } => self.suite(*suite, |s| s.finished = Some(at)),
            EventKind::RunnerDied { reason, leaked } => {
                self.state = RunState::Died { reason: reason.clone() };
                self.leaked.extend_from_slice(leaked);
            }
            EventKind::ResourcesMeasured { source: Source::Test(test), usage, tests_served } => {
                if let Some(suite) = self.suite_of(Source::Test(*test)) {
                    self.suite(suite, |s| {
                        host::record_usage(&mut s.hosts, *test, *tests_served, *usage)
                    });
                }
            }
            EventKind::CaseStarted(started) => {
                self.start_case_episode(at, started);
                self.apply_to_source(at, &event.kind);
            }
            EventKind::CaseFinished(end) => {
                self.finish_case_episode(at, end);
                self.apply_to_source(at, &event.kind);
            }
            kind if self.apply_plan(kind) || self.apply_to_episode(at, kind) => {}
            kind => self.apply_to_source(at, kind),
        }
    }

    /// Adds what will be run; false for other events.
    fn apply_plan(&mut self, kind: &EventKind) -> bool {
        match kind {
            EventKind::SuitePlanned(plan) => {
                let record = SuiteRecord::new(plan.clone());
                missing_plans::add(&mut self.suites, plan.suite.0, record, missing_plans::suite);
            }
            EventKind::FixturePlanned(plan) => {
                let missing = |index| missing_plans::fixture(index, plan.suite);
                let record = FixtureRecord::new(plan.clone());
                let ids = missing_plans::add(&mut self.fixtures, plan.fixture.0, record, missing);
                self.suite(plan.suite, |s| s.fixtures.extend(ids.map(FixtureId)));
            }
            EventKind::HookPlanned(plan) => {
                let missing = |index| missing_plans::hook(index, plan.suite);
                let record = HookRecord::new(plan.clone());
                let ids = missing_plans::add(&mut self.hooks, plan.hook.0, record, missing);
                self.suite(plan.suite, |s| s.hooks.extend(ids.map(HookId)));
            }
            EventKind::TestPlanned(plan) => {
                let missing = |index| missing_plans::test(index, plan.suite);
                let record = TestRecord::new(plan.clone());
                let ids = missing_plans::add(&mut self.tests, plan.test.0, record, missing);
                self.suite(plan.suite, |s| s.tests.extend(ids.map(TestId)));
            }
            _ => return false,
        }
        true
    }

    /// Records damage of the journal that this is read from.
    pub fn add_damage(&mut self, damage: Damage) {
        if self.damages.len() < Damage::KEPT {
            self.damages.push(damage);
        }
    }

    /// Whether the journal that this was read from is damaged.
    #[must_use]
    pub fn is_damaged(&self) -> bool {
        !self.damages.is_empty()
    }

    fn apply_to_source(&mut self, at: Micros, kind: &EventKind) {
        match source::source_of(kind) {
            Some(Source::Test(id)) => {
                if let Some(test) = self.tests.get_mut(id.index()) {
                    test.apply(at, kind, self.lean, &mut self.passed_cases_kept);
                }
            }
            Some(Source::Fixture(id)) => {
                if let Some(fixture) = self.fixtures.get_mut(id.index()) {
                    fixture.apply(at, kind);
                }
            }
            Some(Source::Hook(id)) => {
                if let Some(hook) = self.hooks.get_mut(id.index()) {
                    hook.apply(at, kind);
                }
            }
            None => {}
        }
    }

    /// The tests of a suite, in the order of the plan.
    fn tests_of(&self, suite: &SuiteRecord) -> impl Iterator<Item = &TestRecord> {
        suite.tests.iter().filter_map(|id| self.tests.get(id.index()))
    }

    fn fixtures_of(&self, suite: &SuiteRecord) -> impl Iterator<Item = &FixtureRecord> {
        suite.fixtures.iter().filter_map(|id| self.fixtures.get(id.index()))
    }

    fn hooks_of(&self, suite: &SuiteRecord) -> impl Iterator<Item = &HookRecord> {
        suite.hooks.iter().filter_map(|id| self.hooks.get(id.index()))
    }

    fn suite(&mut self, id: SuiteId, change: impl FnOnce(&mut SuiteRecord)) {
        if let Some(suite) = self.suites.get_mut(id.index()) {
            change(suite);
        }
    }

    /// Whether the run finished, by itself or by request. A run that
    /// was killed never does.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        matches!(self.state, RunState::Finished { .. })
    }

    /// The signal or request that interrupted the run.
    #[must_use]
    pub fn interrupted(&self) -> Option<&str> {
        match &self.state {
            RunState::Finished { interrupted } => interrupted.as_deref(),
            RunState::Running | RunState::Died { .. } => None,
        }
    }

    /// How the runner ended, when it died.
    #[must_use]
    pub fn runner_death(&self) -> Option<&str> {
        match &self.state {
            RunState::Died { reason } => Some(reason),
            RunState::Running | RunState::Finished { .. } => None,
        }
    }

    /// Whether a hook failed: the robot may not be in a safe state.
    #[must_use]
    pub fn hook_failed(&self) -> bool {
        self.failed_hooks().next().is_some()
    }

    /// The hooks of which at least one run failed.
    pub fn failed_hooks(&self) -> impl Iterator<Item = &HookRecord> {
        self.hooks.iter().filter(|hook| hook.problems().next().is_some())
    }

    /// A test's final verdict. While the run continues, it is `None` for a test that
    /// has not finished; see [`Record::final_verdict`] for a run that has ended.
    #[must_use]
    pub fn verdict(&self, test: TestId) -> Option<Verdict> {
        self.tests.get(test.index()).and_then(TestRecord::verdict)
    }

    /// A test's final verdict in a run that has ended: a test that had started
    /// was interrupted, one that had not was skipped.
    #[must_use]
    pub fn final_verdict(&self, test: TestId) -> Verdict {
        self.tests.get(test.index()).map_or(Verdict::Skipped, TestRecord::final_verdict)
    }

    /// Number of tests by state.
    #[must_use]
    pub fn totals(&self) -> TestTotals {
        totals(self.tests.iter())
    }

    /// Number of tests of a suite by state.
    #[must_use]
    pub fn suite_totals(&self, suite: SuiteId) -> TestTotals {
        totals(self.suites.get(suite.index()).into_iter().flat_map(|suite| self.tests_of(suite)))
    }

    /// Number of tests by final verdict in a run that has ended: none is pending or
    /// running, see [`Record::final_verdict`].
    #[must_use]
    pub fn final_totals(&self) -> TestTotals {
        let mut totals = TestTotals::default();
        for test in &self.tests {
            totals.planned += 1;
            totals.counts[test.final_verdict() as usize] += 1;
        }
        totals
    }

    /// A test's name with its suite's: `arm/EncoderTest`.
    #[must_use]
    pub fn full_name(&self, test: TestId) -> String {
        let Some(test) = self.tests.get(test.index()) else { return format!("test {test}") };
        self.within(test.plan.suite, &test.plan.name)
    }

    /// Whether suites could run in parallel, so that an event may be about
    /// another suite than the previous one.
    #[must_use]
    pub fn runs_suites_in_parallel(&self) -> bool {
        self.run.as_ref().is_some_and(|run| run.manifest.jobs.is_some_and(|jobs| jobs > 1))
    }

    /// The suite that a source belongs to.
    #[must_use]
    pub fn suite_of(&self, source: Source) -> Option<SuiteId> {
        match source {
            Source::Test(id) => self.tests.get(id.index()).map(|test| test.plan.suite),
            Source::Fixture(id) => self.fixture(id).map(|fixture| fixture.plan.suite),
            Source::Hook(id) => self.hooks.get(id.index()).map(|hook| hook.plan.suite),
        }
    }

    /// A fixture's name, with its suite's where suites run in parallel.
    #[must_use]
    pub fn fixture_name(&self, fixture: FixtureId) -> String {
        match self.fixture(fixture) {
            Some(fixture) if self.runs_suites_in_parallel() => {
                self.within(fixture.plan.suite, &fixture.plan.name)
            }
            Some(fixture) => fixture.plan.name.clone(),
            None => "?".to_owned(),
        }
    }

    /// A hook's name with its suite's: `arm/park`.
    #[must_use]
    pub fn full_hook_name(&self, hook: HookId) -> String {
        let Some(hook) = self.hooks.get(hook.index()) else { return format!("hook {hook}") };
        self.within(hook.plan.suite, &hook.plan.name)
    }

    fn within(&self, suite: SuiteId, name: &str) -> String {
        match self.suites.get(suite.index()) {
            Some(suite) => format!("{}/{name}", suite.plan.name),
            None => name.to_owned(),
        }
    }

    /// The fixture with this id.
    #[must_use]
    pub fn fixture(&self, id: FixtureId) -> Option<&FixtureRecord> {
        self.fixtures.get(id.index())
    }
}

fn totals<'a>(tests: impl Iterator<Item = &'a TestRecord>) -> TestTotals {
    let mut totals = TestTotals::default();
    for test in tests {
        totals.planned += 1;
        match test.verdict() {
            Some(verdict) => totals.counts[verdict as usize] += 1,
            None if test.is_running() => totals.running += 1,
            None => totals.pending += 1,
        }
    }
    totals
}
