//! The state machine of a suite: distributes inputs to fixtures, tests and hooks, and
//! then starts what is due ([`advance`]).

mod active_test;
mod advance;
mod attempts;
#[cfg(debug_assertions)]
mod deadline_invariant;
mod episodes;
mod faults;
mod findings;
mod fixture_examinations;
mod host_sharing;
mod scheduler;
mod shared_host;
mod soak;
mod stop;
mod subscriptions;

use std::time::Duration;

use rtf_model::{EventKind, Phase, StopCause, TestFinished, Trigger, Verdict};

use super::context::{Context, Questions};
use super::fixture::FixtureFailure;
use super::fixture_graph::FixtureGraph;
use super::hook_queue::HookQueue;
use super::io::{Deadline, Effect, HostId, Input, ProcessEvent};
use crate::fixture_values::FixtureValues;
use crate::run::FailLimit;
use episodes::Episodes;
use faults::LastingFaults;
use findings::TestReport;
use fixture_examinations::Examinations;
use rtf_plan::plan::{Preparation, SuitePlan};
use scheduler::Scheduler;

/// The state of one suite.
#[derive(Debug)]
pub struct SuiteMachine<'p> {
    plan: &'p SuitePlan,
    fixtures: FixtureGraph<'p>,
    hooks: HookQueue<'p>,
    scheduler: Scheduler<'p>,
    examinations: Examinations,
    faults: LastingFaults,
    early_reports: Vec<(usize, TestReport)>,
    episodes: Episodes<'p>,
    /// Whether `check` was requested for the next tests.
    is_checked: bool,
    /// Why the remaining tests are skipped.
    end_reason: Option<String>,
    /// Counts the failures of the whole run.
    fails: FailLimit,
    /// The request to end the run: its limit, and who sent it.
    shutdown: Option<(Duration, String)>,
    /// Whether the end of the run has triggered the `interrupt` hooks.
    is_interrupted: bool,
    /// Whether the `end` hooks were triggered.
    is_ending: bool,
    is_started: bool,
    is_finished: bool,
    last_host: u64,
    values: FixtureValues,
    questions: Questions,
    #[cfg(debug_assertions)]
    invariant: deadline_invariant::DeadlineInvariant,
}

impl<'p> SuiteMachine<'p> {
    /// `fails` counts the failures of the whole run until now.
    #[must_use]
    pub fn new(plan: &'p SuitePlan, fails: FailLimit) -> Self {
        Self {
            plan,
            end_reason: fails.reached(),
            fails,
            fixtures: FixtureGraph::new(plan),
            hooks: HookQueue::new(plan),
            scheduler: Scheduler::new(plan),
            examinations: Examinations::default(),
            faults: LastingFaults::default(),
            early_reports: Vec::new(),
            episodes: Episodes::new(plan),
            is_checked: false,
            shutdown: None,
            is_interrupted: false,
            is_ending: false,
            is_started: false,
            is_finished: false,
            last_host: 0,
            values: FixtureValues::new(plan),
            questions: Questions::default(),
            #[cfg(debug_assertions)]
            invariant: deadline_invariant::DeadlineInvariant::default(),
        }
    }

    /// No operator can answer the questions of its tests, for this reason.
    #[must_use]
    pub fn unattended(mut self, reason: Option<String>) -> Self {
        self.questions = Questions::new(reason);
        self
    }

    /// Whether a running test needs [`Input::Clock`].
    #[must_use]
    pub fn follows_clock(&self) -> bool {
        self.scheduler.follows_clock()
    }

    /// Handles an input that came at `now` and appends its effects.
    pub fn handle(&mut self, input: Input, now: Duration, effects: &mut Vec<Effect>) {
        #[cfg(debug_assertions)]
        let begin = self.invariant.begin(&input, effects);
        let mut last_host = self.last_host;
        let mut values = std::mem::take(&mut self.values);
        let mut questions = std::mem::take(&mut self.questions);
        let mut cx = Context::new(now, effects, &mut last_host, &mut values, &mut questions);
        match input {
            Input::Start => self.start(&mut cx),
            Input::Host(host, input) => self.on_host_input(host, input, &mut cx),
            Input::Deadline(deadline) => self.on_deadline(deadline, &mut cx),
            Input::Clock(time) => self.scheduler.on_clock(time, &mut cx),
            Input::Stop(stop) => self.on_stop_request(stop, &mut cx),
            Input::StopTest(test, by) => self.stop_test(test, &by, &mut cx),
            Input::Answer(test, reply) => {
                if let Some(run) = self.scheduler.run_of(test) {
                    run.on_reply(reply, &mut cx);
                }
            }
            Input::Skip(by) => self.skip_rest(&by, &mut cx),
            Input::Episode(episode) => self.episodes.add(episode),
        }
        self.end_if_abandoned(&mut cx);
        self.judge_tests(&mut cx);
        // Those of a fixture that collapsed, before it is stopped.
        self.take_early_reports(&mut cx);
        self.advance(&mut cx);
        self.take_early_reports(&mut cx);
        self.hand_out_episodes(&mut cx);
        (self.last_host, self.values, self.questions) = (last_host, values, questions);
        #[cfg(debug_assertions)]
        let awaits_episodes = self.episodes.is_waiting() || self.scheduler.awaits_episodes();
        #[cfg(debug_assertions)]
        let continues = self.is_started && !self.is_finished && !awaits_episodes;
        #[cfg(debug_assertions)]
        self.invariant.check(&effects[begin..], continues);
    }

