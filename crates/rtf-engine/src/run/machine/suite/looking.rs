//! A test that would pass waits until all fixtures were seen to live.

use super::{Context, SuiteMachine};
use crate::run::machine::io::{Effect, HostId};
use crate::run::machine::test::TestRun;

impl SuiteMachine<'_> {
    /// A test is about to pass. A fixture that died before is told later, since
    /// what it left is swept first: so each of them is looked at.
    pub(super) fn look_alive(&mut self, cx: &mut Context<'_>) {
        if self.running.as_ref().is_some_and(TestRun::is_looking) {
            self.unseen = self.fixtures.processes();
            self.unseen.iter().for_each(|host| cx.out(Effect::LookAlive(*host)));
            self.all_seen_alive();
        }
    }

    pub(super) fn seen_alive(&mut self, host: HostId) {
        self.unseen.retain(|unseen| *unseen != host);
        self.all_seen_alive();
    }

    fn all_seen_alive(&mut self) {
        if let (true, Some(test)) = (self.unseen.is_empty(), &mut self.running) {
            test.seen_alive();
        }
    }
}
