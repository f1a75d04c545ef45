//! What is known of a run: the fold over its events.
//!
//! [`Record::apply`] is the only place that counts. The console's summary, the
//! JUnit file and every other report read a `Record`; none keeps a state of its own.

mod counts;
mod fixture;
mod gap;
mod hook;
mod host;
mod leaked;
mod series;
pub(crate) mod source;
mod suite;
mod test;

pub use counts::Counts;
pub use fixture::{FixtureLife, FixtureRecord, FixtureState};
pub(crate) use gap::is_likely as is_likely_gap;
pub use hook::{HookRecord, HookRun};
pub use host::HostRecord;
pub use series::Series;
pub use suite::SuiteRecord;
pub use test::{AttemptRecord, TestRecord};

use crate::{
    Damage, Diagnostic, Event, EventKind, FixtureId, HookId, Micros, RunStarted, Source, SuiteId,
    TestId, Verdict,
};

/// How far a run is.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum RunState {
    /// No `run-finished` was seen: the run goes on, or it was killed.
    #[default]
    Running,
    /// The run came to its end.
    Finished {
        /// The signal or request that cut it short, in words.
        interrupted: Option<String>,
    },
    /// The runner died; the guard stopped what was left. The record is incomplete.
    Died {
        /// How the runner ended.
        reason: String,
    },
}

/// How many tests are in which state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    /// Tests that were declared.
    pub planned: u32,
    /// Tests whose last word is not spoken yet and that do not run.
    pub pending: u32,
    /// Tests that run now.
    pub running: u32,
    counts: [u32; Verdict::ALL.len()],
}

impl Totals {
    /// How many tests ended with this verdict.
    #[must_use]
    pub fn of(&self, verdict: Verdict) -> u32 {
        self.counts[verdict as usize]
    }

    /// How many tests have their last word.
    #[must_use]
    pub fn done(&self) -> u32 {
        self.counts.iter().sum()
    }
}

/// Everything that reports need to know of a run.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// The first event, once it was seen.
    pub run: Option<RunStarted>,
    /// Whether the run came to its end.
    pub state: RunState,
    /// When the last event happened.
    pub last_at: Micros,
    /// How many events were applied.
    pub events: u64,
    /// The suites, by their ids.
    pub suites: Vec<SuiteRecord>,
    /// The fixtures, by their ids.
    pub fixtures: Vec<FixtureRecord>,
    /// The hooks, by their ids.
    pub hooks: Vec<HookRecord>,
    /// The tests, by their ids.
    pub tests: Vec<TestRecord>,
    /// What was left at the end and had to be killed, when the runner died.
    pub leaked: Vec<crate::LeakedProcess>,
    /// What the user should look at.
    pub warnings: Vec<Diagnostic>,
    /// Where the journal that this was read from is damaged, up to
    /// [`Damage::KEPT`] places. What it says of the run cannot be trusted.
    pub damages: Vec<Damage>,
    lean: bool,
}

impl Record {
    /// A record that counts what tests report, print, measure and attach, and
    /// keeps none of it: for those who keep the journal at hand.
    #[must_use]
    pub fn lean() -> Self {
        Self { lean: true, ..Self::default() }
    }

