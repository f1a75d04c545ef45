//! The grammar of an event stream: which event may follow which one.

mod attempts;
mod cases;
mod concurrency;
mod episodes;
mod faults;
mod progress;
mod questions;
mod shared_hosts;

use std::collections::BTreeMap;

use crate::{Event, EventKind, FixtureId, HookId, Phase, Source, SuiteId, TestId};
use concurrency::Concurrency;
use progress::{FixtureProgress, FixtureStage, StreamStage, SuiteStage, TestProgress};
use shared_hosts::TestsServed;

/// An event at an illegal position.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OrderError {
    /// The event's number.
    pub seq: u64,
    /// Which rule it breaks.
    pub rule: String,
}

impl std::fmt::Display for OrderError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "event {}: {}", self.seq, self.rule)
    }
}

impl std::error::Error for OrderError {}

/// Checks a stream event by event. [`OrderChecker::finish`] then checks that
/// everything that started has also finished.
#[derive(Clone, Debug, Default)]
pub struct OrderChecker {
    next_seq: u64,
    last_at: u64,
    stage: StreamStage,
    suites: Vec<SuiteStage>,
    fixtures: Vec<FixtureProgress>,
    hooks: Vec<(SuiteId, bool)>,
    tests: Vec<TestProgress>,
    concurrency: Concurrency,
    tests_served: TestsServed,
    /// The running episode of each suite.
    episodes: BTreeMap<SuiteId, u64>,
}

type Rule = Result<(), String>;

fn ensure(holds: bool, rule: impl FnOnce() -> String) -> Rule {
    if holds { Ok(()) } else { Err(rule()) }
}

impl OrderChecker {
    /// Checks the next event of the stream.
    ///
    /// # Errors
    /// The first rule that the event breaks.
    pub fn check(&mut self, event: &Event) -> Result<(), OrderError> {
        self.check_envelope(event)
            .and_then(|()| self.check_kind(&event.kind))
            .map_err(|rule| OrderError { seq: event.seq, rule })
    }

    /// Checks that the stream is complete.
    ///
    /// # Errors
    /// The stream ends with neither `run-finished` nor `runner-died`.
    pub fn finish(&self) -> Result<(), OrderError> {
        ensure(self.stage == StreamStage::After, || {
            "the stream ends with neither run-finished nor runner-died".into()
        })
        .map_err(|rule| OrderError { seq: self.next_seq, rule })
    }

    fn check_envelope(&mut self, event: &Event) -> Rule {
        ensure(event.seq == self.next_seq, || format!("expected number {}", self.next_seq))?;
        ensure(event.at.0 >= self.last_at, || "time runs backwards".into())?;
        self.next_seq += 1;
        self.last_at = event.at.0;
        let first = matches!(event.kind, EventKind::RunStarted(_));
        ensure(first == (self.stage == StreamStage::Before), || {
            "run-started comes first and only once".into()
        })?;
        ensure(self.stage != StreamStage::After, || {
            "nothing follows run-finished or runner-died".into()
        })
    }

