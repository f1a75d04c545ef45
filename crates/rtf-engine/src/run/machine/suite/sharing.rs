//! Tests with `isolation="shared"` that follow each other and want the same host
//! share one, as long as they pass.
//!
//! A host is asked for the next test while the present one runs, so that nobody
//! waits for anybody. Only where something has to be looked at between the two,
//! fixtures or, while tests are repeated, what the host uses, it is asked when the
//! present one is over.

use rtf_model::{Diagnostic, EventKind, ExitStatus, TestId};

use super::turns::Turns;
use super::{Context, Cursor, SuiteMachine};
use crate::run::machine::io::{Deadline, Effect, HostId};
use crate::run::machine::test::{KILL_WAIT, KILLS, Place, TestRun, sharing};
use rtf_plan::plan::{SuitePlan, TestPlan};

/// The host that outlives its tests.
#[derive(Debug)]
pub(super) struct Sharing<'p> {
    /// Whether something is looked at between two tests.
    one_by_one: bool,
    /// It was asked for this one already, under this id.
    asked: Option<(HostId, TestId, Cursor)>,
    /// It has begun the test that is started now.
    begun: Option<HostId>,
    /// It has nothing to do, and served this test last.
    idle: Option<(HostId, &'p TestPlan)>,
    /// It was killed so often, and its end is awaited.
    killed: Option<(HostId, u32)>,
}

impl Sharing<'_> {
    pub(super) fn new(suite: &SuitePlan) -> Self {
        let one_by_one = !suite.fixtures.is_empty() || suite.repeats();
        Self { one_by_one, asked: None, begun: None, idle: None, killed: None }
    }
}

fn can_share(one: &TestPlan, two: &TestPlan) -> bool {
    let wanted = (one.leaks, &one.env, &one.plugin.host);
    one.shared && two.shared && wanted == (two.leaks, &two.env, &two.plugin.host)
}

impl<'p> Turns<'p> {
    /// The attempt that can share a host with this one: the one after it, if all
    /// goes well. Tests that run side by side, or are repeated for a time, have
    /// processes of their own.
    pub(super) fn follower(
        &self,
        plan: &'p TestPlan,
        cursor: Cursor,
    ) -> Option<(&'p TestPlan, Cursor)> {
        if !plan.shared || self.suite.parallel != 1 || self.rounds.are_timed() {
            return None;
        }
        if let Some(next) = cursor.next(false, plan.repetitions) {
            return Some((plan, next));
        }
        let place = plan.id.index() - self.suite.tests.first()?.id.index();
        let next = self.suite.tests.get(place + 1)?;
        can_share(plan, next).then_some((next, Cursor::FIRST))
    }

    /// Asks the host of a running test for the next one, if nothing comes between.
    pub(super) fn ask_ahead(&mut self, test: TestId, cx: &mut Context<'_>) {
        if self.sharing.asked.is_some() || self.sharing.one_by_one {
            return;
        }
        let Some(turn) = self.of_test(test) else { return };
        let (plan, cursor) = (turn.plan, turn.cursor);
        let Some(on) = turn.run.as_ref().filter(|run| run.shares()).map(TestRun::host) else {
            return;
        };
        let Some((plan, next)) = self.follower(plan, cursor) else { return };
        let wanted = (next.repetition, self.follower(plan, next).is_none());
        let host = sharing::ask(self.suite, plan, wanted, on, cx);
        self.sharing.asked = Some((host, plan.id, next));
    }

    /// An attempt is over. If its host has begun the next one already, that one is
    /// started: true.
    pub(super) fn keep_host(
        &mut self,
        plan: &'p TestPlan,
        run: &TestRun<'p>,
        cx: &mut Context<'_>,
    ) -> bool {
        let asked = self.sharing.asked.take();
        if !run.is_released() {
            // The host is gone, and with it what it has not begun.
            return false;
        }
        match asked {
            None => {
                self.sharing.idle = Some((run.host(), plan));
                false
            }
            Some((host, test, cursor)) if self.due() == Some((test, cursor)) => {
                self.sharing.begun = Some(host);
                self.open_next();
                // There are no fixtures that are to hear of it.
                self.of_test(test).into_iter().for_each(|turn| turn.told = true);
                self.start_next(|_| true, cx);
                self.ask_ahead(test, cx);
                true
            }
            // What it has begun is not wanted any more.
            Some((host, ..)) => {
                self.kill_host(host, cx);
                false
            }
        }
    }

    /// Where a test runs that is about to start.
    pub(super) fn place(&mut self, plan: &TestPlan, cx: &mut Context<'_>) -> Place {
        if let Some(host) = self.sharing.begun.take() {
            return Place::Asked(host);
        }
        match self.sharing.idle.take() {
            None => Place::New,
            Some((host, before)) if can_share(before, plan) => Place::On(host),
            Some((host, _)) => {
                self.kill_host(host, cx);
                Place::New
            }
        }
    }

    fn kill_host(&mut self, host: HostId, cx: &mut Context<'_>) {
        self.sharing.killed = Some((host, 1));
        cx.out(Effect::KillTree(host));
        cx.set(Deadline::SharedHost, KILL_WAIT);
    }

    /// A shared host that was killed has not ended in time.
    pub(super) fn shared_host_late(&mut self, cx: &mut Context<'_>) {
        match self.sharing.killed.take() {
            Some((host, kills)) if kills < KILLS => {
                self.kill_host(host, cx);
                self.sharing.killed = Some((host, kills + 1));
            }
            Some(_) => cx.abandon("a shared host".to_owned()),
            None => {}
        }
    }

    /// Whether there is a host that no test has; it is ended.
    pub(super) fn is_host_kept(&mut self, cx: &mut Context<'_>) -> bool {
        if let Some((host, _)) = self.sharing.idle.take() {
            self.kill_host(host, cx);
        }
        self.sharing.killed.is_some()
    }
}

impl SuiteMachine<'_> {
    /// A host has ended, and no test has it.
    pub(super) fn idle_host_ended(
        &mut self,
        host: HostId,
        status: ExitStatus,
        cx: &mut Context<'_>,
    ) {
        let sharing = &mut self.turns.sharing;
        if sharing.killed.take_if(|(killed, _)| *killed == host).is_some() {
            cx.clear(Deadline::SharedHost);
        } else if sharing.idle.take_if(|(idle, _)| *idle == host).is_some() {
            self.warn_of_end(status, cx);
        }
    }

    /// The host that a test joined has ended before the test began.
    pub(super) fn begin_anew(&mut self, test: TestId, status: ExitStatus, cx: &mut Context<'_>) {
        self.warn_of_end(status, cx);
        self.turns.sharing.asked = None;
        let Some(turn) = self.turns.of_test(test) else { return };
        let (plan, cursor) = (turn.plan, turn.cursor);
        let wanted = (cursor.repetition, self.turns.follower(plan, cursor).is_none());
        let run = self.turns.of_test(test).and_then(|turn| turn.run.as_mut());
        run.into_iter().for_each(|run| run.begin_anew(self.plan, wanted, cx));
    }

    pub(super) fn warn_of_end(&self, status: ExitStatus, cx: &mut Context<'_>) {
        let message = format!("a shared host of `{}` ended between two tests", self.plan.name);
        let diagnostic = Diagnostic::warning("shared-host-ended", message)
            .note(format!("it ended with {status}"))
            .hint("something that an earlier test left in it may be to blame");
        cx.emit(EventKind::Warning { diagnostic });
    }
}
