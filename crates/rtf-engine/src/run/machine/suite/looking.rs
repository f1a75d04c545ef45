//! The verdict over a test is final when all fixtures have passed an examination that
//! was begun after its end. Of one that is dying, every test waits for the end, which
//! is a collapse.

use rtf_model::TestId;

use super::{Context, SuiteMachine};
use crate::run::machine::io::{HostId, Probes};
use crate::run::machine::test::TestRun;

/// What each test that has ended waits for: the places of fixtures, and the numbers
/// of their examinations.
#[derive(Debug, Default)]
pub(super) struct Looks {
    waiting: Vec<(TestId, Vec<(usize, u64)>)>,
}

impl SuiteMachine<'_> {
    /// A test has ended: each fixture is examined. A fixture that died before is told
    /// later, since what it left is swept first.
    pub(super) fn look_alive(&mut self, test: TestId, cx: &mut Context<'_>) {
        let run = self.turns.of_test(test).and_then(|turn| turn.run.as_ref());
        let known = self.looks.waiting.iter().any(|(waiting, _)| *waiting == test);
        if run.is_some_and(TestRun::is_looking) && !known {
            // After any other test the next one asks again, and the run is not green.
            let probes = if self.turns.is_last(test) { Probes::All } else { Probes::Quick };
            let needs = self.fixtures.examine_all(probes, cx);
            self.looks.waiting.push((test, needs));
            self.pass_seen();
        }
    }

    /// Its end may take a while: a memory image is written, or a descendant holds
    /// its outputs open.
    pub(super) fn seen_dying(&mut self, host: HostId, cx: &mut Context<'_>) {
        let place = self.fixtures.place_of(host);
        let waits = |needs: &[(usize, u64)]| needs.iter().any(|(needed, _)| Some(*needed) == place);
        let tests = self.looks.waiting.iter().filter(|(_, needs)| waits(needs));
        for (test, _) in tests {
            let run = self.turns.of_test(*test).and_then(|turn| turn.run.as_mut());
            run.into_iter().for_each(|run| run.seen_dying(cx));
        }
    }

    /// Tests pass for which all fixtures have passed.
    pub(super) fn pass_seen(&mut self) {
        for (test, needs) in &self.looks.waiting {
            if self.fixtures.have_passed(needs) {
                let run = self.turns.of_test(*test).and_then(|turn| turn.run.as_mut());
                run.into_iter().for_each(TestRun::seen_alive);
            }
        }
    }

    /// An attempt is over: nothing is looked at for it any more. Whether all fixtures
    /// have passed since its end, and so need no `check` before the next test.
    pub(super) fn look_away(&mut self, test: TestId) -> bool {
        let mut ended = self.looks.waiting.extract_if(.., |(waiting, _)| *waiting == test);
        ended.next().is_some_and(|(_, needs)| self.fixtures.have_passed(&needs))
    }
}
