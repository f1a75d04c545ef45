//! What is next in a suite.
//!
//! After every input, [`SuiteMachine::proceed`] looks at the fixtures, hooks and
//! the running tests and does what is due, in this order:
//!
//! 1. Tests run: they are left alone. Another one is begun beside them when the
//!    suite is `parallel` and nothing else is to be done first.
//! 2. A hook runs, or was called for: nothing else is begun. Tests that are judged,
//!    and of which fixtures are being told, do not keep it from running.
//! 3. The suite ends early (stop request, broken fixture, critical failure,
//!    limit) or has no test left: `end` hooks, tear down in reverse, skip the rest.
//! 4. A fixture is unwell: tear down that fixture and all that depend on it.
//! 5. A fixture is not there: set it up.
//! 6. Ask plug-in fixtures for their `check`, tell those that asked for it of the next
//!    tests, then start these.
//!
//! Which test may start is in [`turns`], how tests share a host in [`sharing`], how a
//! suite is ended early in [`ending`], what calls for its hooks in [`parking`], how a test that failed is tried again in
//! [`retries`], how the whole is repeated in [`rounds`], what fixtures are told of
//! tests in [`telling`].
//!
//! **A collapse interrupts all running tests in [`SuiteMachine::fixture_changed`].**

mod cursor;
mod ending;
mod invariant;
mod looking;
mod parking;
mod retries;
mod rounds;
mod sharing;
mod telling;
mod turns;

use std::time::Duration;

use rtf_model::{EventKind, Phase, StopCause, TestFinished, TestId, Trigger, Verdict};

use super::fixture::Change;
use super::fixtures::Fixtures;
use super::hooks::Hooks;
use super::io::{Deadline, Effect, HostId, HostInput, Input};
use super::test::{Ended, TestRun};
use crate::run::FailLimit;
use cursor::Cursor;
use looking::Looks;
use rtf_plan::plan::{AfterCollapse, Preparation, SuitePlan};
use turns::Turns;

/// What a step of the machine may use: the time, and a list for its effects.
#[derive(Debug)]
pub struct Context<'a> {
    now: Duration,
    out: &'a mut Vec<Effect>,
    hosts: &'a mut u64,
    abandoned: Option<String>,
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

    /// A process was killed and does not end: nobody waits for it any more. Whose
    /// it is, in words.
    pub fn abandon(&mut self, whose: String) {
        self.abandoned.get_or_insert(whose);
    }

    pub fn new_host(&mut self) -> HostId {
        *self.hosts += 1;
        HostId(*self.hosts)
    }
}