    /// Takes in the next event. An event about something that was never
    /// planned is ignored: [`crate::OrderChecker`] is there to complain.
    pub fn apply(&mut self, event: &Event) {
        self.last_at = event.at;
        self.events += 1;
        let at = event.at;
        match &event.kind {
            EventKind::RunStarted(run) => self.run = Some(run.clone()),
            EventKind::Warning { diagnostic } => self.warnings.push(diagnostic.clone()),
            EventKind::RunFinished { interrupted } => {
                self.state = RunState::Finished { interrupted: interrupted.clone() };
            }
            EventKind::SuitePlanned(plan) => {
                if gap::fill(&mut self.suites, plan.suite.index(), gap::suite) {
                    self.suites.push(SuiteRecord::new(plan.clone()));
                }
            }
            EventKind::SuiteStarted { suite } => self.suite(*suite, |s| s.started = Some(at)),
            EventKind::SuitePrepared(prepared) => {
                self.suite(prepared.suite, |s| s.prepared = Some(prepared.clone()));
            }
            EventKind::SuiteFinished { suite } => self.suite(*suite, |s| s.finished = Some(at)),
            EventKind::FixturePlanned(plan) => {
                let missing = |index| gap::fixture(index, plan.suite);
                let known = self.fixtures.len() as u32;
                if gap::fill(&mut self.fixtures, plan.fixture.index(), missing) {
                    let ids = (known..=plan.fixture.0).map(FixtureId);
                    self.suite(plan.suite, |s| s.fixtures.extend(ids));
                    self.fixtures.push(FixtureRecord::new(plan.clone()));
                }
            }
            EventKind::RunnerDied { reason, leaked } => {
                self.state = RunState::Died { reason: reason.clone() };
                self.leaked.extend_from_slice(leaked);
            }
            EventKind::HookPlanned(plan) => {
                let missing = |index| gap::hook(index, plan.suite);
                let known = self.hooks.len() as u32;
                if gap::fill(&mut self.hooks, plan.hook.index(), missing) {
                    let ids = (known..=plan.hook.0).map(HookId);
                    self.suite(plan.suite, |s| s.hooks.extend(ids));
                    self.hooks.push(HookRecord::new(plan.clone()));
                }
            }
            EventKind::TestPlanned(plan) => {
                let missing = |index| gap::test(index, plan.suite);
                let known = self.tests.len() as u32;
                if gap::fill(&mut self.tests, plan.test.index(), missing) {
                    let ids = (known..=plan.test.0).map(TestId);
                    self.suite(plan.suite, |s| s.tests.extend(ids));
                    self.tests.push(TestRecord::new(plan.clone()));
                }
            }
            EventKind::ResourcesMeasured { source: Source::Test(test), usage, tests_served } => {
                if let Some(suite) = self.suite_of(Source::Test(*test)) {
                    self.suite(suite, |s| host::uses(&mut s.hosts, *test, *tests_served, *usage));
                }
            }
            kind => self.apply_to_source(at, kind),
        }
    }

