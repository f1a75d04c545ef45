//! What is next in a suite.
//!
//! After every input, [`SuiteMachine::proceed`] looks at the fixtures, hooks and
//! the running test and does what is due, in this order:
//!
//! 1. A test runs: it is left alone, unless the suite ends early.
//! 2. A hook runs, or was called for: nothing else is begun.
//! 3. The suite ends early (stop request, broken fixture, critical failure,
//!    limit) or has no test left: `end` hooks, tear down in reverse, skip the rest.
//! 4. A fixture is unwell: tear down that fixture and all that depend on it.
//! 5. A fixture is not there: set it up.
//! 6. Ask plug-in fixtures for their `check`, then start the next test.
//!
//! How it is ended early is in [`ending`], how a test that failed is tried again in
//! [`retries`].
//!
//! **A collapse interrupts a test in [`SuiteMachine::fixture_changed`].**

mod cursor;
mod ending;
mod looking;
mod retries;

use std::time::Duration;

use rtf_model::{EventKind, Phase, StopCause, TestFinished, TestId, Trigger, Verdict};

use super::fixture::Change;
use super::fixtures::Fixtures;
use super::hooks::Hooks;
use super::io::{Deadline, Effect, HostId, HostInput, Input, Start};
use super::test::{Ended, TestRun};
use crate::plan::{AfterCollapse, Given, SuitePlan};
use crate::run::FailLimit;
use cursor::Cursor;

/// What a step of the machine may use: the time, and a list for its effects.
#[derive(Debug)]
pub struct Context<'a> {
    now: Duration,
    out: &'a mut Vec<Effect>,
    hosts: &'a mut u64,
}

impl Context<'_> {
    pub fn now(&self) -> Duration {
        self.now
    }

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

/// How many hosts are started ahead of their need. Starting one takes longer than
/// a short test; two keep a second core busy.
const HOSTS_AHEAD: usize = 2;

/// The state machine of one suite.
#[derive(Debug)]
pub struct SuiteMachine<'p> {
    plan: &'p SuitePlan,
    fixtures: Fixtures<'p>,
    hooks: Hooks<'p>,
    running: Option<TestRun<'p>>,
    /// The fixtures' processes that were not seen to live since the test ended.
    unseen: Vec<HostId>,
    cursor: Cursor,
    /// Whether `check` was asked for the test that is next.
    checked: bool,
    /// Whether the next attempt of a test that failed is not due yet.
    waiting: bool,
    /// Why no more repetitions of the running test follow.
    given_up: Option<String>,
    /// Why the rest is skipped.
    ending: Option<String>,
    /// How many tests of the run have failed, and may.
    fails: FailLimit,
    /// When the run was asked to end: how long that may take, and who asked.
    shutdown: Option<(Duration, String)>,
    /// Whether the `end` hooks were called for.
    end_called: bool,
    started: bool,
    over: bool,
    hosts: u64,
}

impl<'p> SuiteMachine<'p> {
    /// The machine of a suite that has not started, in a run in which so many
    /// tests have failed until now.
    #[must_use]
    pub fn new(plan: &'p SuitePlan, fails: FailLimit) -> Self {
        Self {
            plan,
            ending: fails.reached(),
            fails,
            fixtures: Fixtures::new(plan),
            hooks: Hooks::new(plan),
            running: None,
            unseen: Vec::new(),
            cursor: Cursor::at(0),
            waiting: false,
            checked: false,
            given_up: None,
            shutdown: None,
            end_called: false,
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
            Input::Stop(stop) => self.stop(stop, &mut cx),
            Input::StopTest(test, by) => self.stop_test(test, &by, &mut cx),
            Input::Skip(by) => self.skip(&by, &mut cx),
        }
        if let Some(ended) = self.running.as_mut().and_then(|test| test.take_end(&mut cx)) {
            self.test_ended(&ended, &mut cx);
        }
        self.proceed(&mut cx);
        self.hosts = hosts;
    }

    fn start(&mut self, cx: &mut Context<'_>) {
        self.started = true;
        cx.emit(EventKind::SuiteStarted { suite: self.plan.id });
        match &self.plan.given {
            Given::Refused(reason) if self.ending.is_none() => return self.refuse(reason, cx),
            Given::Nothing | Given::Refused(_) => {}
            Given::All(prepared) => cx.emit(EventKind::SuitePrepared(prepared.clone())),
        }
        if let Some(timeout) = self.plan.timeout {
            cx.set(Deadline::Suite, timeout);
        }
    }

