//! Which fixture or test of a suite is next.
//!
//! After every input, [`SuiteMachine::proceed`] looks at the fixtures and the
//! running test and does the one thing that is due, in this order:
//!
//! 1. The suite ends early (stop request, broken fixture, critical failure,
//!    limit) or has no test left: stop the test, tear down in reverse, skip the rest.
//! 2. A fixture is unwell: interrupt the test, tear down that fixture and all
//!    that were set up after it, in reverse.
//! 3. A fixture is not there: set it up.
//! 4. Ask plug-in fixtures for their `check`, then start the next test.
//!
//! **A collapse interrupts a test in [`SuiteMachine::fixture_changed`].**

use std::time::Duration;

use rtf_model::{EventKind, StopCause, Verdict};

use super::fixture::{Change, FixtureRun, State};
use super::io::{Deadline, Effect, HostId, HostInput, Input, Stop, StopLevel};
use super::test::{Ended, TestRun};
use crate::plan::{AfterCollapse, SuitePlan};

/// What a step of the machine may use: the time, and a list for its effects.
#[derive(Debug)]
pub struct Context<'a> {
    now: Duration,
    out: &'a mut Vec<Effect>,
    hosts: &'a mut u64,
}

impl Context<'_> {
    pub fn out(&mut self, effect: Effect) {
        self.out.push(effect);
    }

    pub fn emit(&mut self, kind: EventKind) {
        self.out.push(Effect::Emit(kind));
    }

    /// Sets a deadline `after` now.
    pub fn set(&mut self, deadline: Deadline, after: Duration) {
        self.out.push(Effect::SetDeadline(deadline, self.now.saturating_add(after)));
    }

    pub fn clear(&mut self, deadline: Deadline) {
        self.out.push(Effect::ClearDeadline(deadline));
    }

    pub fn new_host(&mut self) -> HostId {
        *self.hosts += 1;
        HostId(*self.hosts)
    }
}

/// The test that is next, or runs.
#[derive(Clone, Copy, Debug)]
struct Cursor {
    test: usize,
    repetition: u32,
    attempt: u32,
}

/// The state machine of one suite.
#[derive(Debug)]
pub struct SuiteMachine<'p> {
    plan: &'p SuitePlan,
    fixtures: Vec<FixtureRun<'p>>,
    restarts: Vec<u32>,
    running: Option<TestRun<'p>>,
    cursor: Cursor,
    /// Whether `check` was asked for the test that is next.
    checked: bool,
    /// Why the rest is skipped.
    ending: Option<String>,
    started: bool,
    over: bool,
    hosts: u64,
}

impl<'p> SuiteMachine<'p> {
    /// The machine of a suite that has not started.
    #[must_use]
    pub fn new(plan: &'p SuitePlan) -> Self {
        Self {
            plan,
            fixtures: (0..plan.fixtures.len()).map(|place| FixtureRun::new(plan, place)).collect(),
            restarts: vec![0; plan.fixtures.len()],
            running: None,
            cursor: Cursor { test: 0, repetition: 1, attempt: 1 },
            checked: false,
            ending: None,
            started: false,
            over: false,
            hosts: 0,
        }
    }

    /// Takes in what happened at `now` and appends what is to be done.
    pub fn handle(&mut self, input: Input, now: Duration, out: &mut Vec<Effect>) {
        let mut hosts = self.hosts;
        let mut cx = Context { now, out, hosts: &mut hosts };
        match input {
            Input::Start => self.start(&mut cx),
            Input::Host(host, input) => self.host(host, input, &mut cx),
            Input::Deadline(deadline) => self.deadline(deadline, &mut cx),
            Input::Stop(stop) => self.stop(&stop, &mut cx),
        }
        self.proceed(&mut cx);
        self.hosts = hosts;
    }

    fn start(&mut self, cx: &mut Context<'_>) {
        self.started = true;
        cx.emit(EventKind::SuiteStarted { suite: self.plan.id });
        if let Some(timeout) = self.plan.timeout {
            cx.set(Deadline::Suite, timeout);
        }
    }

    fn host(&mut self, host: HostId, input: HostInput, cx: &mut Context<'_>) {
        if self.running.as_ref().is_some_and(|test| test.host() == host) {
            let ended = self.running.as_mut().and_then(|test| test.handle(input, cx));
            if let Some(ended) = ended {
                self.test_ended(&ended, cx);
            }
        } else if let Some(place) = self.fixtures.iter().position(|f| f.host() == Some(host)) {
            let change = self.fixtures[place].handle(input, cx);
            self.fixture_changed(place, change, cx);
        }
    }

    fn deadline(&mut self, deadline: Deadline, cx: &mut Context<'_>) {
        match deadline {
            Deadline::Suite => {
                let limit = self.plan.timeout.unwrap_or_default();
                let reason = format!("the suite did not end within {limit:?}");
                if let Some(test) = &mut self.running {
                    test.stop(StopCause::Timeout, reason.clone(), cx);
                }
                self.end_early(reason);
            }
            Deadline::Test(timer) => {
                if let Some(test) = &mut self.running {
                    test.deadline(timer, cx);
                }
            }
            Deadline::Fixture(place, timer) => {
                let change = self.fixtures[place].deadline(timer, cx);
                self.fixture_changed(place, change, cx);
            }
        }
    }

    fn stop(&mut self, stop: &Stop, cx: &mut Context<'_>) {
        let reason = format!("stopped by {}", stop.reason);
        if let Some(test) = &mut self.running {
            test.stop(StopCause::Interrupt, reason.clone(), cx);
            if stop.level == StopLevel::Kill {
                test.kill(cx);
            }
        }
        if stop.level == StopLevel::Kill {
            for fixture in self.fixtures.iter_mut().rev() {
                fixture.kill(cx);
            }
        }
        self.end_early(reason);
    }