    fn check_kind(&mut self, kind: &EventKind) -> Rule {
        match kind {
            EventKind::RunStarted(_) => self.enter(StreamStage::Planning),
            EventKind::SuitePlanned(plan) => self.plan_suite(plan.suite, plan.parallel),
            EventKind::FixturePlanned(plan) => self.plan_fixture(plan.fixture, plan.suite),
            EventKind::HookPlanned(plan) => self.plan_hook(plan.hook, plan.suite),
            EventKind::TestPlanned(plan) => {
                let repetitions = (!plan.timed).then_some(plan.repetitions);
                self.plan_test(plan.test, plan.suite, repetitions)
            }
            EventKind::Warning { .. } => Ok(()),
            EventKind::SuiteWaiting { suite, .. } => self.wait(*suite),
            EventKind::SuiteStarted { suite } => self.start_suite(*suite),
            EventKind::SuitePrepared(prepared) => self.prepare(prepared.suite),
            EventKind::FixtureStarting { .. }
            | EventKind::FixtureProvided(_)
            | EventKind::FixtureReady { .. }
            | EventKind::FixtureCollapsed { .. }
            | EventKind::FixtureStopping { .. }
            | EventKind::FixtureStopped { .. }
            | EventKind::FixtureReset { .. }
            | EventKind::FixtureBroken { .. } => self.check_fixture(kind),
            EventKind::EpisodeStarted(started) => self.start_episode(started),
            EventKind::EpisodeFinished { suite, episode } => self.finish_episode(*suite, *episode),
            EventKind::TestStarted { test, repetition, attempt } => {
                self.start_test(*test, (*repetition, *attempt))
            }
            EventKind::TestPhase { test, phase: Phase::Notify } => self.judge_test(*test),
            EventKind::CasesPlanned { .. }
            | EventKind::CaseStarted(_)
            | EventKind::CaseFinished(_)
            | EventKind::Sampled { .. }
            | EventKind::Measured { .. }
            | EventKind::Attached { .. }
            | EventKind::QuestionAsked(_)
            | EventKind::QuestionClosed(_)
            | EventKind::FaultInjected(_)
            | EventKind::FaultRemoved { .. }
            | EventKind::Message { .. } => self.check_report(kind),
            EventKind::TestPhase { test, .. }
            | EventKind::TestSlow { test }
            | EventKind::TestStopping { test, .. } => self.inside_test(*test),
            EventKind::StackDumped { source, .. } | EventKind::ProcessesLeaked { source, .. } => {
                self.inside(*source)
            }
            EventKind::ResourcesMeasured { source, tests_served, .. } => {
                self.resources_measured(*source, *tests_served)
            }
            EventKind::Output(output) => self.inside(output.source),
            EventKind::TestFinished(finished) => self.finish_test(finished.test, finished.rerun),
            EventKind::TestSkipped { test, .. } => self.skip_test(*test),
            EventKind::TestRepeated { test, repetitions } => self.end_test(*test, *repetitions),
            EventKind::HookStarted { hook, .. } => self.toggle_hook(*hook, true),
            EventKind::HookFinished { hook, .. } => self.toggle_hook(*hook, false),
            EventKind::SuiteFinished { suite } => self.finish_suite(*suite),
            EventKind::RunnerDied { .. } => self.enter(StreamStage::After),
            EventKind::RunFinished { .. } => self.finish_run(),
        }
    }

    fn enter(&mut self, stage: StreamStage) -> Rule {
        self.stage = stage;
        Ok(())
    }

    fn check_report(&mut self, kind: &EventKind) -> Rule {
        match kind {
            EventKind::CasesPlanned { test, .. } => self.before_verdict(*test),
            EventKind::CaseStarted(started) => self.start_case(started),
            EventKind::CaseFinished(end) => self.finish_case(end),
            EventKind::QuestionAsked(asked) => self.ask(asked),
            EventKind::QuestionClosed(closed) => self.close_question(closed),
            EventKind::Sampled { test, samples } => {
                self.inside_test(*test)?;
                self.inside_case(*test, samples.case)
            }
            EventKind::Measured { test, fixture, measurement } => {
                self.inside_both(fixture.map(Source::Fixture), Source::Test(*test))?;
                self.inside_case(*test, measurement.case)
            }
            EventKind::FaultInjected(fault) => self.inject_fault(fault),
            EventKind::FaultRemoved { test, name } => self.remove_fault(*test, name),
            EventKind::Attached { test, fixture, attachment } => {
                self.inside_both(fixture.map(Source::Fixture), Source::Test(*test))?;
                self.inside_case(*test, attachment.case)
            }
            EventKind::Message { source, test, message } => {
                self.inside_both(test.map(Source::Test), *source)?;
                match source {
                    Source::Test(id) => self.inside_case(*id, message.case),
                    Source::Fixture(_) | Source::Hook(_) => Ok(()),
                }
            }
            _ => Ok(()),
        }
    }

    fn check_fixture(&mut self, kind: &EventKind) -> Rule {
        use FixtureStage::{Collapsed, Ready, Starting, Stopped, Stopping};
        match kind {
            EventKind::FixtureStarting { fixture, attempt } => self.start(*fixture, *attempt),
            EventKind::FixtureProvided(provided) => self.provide(provided.fixture, &provided.name),
            EventKind::FixtureReady { fixture } => self.advance(*fixture, &[Starting], Ready),
            EventKind::FixtureCollapsed { fixture, .. } => {
                self.advance(*fixture, &[Ready], Collapsed)
            }
            EventKind::FixtureStopping { fixture } => {
                self.advance(*fixture, &[Starting, Ready, Collapsed], Stopping)
            }
            EventKind::FixtureStopped { fixture, .. } => {
                self.advance(*fixture, &[Stopping], Stopped)
            }
            EventKind::FixtureReset { fixture, .. } => self.advance(*fixture, &[Ready], Ready),
            EventKind::FixtureBroken { fixture, .. } => self.break_fixture(*fixture),
            _ => Ok(()),
        }
    }

