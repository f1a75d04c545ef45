//! The shared host: successive tests with `isolation="shared"` use the same host as long
//! as they pass.
//!
//! A host is assigned the next tests while the present one runs, so that neither side waits
//! for the other after each short test. If the runner has to check something between two
//! tests (fixtures or, in a soak, resource usage), or if the verdict of a test decides what
//! follows (a hook, another attempt, the end of the suite), the host is assigned the next
//! test after the present one has ended. So it is between two episodes of a campaign, whose
//! variables the host sets before it loads the plug-in.

use rtf_model::{Diagnostic, EventKind, ExitStatus, TestId};

use super::SuiteMachine;
use super::active_test::AttemptNumber;
use super::scheduler::Scheduler;
use crate::run::machine::context::Context;
use crate::run::machine::io::{Deadline, Effect, HostId};
use crate::run::machine::kill_escalation::{KILL_WAIT, MAX_KILLS};
use crate::run::machine::test::TestRun;
use crate::run::machine::test::host::{HostChoice, TestRequest, assign};
use rtf_plan::plan::TestPlan;

/// The largest number of tests that are assigned.
const MOST_ASSIGNED: usize = 16;
/// When fewer than this are left, further ones are assigned together: the host wakes once.
const FEW_ASSIGNED: usize = 8;

impl<'p> Scheduler<'p> {
    /// The next attempt that can use the same host, if this one passes. Parallel tests
    /// and timed runs share no hosts.
    pub(super) fn successor(
        &self,
        plan: &'p TestPlan,
        number: AttemptNumber,
    ) -> Option<(&'p TestPlan, AttemptNumber)> {
        if !plan.settings.shared || self.suite.settings.parallel != 1 || self.soak.is_timed() {
            return None;
        }
        if let Some(next) = number.next(false, plan.settings.repetitions) {
            return Some((plan, next));
        }
        let index = plan.id.index() - self.suite.tests.first()?.id.index();
        let next = self.suite.tests.get(index + 1)?;
        plan.can_share_host(next).then_some((next, AttemptNumber::FIRST))
    }