    fn end_early(&mut self, reason: String) {
        self.ending.get_or_insert(reason);
    }

    /// A fixture's set-up failed, or it collapsed: the running test is
    /// interrupted at once, and the restarts are counted.
    fn fixture_changed(&mut self, place: usize, change: Option<Change>, cx: &mut Context<'_>) {
        let Some(change) = change else { return };
        let fixture = &self.fixtures[place];
        let name = &fixture.plan().name;
        let (collapsed, reason) = match change {
            Change::Collapsed(reason) => (true, reason),
            Change::SetupFailed(reason) => (false, reason),
        };
        if let (true, Some(test)) = (collapsed, &mut self.running) {
            let reason = format!("fixture `{name}` collapsed: {reason}");
            test.stop(StopCause::Collapse, reason, cx);
        }
        let first_setup = !collapsed && fixture.starts() == 1;
        if !first_setup && self.restarts[place] < fixture.plan().restarts {
            self.restarts[place] += 1;
            return;
        }
        if self.ending.is_none() {
            cx.emit(EventKind::FixtureBroken {
                fixture: fixture.plan().id,
                reason: reason.clone(),
            });
            self.ending = Some(format!("fixture `{name}` is broken: {reason}"));
        }
    }

    fn test_ended(&mut self, ended: &Ended, cx: &mut Context<'_>) {
        let Some(run) = self.running.take() else {
            return;
        };
        let plan = &self.plan.tests[self.cursor.test];
        let collapsed = ended.verdict == Verdict::Collapsed;
        let rerun =
            collapsed && plan.after_collapse == AfterCollapse::Rerun && self.ending.is_none();
        let mut finished = run.finished(ended, rerun);
        if let (true, AfterCollapse::Skip, EventKind::TestFinished(finished)) =
            (collapsed, plan.after_collapse, &mut finished)
        {
            finished.verdict = Verdict::Skipped;
        }
        cx.emit(finished);
        if let Some(text) = &ended.critical {
            self.end_early(format!("a critical assertion of `{}` did not hold: {text}", plan.name));
        } else if plan.critical && !ended.verdict.is_green() && !rerun {
            self.end_early(format!("the critical test `{}` is {}", plan.name, ended.verdict));
        }
        self.checked = false;
        self.cursor = match (rerun, self.cursor) {
            (true, cursor) => Cursor { attempt: cursor.attempt + 1, ..cursor },
            (false, Cursor { test, repetition, .. }) if repetition < plan.repetitions => {
                Cursor { test, repetition: repetition + 1, attempt: 1 }
            }
            (false, cursor) => Cursor { test: cursor.test + 1, repetition: 1, attempt: 1 },
        };
    }

    fn proceed(&mut self, cx: &mut Context<'_>) {
        if !self.started || self.over {
            return;
        }
        if self.ending.is_some() || self.cursor.test >= self.plan.tests.len() {
            return self.finish(cx);
        }
        let unwell = self.fixtures.iter().position(|f| f.state() == State::Unwell);
        if let (Some(lowest), None) = (unwell, &self.running) {
            self.stop_from(lowest, cx);
        }
        if self.running.is_some() || self.is_stopping() || self.is_starting() {
            return;
        }
        if let Some(fixture) = self.fixtures.iter_mut().find(|f| f.state() == State::Stopped) {
            self.checked = false;
            return fixture.start(cx);
        }
        self.check_then_test(cx);
    }

    fn is_stopping(&self) -> bool {
        self.fixtures.iter().any(|f| matches!(f.state(), State::Stopping | State::Ending))
    }

    fn is_starting(&self) -> bool {
        self.fixtures.iter().any(|f| f.state() == State::Starting)
    }

    fn check_then_test(&mut self, cx: &mut Context<'_>) {
        if !self.checked {
            self.checked = true;
            for fixture in &mut self.fixtures {
                fixture.ask_check(cx);
            }
        }
        if self.fixtures.iter().any(FixtureRun::is_checking) {
            return;
        }
        let Cursor { test, repetition, attempt } = self.cursor;
        let plan = &self.plan.tests[test];
        self.running = Some(TestRun::start(self.plan, plan, (repetition, attempt), cx));
        let next = if repetition < plan.repetitions { test } else { test + 1 };
        if let Some(next) = self.plan.tests.get(next) {
            cx.out(Effect::SpawnAhead(TestRun::host_start(self.plan, next)));
        }
    }

    /// Tears down the highest fixture from `lowest` on that is still there.
    fn stop_from(&mut self, lowest: usize, cx: &mut Context<'_>) {
        while !self.is_stopping() {
            let there = |fixture: &&mut FixtureRun<'_>| fixture.state() != State::Stopped;
            match self.fixtures[lowest..].iter_mut().rev().find(there) {
                Some(fixture) => fixture.stop(cx),
                None => return,
            }
        }
    }

    fn finish(&mut self, cx: &mut Context<'_>) {
        if let (Some(test), Some(reason)) = (&mut self.running, &self.ending) {
            test.stop(StopCause::Interrupt, reason.clone(), cx);
            return;
        }
        self.stop_from(0, cx);
        if self.fixtures.iter().any(|fixture| fixture.state() != State::Stopped) {
            return;
        }
        let reason = self.ending.clone().unwrap_or_default();
        for plan in &self.plan.tests[self.cursor.test.min(self.plan.tests.len())..] {
            cx.emit(EventKind::TestSkipped { test: plan.id, reason: reason.clone() });
        }
        self.over = true;
        cx.clear(Deadline::Suite);
        cx.emit(EventKind::SuiteFinished { suite: self.plan.id });
        cx.out(Effect::Done);
    }
}
