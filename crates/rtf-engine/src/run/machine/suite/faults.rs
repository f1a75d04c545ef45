//! The faults that a fixture injects while tests run. The runner reports them, and checks that
//! each one that lasts is removed at most once.

use std::collections::BTreeSet;

use rtf_model::{EventKind, FaultInjected, TestId};

use super::SuiteMachine;
use crate::run::machine::context::Context;

/// The faults that last, each of a running test.
#[derive(Debug, Default)]
pub(super) struct LastingFaults(BTreeSet<(TestId, String)>);

impl LastingFaults {
    /// The attempt of a test has finished.
    pub fn clear(&mut self, test: TestId) {
        self.0.retain(|(of, _)| *of != test);
    }
}

impl SuiteMachine<'_> {
    pub(super) fn on_fault_injected(
        &mut self,
        fixture: usize,
        fault: FaultInjected,
        cx: &mut Context<'_>,
    ) {
        if self.scheduler.run_of(fault.test).is_none() {
            let what = format!("the fault `{}`", fault.name);
            self.report_too_late(fixture, (fault.test, what), cx);
        } else if fault.kind.lasts() && !self.faults.0.insert((fault.test, fault.name.clone())) {
            let text = format!("it injected the fault `{}`, which lasts already", fault.name);
            self.report_fixture_error(fixture, text, cx);
        } else {
            cx.emit(EventKind::FaultInjected(fault));
        }
    }

    pub(super) fn on_fault_removed(
        &mut self,
        fixture: usize,
        fault: (TestId, String),
        cx: &mut Context<'_>,
    ) {
        if self.faults.0.remove(&fault) {
            let (test, name) = fault;
            cx.emit(EventKind::FaultRemoved { test, name });
        } else {
            let text = format!("it removed the fault `{}`, which it had not injected", fault.1);
            self.report_fixture_error(fixture, text, cx);
        }
    }
}