    fn plan_suite(&mut self, suite: SuiteId, parallel: u32) -> Rule {
        ensure(self.stage == StreamStage::Planning, || {
            "plans precede the start of the first suite".into()
        })?;
        ensure(suite.index() == self.suites.len(), || format!("suite {suite} out of order"))?;
        self.suites.push(SuiteStage::Planned);
        self.concurrency.plan(parallel);
        Ok(())
    }

    fn is_current_suite(&self, suite: SuiteId) -> Rule {
        ensure(self.stage == StreamStage::Planning, || {
            "plans precede the start of the first suite".into()
        })?;
        ensure(suite.index() + 1 == self.suites.len(), || {
            format!("suite {suite} is not the one planned last")
        })
    }

    fn plan_fixture(&mut self, fixture: FixtureId, suite: SuiteId) -> Rule {
        self.is_current_suite(suite)?;
        ensure(fixture.index() == self.fixtures.len(), || {
            format!("fixture {fixture} out of order")
        })?;
        self.fixtures.push(FixtureProgress { suite, ..FixtureProgress::default() });
        Ok(())
    }

    fn plan_test(&mut self, test: TestId, suite: SuiteId, repetitions: Option<u32>) -> Rule {
        self.is_current_suite(suite)?;
        ensure(test.index() == self.tests.len(), || format!("test {test} out of order"))?;
        self.tests.push(TestProgress { suite, repetitions, ..TestProgress::default() });
        Ok(())
    }

    fn plan_hook(&mut self, hook: HookId, suite: SuiteId) -> Rule {
        self.is_current_suite(suite)?;
        ensure(hook.index() == self.hooks.len(), || format!("hook {hook} out of order"))?;
        self.hooks.push((suite, false));
        Ok(())
    }

    fn toggle_hook(&mut self, hook: HookId, open: bool) -> Rule {
        let known = self.hooks.get(hook.index()).copied();
        let (suite, was_open) = known.ok_or_else(|| format!("hook {hook} was not planned"))?;
        self.suite_open(suite)?;
        ensure(was_open != open, || format!("hook {hook} started or finished twice"))?;
        self.hooks[hook.index()].1 = open;
        self.concurrency.hook_running(suite.index(), open);
        Ok(())
    }

    fn wait(&self, suite: SuiteId) -> Rule {
        ensure(self.suites.get(suite.index()) == Some(&SuiteStage::Planned), || {
            format!("suite {suite} waits, but was not planned, or has begun")
        })
    }

    fn start_suite(&mut self, suite: SuiteId) -> Rule {
        self.stage = StreamStage::Running;
        let bracket = self.suites.get_mut(suite.index());
        ensure(bracket.as_deref() == Some(&SuiteStage::Planned), || {
            format!("suite {suite} was not planned, or started twice")
        })?;
        if let Some(bracket) = bracket {
            *bracket = SuiteStage::Fresh;
        }
        Ok(())
    }

    fn prepare(&mut self, suite: SuiteId) -> Rule {
        ensure(self.suites.get(suite.index()) == Some(&SuiteStage::Fresh), || {
            format!("suite {suite} is prepared once, before anything else of it")
        })?;
        self.suite_open(suite)
    }

    fn suite_open(&mut self, suite: SuiteId) -> Rule {
        match self.suites.get_mut(suite.index()) {
            Some(bracket @ (SuiteStage::Fresh | SuiteStage::Open)) => {
                *bracket = SuiteStage::Open;
                Ok(())
            }
            _ => Err(format!("suite {suite} is not running")),
        }
    }

    fn fixture(&mut self, fixture: FixtureId) -> Result<&mut FixtureProgress, String> {
        let suite = self.fixtures.get(fixture.index()).map(|f| f.suite);
        let suite = suite.ok_or_else(|| format!("fixture {fixture} was not planned"))?;
        self.suite_open(suite)?;
        Ok(&mut self.fixtures[fixture.index()])
    }