    /// The suite cannot have what it needs: nothing of it is started, and that
    /// is an error of each of its tests.
    fn refuse(&mut self, reason: &str, cx: &mut Context<'_>) {
        for plan in &self.plan.tests {
            cx.emit(EventKind::TestStarted { test: plan.id, repetition: 1, attempt: 1 });
            cx.emit(EventKind::TestFinished(TestFinished {
                test: plan.id,
                verdict: Verdict::Error,
                reason: Some(reason.to_owned()),
                phase: Phase::Load,
                exit: None,
                rerun: false,
            }));
            if plan.repetitions > 1 {
                cx.emit(EventKind::TestSkipped { test: plan.id, reason: reason.to_owned() });
            }
        }
        self.cursor.test = self.plan.tests.len();
        self.end_called = true;
    }

    fn host(&mut self, host: HostId, input: HostInput, cx: &mut Context<'_>) {
        if self.running.as_ref().is_some_and(|test| test.host() == host) {
            if let Some(test) = &mut self.running {
                test.handle(input, cx);
            }
            self.look_alive(cx);
        } else if let Some(place) = self.fixtures.place_of(host) {
            if matches!(input, HostInput::Lives) {
                self.seen_alive(host);
            }
            let change = self.fixtures.get(place).handle(input, cx);
            self.fixture_changed(place, change, cx);
        } else if self.hooks.owns(host) {
            self.hooks.handle(input, cx);
        }
    }

    fn deadline(&mut self, deadline: Deadline, cx: &mut Context<'_>) {
        match deadline {
            Deadline::Suite => self.limit_reached(cx),
            Deadline::Retry => self.waiting = false,
            Deadline::Shutdown => self.shutdown_took_too_long(cx),
            Deadline::Test(timer) => {
                if let Some(test) = &mut self.running {
                    test.deadline(timer, cx);
                }
            }
            Deadline::Fixture(place, timer) => {
                let change = self.fixtures.get(place).deadline(timer, cx);
                self.fixture_changed(place, change, cx);
            }
            Deadline::Hook => self.hooks.deadline(cx),
        }
    }

    fn running_test(&self) -> Option<(TestId, String)> {
        self.running.as_ref()?;
        let plan = self.plan.tests.get(self.cursor.test)?;
        Some((plan.id, plan.name.clone()))
    }

    /// A fixture's set-up failed, or it collapsed: the running test is
    /// interrupted at once, and the restarts are counted.
    fn fixture_changed(&mut self, place: usize, change: Option<Change>, cx: &mut Context<'_>) {
        let Some(change) = change else { return };
        let fixture = self.fixtures.get(place);
        let (id, name, first) = (fixture.plan().id, &fixture.plan().name, fixture.starts() == 1);
        let (collapsed, reason) = match change {
            Change::Collapsed(reason) => (true, reason),
            Change::SetupFailed(reason) => (false, reason),
        };
        let test = self.running_test();
        if collapsed {
            let reason = format!("fixture `{name}` collapsed: {reason}");
            self.hooks.call(Trigger::Collapse, &reason, test.clone());
            if let Some(test) = &mut self.running {
                test.stop(StopCause::Collapse, reason, cx);
            }
        }
        let again = (collapsed || !first) && self.fixtures.take_restart(place);
        if !again && self.ending.is_none() {
            cx.emit(EventKind::FixtureBroken { fixture: id, reason: reason.clone() });
            let reason = format!("fixture `{name}` is broken: {reason}");
            self.hooks.call(Trigger::FixtureBroken, &reason, test);
            self.ending = Some(reason);
        }
    }

