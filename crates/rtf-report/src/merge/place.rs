//! From the ids of a run to those of the merged run.

use rtf_model::{EventKind, FixtureId, HookId, QuestionAsked, Source, SuiteId, TestId};

use super::attachment_path;
use super::plan::MergedPlan;

/// The ids of one run.
#[derive(Debug)]
pub(super) struct Ids<'a> {
    pub plan: &'a MergedPlan,
    /// The run's place.
    pub part: usize,
}

impl Ids<'_> {
    /// The suites of this run, by their new ids.
    pub fn suites(&self) -> impl Iterator<Item = SuiteId> {
        self.plan.maps[self.part].suites.iter().copied()
    }

    /// Gives an event the new ids; answers to which suite it belongs. The plan's
    /// and the run's own events belong to none.
    pub fn translate(&self, kind: &mut EventKind) -> Option<SuiteId> {
        match kind {
            EventKind::RunStarted(_)
            | EventKind::SuitePlanned(_)
            | EventKind::FixturePlanned(_)
            | EventKind::HookPlanned(_)
            | EventKind::TestPlanned(_)
            | EventKind::Warning { .. }
            | EventKind::RunFinished { .. }
            | EventKind::RunnerDied { .. } => None,
            EventKind::SuiteWaiting { suite, .. }
            | EventKind::SuiteStarted { suite }
            | EventKind::EpisodeFinished { suite, .. }
            | EventKind::SuiteFinished { suite } => Some(self.suite(suite)),
            EventKind::EpisodeStarted(started) => Some(self.suite(&mut started.suite)),
            EventKind::SuitePrepared(prepared) => Some(self.suite(&mut prepared.suite)),
            EventKind::FixtureStarting { fixture, .. }
            | EventKind::FixtureReady { fixture }
            | EventKind::FixtureCollapsed { fixture, .. }
            | EventKind::FixtureStopping { fixture }
            | EventKind::FixtureStopped { fixture, .. }
            | EventKind::FixtureBroken { fixture, .. }
            | EventKind::FixtureReset { fixture, .. } => Some(self.fixture(fixture)),
            EventKind::FixtureProvided(provided) => Some(self.fixture(&mut provided.fixture)),
            EventKind::Message { source, test, .. } => {
                self.about(test);
                Some(self.source(source))
            }
            EventKind::StackDumped { source, .. }
            | EventKind::ResourcesMeasured { source, .. }
            | EventKind::ProcessesLeaked { source, .. } => Some(self.source(source)),
            EventKind::Output(output) => Some(self.source(&mut output.source)),
            EventKind::TestStarted { test, .. }
            | EventKind::TestPhase { test, .. }
            | EventKind::Sampled { test, .. }
            | EventKind::FaultRemoved { test, .. }
            | EventKind::TestSlow { test }
            | EventKind::TestStopping { test, .. }
            | EventKind::TestRepeated { test, .. }
            | EventKind::TestSkipped { test, .. }
            | EventKind::CasesPlanned { test, .. } => Some(self.test(test)),
            EventKind::FaultInjected(fault) => Some(self.test(&mut fault.test)),
            EventKind::CaseStarted(started) => Some(self.test(&mut started.test)),
            EventKind::CaseFinished(end) => Some(self.test(&mut end.test)),
            EventKind::QuestionAsked(asked) => Some(self.question(asked)),
            EventKind::QuestionClosed(closed) => Some(self.test(&mut closed.test)),
            EventKind::TestFinished(finished) => Some(self.test(&mut finished.test)),
            EventKind::Measured { test, fixture, .. } => Some(self.reported(test, fixture)),
            EventKind::Attached { test, fixture, attachment } => {
                self.reporter(fixture);
                self.attached_path(&mut attachment.path);
                Some(self.test(test))
            }
            EventKind::HookStarted { hook, test, .. } => {
                self.about(test);
                Some(self.hook(hook))
            }
            EventKind::HookFinished { hook, .. } => Some(self.hook(hook)),
        }
    }

    // These ids were planned: the order of the run's events was checked.

    fn suite(&self, id: &mut SuiteId) -> SuiteId {
        *id = self.plan.maps[self.part].suites[id.index()];
        *id
    }

    fn fixture(&self, id: &mut FixtureId) -> SuiteId {
        *id = self.plan.maps[self.part].fixtures[id.index()];
        self.plan.fixtures[id.index()].suite
    }

    /// The test that a report or a hook is about. The order of events says nothing of a hook's.
    fn about(&self, test: &mut Option<TestId>) {
        let tests = &self.plan.maps[self.part].tests;
        *test = test.and_then(|test| tests.get(test.index()).copied());
    }

    fn reported(&self, test: &mut TestId, fixture: &mut Option<FixtureId>) -> SuiteId {
        self.reporter(fixture);
        self.test(test)
    }

    /// The fixture that reports about a test.
    fn reporter(&self, fixture: &mut Option<FixtureId>) {
        if let Some(fixture) = fixture {
            self.fixture(fixture);
        }
    }

    fn hook(&self, id: &mut HookId) -> SuiteId {
        *id = self.plan.maps[self.part].hooks[id.index()];
        self.plan.hooks[id.index()].suite
    }

    fn test(&self, id: &mut TestId) -> SuiteId {
        *id = self.plan.maps[self.part].tests[id.index()];
        self.plan.tests[id.index()].suite
    }

    fn question(&self, asked: &mut QuestionAsked) -> SuiteId {
        asked.question.picture.iter_mut().for_each(|picture| self.attached_path(picture));
        self.test(&mut asked.test)
    }

    fn attached_path(&self, path: &mut String) {
        if let Some(merged) = attachment_path(self.part, path) {
            *path = merged;
        }
    }

    fn source(&self, source: &mut Source) -> SuiteId {
        match source {
            Source::Test(id) => self.test(id),
            Source::Fixture(id) => self.fixture(id),
            Source::Hook(id) => self.hook(id),
        }
    }
}