    fn start(&mut self, id: FixtureId, attempt: u32) -> Rule {
        let fixture = self.fixture(id)?;
        ensure(fixture.stage == FixtureStage::Stopped, || format!("fixture {id} started twice"))?;
        ensure(!fixture.broken, || format!("fixture {id} started although broken"))?;
        ensure(attempt == fixture.attempt + 1, || format!("fixture {id}: attempt out of order"))?;
        fixture.attempt = attempt;
        fixture.stage = FixtureStage::Starting;
        fixture.provided.clear();
        Ok(())
    }

    fn advance(&mut self, id: FixtureId, from: &[FixtureStage], to: FixtureStage) -> Rule {
        let fixture = self.fixture(id)?;
        let stage = fixture.stage;
        ensure(from.contains(&stage), || format!("fixture {id} goes from {stage:?} to {to:?}"))?;
        fixture.stage = to;
        Ok(())
    }

    fn provide(&mut self, id: FixtureId, name: &str) -> Rule {
        let fixture = self.fixture(id)?;
        let is_starting = fixture.stage == FixtureStage::Starting;
        ensure(is_starting, || format!("fixture {id} is not being set up"))?;
        let is_new = fixture.provided.insert(name.to_owned());
        ensure(is_new, || format!("fixture {id} provided `{name}` twice"))
    }

    fn break_fixture(&mut self, id: FixtureId) -> Rule {
        let fixture = self.fixture(id)?;
        ensure(!fixture.broken, || format!("fixture {id} broke twice"))?;
        fixture.broken = true;
        Ok(())
    }

    fn inside_test(&mut self, id: TestId) -> Rule {
        let open = self.test(id)?.open;
        ensure(open, || format!("test {id} is not running"))
    }

    /// A fixture reports about a test only while both run.
    fn inside_both(&mut self, first: Option<Source>, second: Source) -> Rule {
        first.map_or(Ok(()), |first| self.inside(first))?;
        self.inside(second)
    }

    fn inside(&mut self, source: Source) -> Rule {
        match source {
            Source::Test(test) => self.inside_test(test),
            Source::Hook(hook) => {
                let open = self.hooks.get(hook.index()).is_some_and(|(_, open)| *open);
                ensure(open, || format!("hook {hook} is not running"))
            }
            Source::Fixture(id) => {
                let stage = self.fixture(id)?.stage;
                ensure(stage != FixtureStage::Stopped, || format!("fixture {id} is not running"))
            }
        }
    }

    fn resources_measured(&mut self, source: Source, tests_served: Option<u32>) -> Rule {
        self.inside(source)?;
        match (source, tests_served) {
            (Source::Fixture(_), None) => Ok(()),
            (Source::Test(test), Some(tests_served)) => {
                let suite = self.test(test)?.suite;
                self.tests_served.record(suite, tests_served)
            }
            _ => Err("only a shared host reports how many tests it has served".into()),
        }
    }

    fn finish_suite(&mut self, suite: SuiteId) -> Rule {
        self.suite_open(suite)?;
        for (index, test) in self.tests.iter().enumerate().filter(|(_, t)| t.suite == suite) {
            ensure(!test.open, || format!("test {index} still runs"))?;
            ensure(test.is_decided(), || format!("test {index} has no verdict"))?;
        }
        for (index, fixture) in self.fixtures.iter().enumerate().filter(|(_, f)| f.suite == suite) {
            let stopped = fixture.stage == FixtureStage::Stopped;
            ensure(stopped, || format!("fixture {index} still runs"))?;
        }
        for (index, (_, open)) in self.hooks.iter().enumerate().filter(|(_, h)| h.0 == suite) {
            ensure(!open, || format!("hook {index} still runs"))?;
        }
        self.suites[suite.index()] = SuiteStage::Closed;
        Ok(())
    }

    fn finish_run(&mut self) -> Rule {
        for (index, bracket) in self.suites.iter().enumerate() {
            ensure(*bracket == SuiteStage::Closed, || format!("suite {index} did not finish"))?;
        }
        self.stage = StreamStage::After;
        self.concurrency.violation().map_or(Ok(()), |rule| Err(rule.clone()))
    }
}