    fn test_ended(&mut self, ended: &Ended, cx: &mut Context<'_>) {
        let about = self.running_test();
        let Some(run) = self.running.take() else { return };
        let plan = &self.plan.tests[self.cursor.test];
        let collapsed = ended.verdict == Verdict::Collapsed;
        let rerun = collapsed
            && plan.after_collapse == AfterCollapse::Rerun
            && self.ending.is_none()
            && self.given_up.is_none();
        let retry = self.is_retried(ended);
        let rerun = rerun || retry;
        let mut finished = run.finished(ended, rerun);
        if let (true, AfterCollapse::Skip, EventKind::TestFinished(finished)) =
            (collapsed, plan.after_collapse, &mut finished)
        {
            finished.verdict = Verdict::Skipped;
        }
        if let EventKind::TestFinished(finished) = &finished {
            self.fails.count(finished);
        }
        cx.emit(finished);
        let trigger = match ended.verdict {
            Verdict::Failed | Verdict::Error | Verdict::Crashed => Some(Trigger::Failure),
            Verdict::TimedOut => Some(Trigger::Timeout),
            _ => None,
        };
        if let Some(trigger) = trigger {
            let reason = ended.reason.as_deref().unwrap_or_default();
            self.hooks.call(
                trigger,
                &format!("`{}` is {}: {reason}", plan.name, ended.verdict),
                about,
            );
        }
        if let Some(text) = &ended.critical {
            self.end_early(format!("a critical assertion of `{}` did not hold: {text}", plan.name));
        } else if plan.critical && !ended.verdict.is_green() && !rerun {
            self.end_early(format!(
                "the critical test `{}` did not pass: it is {}",
                plan.name, ended.verdict
            ));
        }
        self.checked = false;
        self.cursor = self.cursor.next(rerun, plan.repetitions);
        if retry {
            self.retry(plan.retries.delay, cx);
        }
        self.give_up_repetitions(cx);
    }

    fn proceed(&mut self, cx: &mut Context<'_>) {
        if !self.started || self.over {
            return;
        }
        if let Some(test) = &mut self.running {
            if let Some(reason) = &self.ending {
                test.stop(StopCause::Interrupt, reason.clone(), cx);
            }
            return;
        }
        // Tests of other suites may have failed meanwhile.
        if let Some(reason) = self.fails.reached() {
            self.end_early(reason);
        }
        if self.hooks.run_next(cx) {
            return;
        }
        if self.ending.is_some() || self.cursor.test >= self.plan.tests.len() {
            return self.finish(cx);
        }
        if self.fixtures.any_unwell() {
            self.fixtures.stop_unwell(cx);
        }
        if self.fixtures.any_unwell() || self.fixtures.any_stopping() {
            return;
        }
        if self.fixtures.start_next(cx) {
            self.checked = false;
        } else if self.fixtures.all_ready() && !self.waiting {
            self.check_then_test(cx);
        }
    }

    fn check_then_test(&mut self, cx: &mut Context<'_>) {
        if !self.checked {
            self.checked = true;
            self.fixtures.ask_checks(cx);
        }
        if self.fixtures.any_checking() {
            return;
        }
        let Cursor { test, repetition, attempt, .. } = self.cursor;
        let plan = &self.plan.tests[test];
        self.hooks.test_starts();
        self.running = Some(TestRun::start(self.plan, plan, (repetition, attempt), cx));
        cx.out(Effect::SpawnAhead(self.hosts_ahead()));
    }

    /// How the hosts of the next tests are started.
    fn hosts_ahead(&self) -> Vec<Start> {
        let tests = &self.plan.tests;
        let after = |cursor: &Cursor| {
            let repetitions = tests.get(cursor.test).map_or(1, |plan| plan.repetitions);
            Some(cursor.next(false, repetitions))
        };
        let next = std::iter::successors(after(&self.cursor), after).take(HOSTS_AHEAD);
        let plans = next.filter_map(|cursor| tests.get(cursor.test));
        plans.map(|plan| TestRun::host_start(self.plan, plan)).collect()
    }

    fn finish(&mut self, cx: &mut Context<'_>) {
        if !self.end_called {
            self.end_called = true;
            let began = self.fixtures.any_started() || self.cursor.test > 0;
            if began {
                self.hooks.call(Trigger::End, "the suite ends", None);
            }
            if self.hooks.run_next(cx) {
                return;
            }
        }
        self.fixtures.stop_all(cx);
        if !self.fixtures.all_stopped() {
            return;
        }
        let reason = self.ending.clone().unwrap_or_default();
        for plan in &self.plan.tests[self.cursor.test.min(self.plan.tests.len())..] {
            cx.emit(EventKind::TestSkipped { test: plan.id, reason: reason.clone() });
        }
        self.over = true;
        cx.clear(Deadline::Suite);
        cx.clear(Deadline::Retry);
        cx.clear(Deadline::Shutdown);
        cx.emit(EventKind::SuiteFinished { suite: self.plan.id });
        cx.out(Effect::Done);
    }
}