    pub(super) fn request(
        &self,
        plan: &'p TestPlan,
        number: AttemptNumber,
    ) -> TestRequest<'static> {
        let shares = plan.settings.shared && self.suite.settings.parallel == 1;
        let is_last =
            self.successor(plan, number).is_none() && !(shares && self.shared_host.serves_episodes);
        TestRequest { repetition: number.repetition, is_last, carried: None }
    }

    /// Assigns the next tests to the host of a running one.
    pub(super) fn assign_ahead(&mut self, test: TestId, cx: &mut Context<'_>) {
        let shared = &self.shared_host;
        if !shared.assigns_ahead || shared.assigned.len() >= FEW_ASSIGNED {
            return;
        }
        let last = shared.assigned.back().copied();
        let Some(active) = self.get(test) else { return };
        let running = (active.plan, active.number);
        let run = active.run.as_ref().filter(|run| run.can_share_host());
        let Some(host) = run.map(TestRun::host) else { return };
        let (mut host, mut plan, mut number) = last.unwrap_or((host, running.0, running.1));
        while self.shared_host.assigned.len() < MOST_ASSIGNED
            && !decides_what_follows(plan)
            && let Some(next) = self.successor(plan, number)
        {
            (plan, number) = next;
            host = assign(self.suite, plan, self.request(plan, number), host, cx);
            self.shared_host.assigned.push_back((host, plan, number));
        }
    }

    /// An attempt has finished. If its host has begun the next one, starts that one; false
    /// otherwise.
    pub(super) fn hand_over_host(
        &mut self,
        plan: &'p TestPlan,
        run: &TestRun<'p>,
        cx: &mut Context<'_>,
    ) -> bool {
        if !run.is_released() {
            // The host has ended without the assigned tests.
            self.shared_host.assigned.clear();
            return false;
        }
        match self.shared_host.assigned.pop_front() {
            None => self.shared_host.idle = Some((run.host(), plan, cx.values().version())),
            Some((host, next, number)) if self.next_due() == Some((next.id, number)) => {
                let test = next.id;
                self.shared_host.begun = Some(host);
                self.begin_next();
                // There are no fixtures to notify.
                self.get(test).into_iter().for_each(|active| active.is_notified = true);
                self.start_next(|_| true, cx);
                self.assign_ahead(test, cx);
                return true;
            }
            // The test that it has begun is no longer due.
            Some((host, ..)) => {
                self.shared_host.assigned.clear();
                self.kill_shared_host(host, 1, cx);
            }
        }
        false
    }

    /// Chooses the host of a test that is about to start.
    pub(super) fn choose_host(&mut self, plan: &TestPlan, cx: &mut Context<'_>) -> HostChoice {
        if let Some(host) = self.shared_host.begun.take() {
            return HostChoice::Assigned(host);
        }
        match self.shared_host.idle.take() {
            None => HostChoice::New,
            Some((host, previous, values))
                if previous.can_share_host(plan) && values == cx.values().version() =>
            {
                HostChoice::Idle(host)
            }
            Some((host, ..)) => {
                self.kill_shared_host(host, 1, cx);
                HostChoice::New
            }
        }
    }

    fn kill_shared_host(&mut self, host: HostId, kills: u32, cx: &mut Context<'_>) {
        self.shared_host.killed = Some((host, kills));
        cx.push(Effect::KillTree(host));
        cx.set(Deadline::SharedHost, KILL_WAIT);
    }

    /// The shared host was killed and has not ended in time.
    pub(super) fn on_shared_host_timeout(&mut self, cx: &mut Context<'_>) {
        match self.shared_host.killed.take() {
            Some((host, kills)) if kills < MAX_KILLS => {
                self.kill_shared_host(host, kills + 1, cx);
            }
            Some(_) => cx.abandon("a shared host".to_owned()),
            None => {}
        }
    }

    /// Kills the idle host; true once there is none.
    pub(super) fn stop_shared_host(&mut self, cx: &mut Context<'_>) -> bool {
        if let Some((host, ..)) = self.shared_host.idle.take() {
            self.kill_shared_host(host, 1, cx);
        }
        self.shared_host.killed.is_none()
    }
}

/// Whether the test's verdict decides which one follows. The host does not know it: the runner
/// may judge differently.
fn decides_what_follows(plan: &TestPlan) -> bool {
    plan.settings.critical || plan.settings.retries.count > 0
}

impl SuiteMachine<'_> {
    /// A host without a test has ended.
    pub(super) fn on_idle_host_exit(
        &mut self,
        host: HostId,
        status: ExitStatus,
        cx: &mut Context<'_>,
    ) {
        let shared = &mut self.scheduler.shared_host;
        if shared.killed.take_if(|(killed, _)| *killed == host).is_some() {
            cx.clear(Deadline::SharedHost);
        } else if shared.idle.take_if(|(idle, ..)| *idle == host).is_some() {
            self.warn_host_exited(status, cx);
        }
    }

    /// The host has ended before its next test began.
    pub(super) fn restart_in_new_host(
        &mut self,
        test: TestId,
        status: ExitStatus,
        cx: &mut Context<'_>,
    ) {
        self.warn_host_exited(status, cx);
        self.scheduler.shared_host.assigned.clear();
        let Some(active) = self.scheduler.get(test) else { return };
        let (plan, number) = (active.plan, active.number);
        let request = self.scheduler.request(plan, number);
        let run = self.scheduler.run_of(test);
        run.into_iter().for_each(|run| run.restart_in_new_host(self.plan, request, cx));
    }

    pub(super) fn warn_host_exited(&self, status: ExitStatus, cx: &mut Context<'_>) {
        let message = format!("a shared host of `{}` ended between two tests", self.plan.name);
        let diagnostic = Diagnostic::warning("shared-host-ended", message)
            .note(format!("it ended with {status}"))
            .hint("something that an earlier test left in it may be to blame");
        cx.emit(EventKind::Warning { diagnostic });
    }
}