    fn start(&mut self, cx: &mut Context<'_>) {
        self.is_started = true;
        cx.emit(EventKind::SuiteStarted { suite: self.plan.id });
        match &self.plan.preparation {
            Preparation::Refused(reason) if self.end_reason.is_none() => {
                return self.refuse(reason, cx);
            }
            Preparation::NotNeeded | Preparation::Refused(_) => {}
            Preparation::Done(prepared) => cx.emit(EventKind::SuitePrepared(prepared.clone())),
        }
        if self.end_reason.is_none() {
            self.begin_episode(cx);
        }
        self.set_timeout(cx);
    }

    /// Sets the limit of the suite, or of the episode.
    fn set_timeout(&self, cx: &mut Context<'_>) {
        if let Some(timeout) = self.plan.settings.timeout {
            cx.set(Deadline::Suite, timeout);
        }
    }

    /// A resource of the suite is unavailable: each test is an error, nothing is started.
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
                decided_by: None,
            }));
            if plan.settings.repetitions > 1 || self.scheduler.soak.is_timed() {
                cx.emit(EventKind::TestSkipped { test: plan.id, reason: reason.to_owned() });
            }
        }
        self.scheduler.close();
        self.is_ending = true;
    }

    fn on_host_input(&mut self, host: HostId, input: ProcessEvent, cx: &mut Context<'_>) {
        if let ProcessEvent::Notified(notification) = &input {
            self.forward_report(host, notification, cx);
        }
        if let Some(run) = self.scheduler.run_of_host(host) {
            let test = run.id();
            match input {
                ProcessEvent::NotStarted(status) => self.restart_in_new_host(test, status, cx),
                ProcessEvent::Exited(status, _) if run.is_released() => {
                    run.on_released_host_exit();
                    self.warn_host_exited(status, cx);
                }
                input => run.handle(input, cx),
            }
            self.examine_fixtures(test, cx);
            self.scheduler.assign_ahead(test, cx);
        } else if let Some(index) = self.fixtures.index_of(host) {
            if matches!(input, ProcessEvent::Dying) {
                self.on_fixture_dying(index, cx);
            }
            if let Some(input) = self.take_test_report(index, input, cx) {
                let failure = self.fixtures.get(index).handle(input, cx);
                self.on_fixture_failure(index, failure, cx);
            }
            self.confirm_passed();
        } else if let Some(fixture) = self.fixtures.that_resets(host) {
            fixture.handle_reset(input, cx);
        } else if self.hooks.owns(host) {
            self.hooks.handle(input, cx);
        } else if let ProcessEvent::LeaderEnded(..) = input {
            cx.push(Effect::KillTree(host));
        } else if let ProcessEvent::Exited(status, _) = input {
            self.on_idle_host_exit(host, status, cx);
        }
    }

    fn on_deadline(&mut self, deadline: Deadline, cx: &mut Context<'_>) {
        match deadline {
            Deadline::Suite => self.on_suite_timeout(cx),
            Deadline::Retry(test) => self.on_retry_due(test),
            Deadline::Shutdown => self.on_shutdown_timeout(cx),
            Deadline::Test(test, timer) => {
                let run = self.scheduler.run_of(test);
                run.into_iter().for_each(|run| run.on_deadline(timer, cx));
            }
            Deadline::Fixture(index, timer) => {
                let failure = self.fixtures.get(index).on_deadline(timer, cx);
                self.on_fixture_failure(index, failure, cx);
            }
            Deadline::Hook => self.hooks.on_deadline(cx),
            Deadline::SharedHost => self.scheduler.on_shared_host_timeout(cx),
        }
    }

    /// Interrupts all running tests if a fixture collapsed, and counts its restarts.
    fn on_fixture_failure(
        &mut self,
        index: usize,
        failure: Option<FixtureFailure>,
        cx: &mut Context<'_>,
    ) {
        let Some(failure) = failure else { return };
        let fixture = self.fixtures.get(index);
        let (id, name) = (fixture.plan().id, &fixture.plan().name);
        let is_first_start = fixture.starts() == 1;
        let (has_collapsed, reason) = match failure {
            FixtureFailure::Collapse(reason) => (true, reason),
            FixtureFailure::Setup(reason) => (false, reason),
        };
        let test = self.scheduler.only_running_test();
        if has_collapsed {
            let reason = format!("fixture `{name}` collapsed: {reason}");
            self.hooks.trigger(Trigger::Collapse, &reason, test.clone());
            self.scheduler.stop_all(StopCause::Collapse, &reason, cx);
        }
        let restarts = (has_collapsed || !is_first_start) && self.fixtures.use_restart(index);
        if !restarts && self.end_reason.is_none() {
            cx.emit(EventKind::FixtureBroken { fixture: id, reason: reason.clone() });
            let reason = format!("fixture `{name}` is broken: {reason}");
            self.hooks.trigger(Trigger::FixtureBroken, &reason, test);
            self.end_reason = Some(reason);
        }
    }
}