/// The state machine of one suite.
#[derive(Debug)]
pub struct SuiteMachine<'p> {
    plan: &'p SuitePlan,
    fixtures: Fixtures<'p>,
    hooks: Hooks<'p>,
    turns: Turns<'p>,
    looks: Looks,
    /// Whether `check` was asked for the tests that are next.
    checked: bool,
    /// Why the rest is skipped.
    ending: Option<String>,
    /// How many tests of the run have failed, and may.
    fails: FailLimit,
    /// When the run was asked to end: how long that may take, and who asked.
    shutdown: Option<(Duration, String)>,
    /// Whether the `interrupt` hooks were called for, for the end of the run.
    interrupted: bool,
    /// Whether the `end` hooks were called for.
    end_called: bool,
    started: bool,
    over: bool,
    hosts: u64,
    #[cfg(debug_assertions)]
    waits: invariant::Waits,
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
            turns: Turns::new(plan),
            looks: Looks::default(),
            checked: false,
            shutdown: None,
            interrupted: false,
            end_called: false,
            started: false,
            over: false,
            hosts: 0,
            #[cfg(debug_assertions)]
            waits: invariant::Waits::default(),
        }
    }

    /// Takes in what happened at `now` and appends what is to be done.
    pub fn handle(&mut self, input: Input, now: Duration, out: &mut Vec<Effect>) {
        #[cfg(debug_assertions)]
        let begin = self.waits.begin(&input, out);
        let mut hosts = self.hosts;
        let mut cx = Context { now, out, hosts: &mut hosts, abandoned: None };
        match input {
            Input::Start => self.start(&mut cx),
            Input::Host(host, input) => self.host(host, input, &mut cx),
            Input::Deadline(deadline) => self.deadline(deadline, &mut cx),
            Input::Clock(time) => self.turns.clock_shows(time, &mut cx),
            Input::Stop(stop) => self.stop(stop, &mut cx),
            Input::StopTest(test, by) => self.stop_test(test, &by, &mut cx),
            Input::Skip(by) => self.skip(&by, &mut cx),
        }
        self.end_if_abandoned(&mut cx);
        self.look_over(&mut cx);
        self.proceed(&mut cx);
        self.hosts = hosts;
        #[cfg(debug_assertions)]
        self.waits.check(&out[begin..], self.started && !self.over);
    }

    fn start(&mut self, cx: &mut Context<'_>) {
        self.started = true;
        cx.emit(EventKind::SuiteStarted { suite: self.plan.id });
        match &self.plan.preparation {
            Preparation::Refused(reason) if self.ending.is_none() => {
                return self.refuse(reason, cx);
            }
            Preparation::NotNeeded | Preparation::Refused(_) => {}
            Preparation::Done(prepared) => cx.emit(EventKind::SuitePrepared(prepared.clone())),
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
            if plan.repetitions > 1 || self.turns.rounds.are_timed() {
                cx.emit(EventKind::TestSkipped { test: plan.id, reason: reason.to_owned() });
            }
        }
        self.turns.close();
        self.end_called = true;
    }

    fn host(&mut self, host: HostId, input: HostInput, cx: &mut Context<'_>) {
        if let Some(run) = self.turns.of_host(host) {
            let test = run.id();
            match input {
                HostInput::Unbegun(status) => self.begin_anew(test, status, cx),
                HostInput::Exited(status, _) if run.is_released() => {
                    run.lose_host();
                    self.warn_of_end(status, cx);
                }
                input => run.handle(input, cx),
            }
            self.look_alive(test, cx);
            self.turns.ask_ahead(test, cx);
        } else if let Some(place) = self.fixtures.place_of(host) {
            if matches!(input, HostInput::Dies) {
                self.seen_dying(host, cx);
            }
            let change = self.fixtures.get(place).handle(input, cx);
            self.fixture_changed(place, change, cx);
            self.pass_seen();
        } else if self.hooks.owns(host) {
            self.hooks.handle(input, cx);
        } else if let HostInput::Exited(status, _) = input {
            self.idle_host_ended(host, status, cx);
        }
    }

    fn deadline(&mut self, deadline: Deadline, cx: &mut Context<'_>) {
        match deadline {
            Deadline::Suite => self.limit_reached(cx),
            Deadline::Retry(test) => self.retry_is_due(test),
            Deadline::Shutdown => self.shutdown_took_too_long(cx),
            Deadline::Test(test, timer) => {
                let run = self.turns.of_test(test).and_then(|turn| turn.run.as_mut());
                run.into_iter().for_each(|run| run.deadline(timer, cx));
            }
            Deadline::Fixture(place, timer) => {
                let change = self.fixtures.get(place).deadline(timer, cx);
                self.fixture_changed(place, change, cx);
            }
            Deadline::Hook => self.hooks.deadline(cx),
            Deadline::SharedHost => self.turns.shared_host_late(cx),
        }
    }

    /// A fixture's set-up failed, or it collapsed: all running tests are
    /// interrupted at once, and the restarts are counted.
    fn fixture_changed(&mut self, place: usize, change: Option<Change>, cx: &mut Context<'_>) {
        let Some(change) = change else { return };
        let fixture = self.fixtures.get(place);
        let (id, name, first) = (fixture.plan().id, &fixture.plan().name, fixture.starts() == 1);
        let (collapsed, reason) = match change {
            Change::Collapsed(reason) => (true, reason),
            Change::SetupFailed(reason) => (false, reason),
        };
        let test = self.turns.only_one();
        if collapsed {
            let reason = format!("fixture `{name}` collapsed: {reason}");
            self.hooks.call(Trigger::Collapse, &reason, test.clone());
            self.turns.stop_all(StopCause::Collapse, &reason, cx);
        }
        let again = (collapsed || !first) && self.fixtures.take_restart(place);
        if !again && self.ending.is_none() {
            cx.emit(EventKind::FixtureBroken { fixture: id, reason: reason.clone() });
            let reason = format!("fixture `{name}` is broken: {reason}");
            self.hooks.call(Trigger::FixtureBroken, &reason, test);
            self.ending = Some(reason);
        }
    }

    fn test_ended(&mut self, test: TestId, run: &TestRun<'p>, ended: &Ended, cx: &mut Context<'_>) {
        let Some(turn) = self.turns.of_test(test) else { return };
        let (plan, cursor, given_up) = (turn.plan, turn.cursor, turn.given_up.take());
        let goes_on = self.ending.is_none() && given_up.is_none();
        let collapsed = ended.verdict == Verdict::Collapsed;
        let retry = goes_on && retries::is_retried(plan, cursor, ended);
        let rerun = retry || (goes_on && collapsed && plan.after_collapse == AfterCollapse::Rerun);
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
        self.checked = self.look_away(test);
        if let Some(text) = &ended.critical {
            self.end_critically(format!(
                "a critical assertion of `{}` did not hold: {text}",
                plan.name
            ));
        } else if plan.critical && !ended.verdict.is_green() && !rerun {
            self.end_critically(format!(
                "the critical test `{}` did not pass: it is {}",
                plan.name, ended.verdict
            ));
        }
        let rounds = &mut self.turns.rounds;
        let next = cursor.next(rerun, rounds.last_of(plan));
        match (next, given_up) {
            (next, Some(reason)) if next.is_some() || rounds.are_timed() => {
                cx.emit(EventKind::TestSkipped { test, reason });
                rounds.give_up(test);
                self.turns.remove(test);
            }
            (Some(next), _) => self.goes_on(test, next, retry.then_some(plan.retries.delay), cx),
            (None, _) => self.turns.remove(test),
        }
        if self.turns.keep_host(plan, run, cx) {
            self.hooks.test_starts();
            if let Some(reason) = &self.ending {
                self.turns.stop_all(StopCause::Interrupt, reason, cx);
            }
        }
    }

    fn proceed(&mut self, cx: &mut Context<'_>) {
        if !self.started || self.over {
            return;
        }
        if self.turns.any_unjudged() {
            return self.begin_beside(cx);
        }
        if self.turns.any_running() {
            return self.park_or_begin_beside(cx);
        }
        // Tests of other suites may have failed meanwhile.
        if let Some(reason) = self.fails.reached() {
            self.end_early(reason);
        }
        if self.hooks.run_next(cx) {
            self.checked = false;
            return;
        }
        if self.ending.is_none() {
            self.turns.begin_round(cx.now());
        }
        if self.ending.is_some() || self.turns.all_over() {
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
            self.turns.untell();
        } else if self.fixtures.all_ready() {
            self.check_then_test(cx);
        }
    }

    /// Begins further tests beside those that run, unless these have to end first:
    /// for a hook, a fixture that collapsed, or the end of the suite.
    fn begin_beside(&mut self, cx: &mut Context<'_>) {
        if self.ending.is_some() || self.hooks.any() || !self.fixtures.all_ready() {
            return;
        }
        match self.fails.reached() {
            Some(reason) if self.turns.any_due() => self.end_early(reason),
            _ => self.check_then_test(cx),
        }
    }

    fn check_then_test(&mut self, cx: &mut Context<'_>) {
        if !self.turns.any_due() {
            return;
        }
        if !self.checked {
            self.checked = true;
            self.fixtures.ask_checks(cx);
        }
        if self.fixtures.any_checking() {
            return;
        }
        if !self.tell_then_start(cx) {
            return;
        }
        // Those that wait for fixtures to hear of them were checked for, too.
        self.checked = self.turns.any_told();
        self.hooks.test_starts();
        cx.out(Effect::SpawnAhead(self.turns.hosts_ahead()));
    }

    fn finish(&mut self, cx: &mut Context<'_>) {
        if self.run_end_hooks(cx) {
            return;
        }
        self.fixtures.stop_all(cx);
        if !self.fixtures.all_stopped() || self.turns.is_host_kept(cx) {
            return;
        }
        self.last_words(cx);
        self.over = true;
        cx.clear(Deadline::Suite);
        cx.clear(Deadline::Shutdown);
        cx.emit(EventKind::SuiteFinished { suite: self.plan.id });
        cx.out(Effect::Done);
    }
}
