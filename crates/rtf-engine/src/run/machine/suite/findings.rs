//! What a fixture reports about a running test: samples that it took, and problems that it
//! found. `judge` decides what a problem means for the verdict.

use rtf_model::protocol::Notification;
use rtf_model::{EventKind, Finding, Samples, Source, TestId};

use super::SuiteMachine;
use crate::run::machine::context::{Context, error_message};
use crate::run::machine::io::ProcessEvent;

impl SuiteMachine<'_> {
    /// Handles a report of a fixture about a test; returns any other input.
    pub(super) fn take_test_report(
        &mut self,
        fixture: usize,
        input: ProcessEvent,
        cx: &mut Context<'_>,
    ) -> Option<ProcessEvent> {
        match input {
            ProcessEvent::Notified(Notification::Finding(finding)) => {
                self.on_finding(fixture, finding, cx);
            }
            ProcessEvent::Notified(Notification::Observed { test, samples }) => {
                self.on_observed(fixture, (test, samples), cx);
            }
            other => return Some(other),
        }
        None
    }

    fn on_finding(&mut self, fixture: usize, finding: Finding, cx: &mut Context<'_>) {
        match self.scheduler.run_of(finding.test).filter(|run| !run.is_judged()) {
            Some(run) => run.on_finding(finding, cx),
            None => {
                let what = format!("a finding: {}", finding.text);
                self.report_too_late(fixture, (finding.test, what), cx);
            }
        }
    }

    /// Samples that arrive between the verdict and the end of the notifications still count.
    fn on_observed(
        &mut self,
        fixture: usize,
        (test, mut samples): (TestId, Samples),
        cx: &mut Context<'_>,
    ) {
        if self.scheduler.run_of(test).is_some() {
            samples.case = None;
            cx.emit(EventKind::Sampled { test, samples });
        } else {
            let what = format!("samples of `{}`", samples.name);
            self.report_too_late(fixture, (test, what), cx);
        }
    }

    fn report_too_late(
        &mut self,
        fixture: usize,
        (test, what): (TestId, String),
        cx: &mut Context<'_>,
    ) {
        let plan = self.plan.tests.iter().find(|plan| plan.id == test);
        let test = match plan {
            Some(plan) => format!("`{}`", plan.name),
            None => format!("a test {test}"),
        };
        let message =
            error_message(format!("it reported about {test}, which does not run: {what}"));
        let source = Source::Fixture(self.plan.fixtures[fixture].id);
        cx.emit(EventKind::Message { source, message, test: None });
    }
}