    /// The journal that this is read from is damaged.
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
        match source::of(kind) {
            Some(Source::Test(id)) => {
                if let Some(test) = self.tests.get_mut(id.index()) {
                    test.apply(at, kind, self.lean);
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

    fn suite(&mut self, id: SuiteId, change: impl FnOnce(&mut SuiteRecord)) {
        if let Some(suite) = self.suites.get_mut(id.index()) {
            change(suite);
        }
    }

    /// Whether the run came to its end, by itself or by request. A run that
    /// was killed never does.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        matches!(self.state, RunState::Finished { .. })
    }

    /// The signal or request that cut the run short.
    #[must_use]
    pub fn interrupted(&self) -> Option<&str> {
        match &self.state {
            RunState::Finished { interrupted } => interrupted.as_deref(),
            RunState::Running | RunState::Died { .. } => None,
        }
    }

    /// How the runner ended, when it died.
    #[must_use]
    pub fn died(&self) -> Option<&str> {
        match &self.state {
            RunState::Died { reason } => Some(reason),
            RunState::Running | RunState::Finished { .. } => None,
        }
    }

    /// Whether a hook did not do its work: the robot may not be in a safe state.
    #[must_use]
    pub fn hook_failed(&self) -> bool {
        self.failed_hooks().next().is_some()
    }

    /// The hooks of which a run did not do its work.
    pub fn failed_hooks(&self) -> impl Iterator<Item = &HookRecord> {
        self.hooks.iter().filter(|hook| hook.problems().next().is_some())
    }

    /// A test's last word. While the run goes on it is `None` for a test that
    /// is not over; see [`Record::final_verdict`] for a run that will not go on.
    #[must_use]
    pub fn verdict(&self, test: TestId) -> Option<Verdict> {
        self.tests.get(test.index()).and_then(TestRecord::verdict)
    }

    /// A test's last word in a run that will not go on: a test that had begun
    /// was interrupted, one that had not was skipped.
    #[must_use]
    pub fn final_verdict(&self, test: TestId) -> Verdict {
        self.tests.get(test.index()).map_or(Verdict::Skipped, TestRecord::final_verdict)
    }

    /// How many tests are in which state.
    #[must_use]
    pub fn totals(&self) -> Totals {
        totals(self.tests.iter())
    }

    /// How many tests of a suite are in which state.
    #[must_use]
    pub fn suite_totals(&self, suite: SuiteId) -> Totals {
        let tests = self.suites.get(suite.index()).map_or(&[][..], |s| &s.tests);
        totals(tests.iter().filter_map(|id| self.tests.get(id.index())))
    }

    /// How the tests ended in a run that will not go on: none is pending or
    /// runs, see [`Record::final_verdict`].
    #[must_use]
    pub fn final_totals(&self) -> Totals {
        let mut totals = Totals::default();
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

    /// Whether suites could run side by side, so that an event may be about
    /// another suite than the one before.
    #[must_use]
    pub fn is_side_by_side(&self) -> bool {
        self.run.as_ref().is_some_and(|run| run.manifest.jobs.is_some_and(|jobs| jobs > 1))
    }

    /// Whose suite it is.
    #[must_use]
    pub fn suite_of(&self, source: Source) -> Option<SuiteId> {
        match source {
            Source::Test(id) => self.tests.get(id.index()).map(|test| test.plan.suite),
            Source::Fixture(id) => self.fixture(id).map(|fixture| fixture.plan.suite),
            Source::Hook(id) => self.hooks.get(id.index()).map(|hook| hook.plan.suite),
        }
    }

    /// A fixture's name, with its suite's where suites run side by side.
    #[must_use]
    pub fn fixture_name(&self, fixture: FixtureId) -> String {
        match self.fixture(fixture) {
            Some(fixture) if self.is_side_by_side() => {
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

    /// What went wrong in a suite beside its tests, in words: fixtures that
    /// collapsed, broke, or could not be torn down, and hooks that failed.
    #[must_use]
    pub fn suite_problems(&self, suite: SuiteId) -> Vec<String> {
        let mut problems = self.fixture_problems(suite);
        let hooks = self.suites.get(suite.index()).map_or(&[][..], |s| &s.hooks);
        let hooks = hooks.iter().filter_map(|id| self.hooks.get(id.index()));
        problems.extend(hooks.flat_map(HookRecord::problems));
        problems
    }

    /// What went wrong with the fixtures of a suite, in words.
    #[must_use]
    pub fn fixture_problems(&self, suite: SuiteId) -> Vec<String> {
        let Some(suite) = self.suites.get(suite.index()) else { return Vec::new() };
        let tolerant = suite.plan.tolerates_collapse;
        let fixtures = suite.fixtures.iter().filter_map(|id| self.fixtures.get(id.index()));
        fixtures.flat_map(|fixture| fixture.problems(tolerant)).collect()
    }

    /// Whether nothing at all speaks against the robot or the bench: the run
    /// came to its end, has tests, each of them passed, no fixture or hook failed,
    /// and what is known of it comes from a journal without damage.
    #[must_use]
    pub fn is_green(&self) -> bool {
        !self.is_damaged()
            && self.state == RunState::Finished { interrupted: None }
            && !self.tests.is_empty()
            && self.tests.iter().all(|test| test.verdict().is_some_and(Verdict::is_green))
            && !(self.flaky_fails() && self.tests.iter().any(TestRecord::is_flaky))
            && self.suites.iter().all(|s| self.suite_problems(s.plan.suite).is_empty())
    }

    /// Whether a test that passed only when it was tried again counts as failed.
    #[must_use]
    pub fn flaky_fails(&self) -> bool {
        self.run.as_ref().is_some_and(|run| run.manifest.flaky_fails)
    }

    /// The fixture with this id.
    #[must_use]
    pub fn fixture(&self, id: FixtureId) -> Option<&FixtureRecord> {
        self.fixtures.get(id.index())
    }
}

fn totals<'a>(tests: impl Iterator<Item = &'a TestRecord>) -> Totals {
    let mut totals = Totals::default();
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
