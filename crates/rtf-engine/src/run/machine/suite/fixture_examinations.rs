//! Examines the fixtures after each test: its verdict is final when all fixtures have
//! passed an examination that started after its end. If a fixture is dying, all finished
//! tests wait for its end, which is a collapse.

use rtf_model::TestId;

use super::SuiteMachine;
use crate::run::machine::context::Context;
use crate::run::machine::io::ProbeSelection;
use crate::run::machine::test::TestRun;

/// Which examinations each finished test waits for: fixture indices and numbers.
#[derive(Debug, Default)]
pub(super) struct Examinations {
    pending: Vec<(TestId, Vec<(usize, u64)>)>,
}

impl SuiteMachine<'_> {
    /// Examines the fixtures if this test has just ended. The death of a fixture may be
    /// reported later, since its leftover processes are killed first.
    pub(super) fn examine_fixtures(&mut self, test: TestId, cx: &mut Context<'_>) {
        let is_pending = self.examinations.pending.iter().any(|(pending, _)| *pending == test);
        let is_due = self.scheduler.run_of(test).is_some_and(|run| run.awaits_fixtures());
        if is_due && !is_pending {
            // Slow probes run only after the last test: otherwise the next test's check
            // finds a collapse, and the run is not green.
            let probes = if self.scheduler.is_last(test) {
                ProbeSelection::All
            } else {
                ProbeSelection::Quick
            };
            let examinations = self.fixtures.examine_all(probes, cx);
            self.examinations.pending.push((test, examinations));
            self.confirm_passed();
        }
    }

    /// Its end may take a while: it writes a core dump, or a descendant keeps its output
    /// open.
    pub(super) fn on_fixture_dying(&mut self, fixture: usize, cx: &mut Context<'_>) {
        for (test, examinations) in &self.examinations.pending {
            if examinations.iter().any(|(index, _)| *index == fixture) {
                let run = self.scheduler.run_of(*test);
                run.into_iter().for_each(|run| run.on_fixture_dying(cx));
            }
        }
    }

    /// Lets tests pass whose examinations have all passed.
    pub(super) fn confirm_passed(&mut self) {
        for (test, examinations) in &self.examinations.pending {
            if self.fixtures.have_passed(examinations) {
                let run = self.scheduler.run_of(*test);
                run.into_iter().for_each(TestRun::on_fixtures_alive);
            }
        }
    }

    /// The attempt has finished. True if all fixtures have passed since its end, and need
    /// no `check` before the next test.
    pub(super) fn close_examination(&mut self, test: TestId) -> bool {
        let mut closed = self.examinations.pending.extract_if(.., |(pending, _)| *pending == test);
        closed.next().is_some_and(|(_, examinations)| self.fixtures.have_passed(&examinations))
    }
}
