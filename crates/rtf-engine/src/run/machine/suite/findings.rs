//! What a fixture reports about a running test: samples that it took, and problems that it
//! found. `judge` decides what a problem means for the verdict.

use rtf_model::protocol::Notification;
use rtf_model::{EventKind, FaultInjected, Finding, Micros, Samples, Source, TestId};

use super::SuiteMachine;
use crate::run::machine::context::{Context, error_message};
use crate::run::machine::io::ProcessEvent;

/// A report of a fixture about a test.
#[derive(Debug)]
pub(super) enum TestReport {
    Finding(Finding),
    Observed(TestId, Samples),
    FaultInjected(FaultInjected),
    FaultRemoved(TestId, String),
}

impl TestReport {
    /// Returns any other input as the error.
    fn of(input: ProcessEvent) -> Result<Self, Box<ProcessEvent>> {
        let ProcessEvent::Notified(notification) = input else { return Err(Box::new(input)) };
        match notification {
            Notification::Finding(finding) => Ok(Self::Finding(finding)),
            Notification::Observed { test, samples } => Ok(Self::Observed(test, samples)),
            Notification::FaultInjected(fault) => Ok(Self::FaultInjected(fault)),
            Notification::FaultRemoved { test, name } => Ok(Self::FaultRemoved(test, name)),
            other => Err(Box::new(ProcessEvent::Notified(other))),
        }
    }

    fn test(&self) -> TestId {
        match self {
            Self::Finding(finding) => finding.test,
            Self::FaultInjected(fault) => fault.test,
            Self::Observed(test, _) | Self::FaultRemoved(test, _) => *test,
        }
    }
}

impl SuiteMachine<'_> {
    /// Handles a report of a fixture about a test; returns any other input.
    pub(super) fn take_test_report(
        &mut self,
        fixture: usize,
        input: ProcessEvent,
        cx: &mut Context<'_>,
    ) -> Option<ProcessEvent> {
        let report = match TestReport::of(input) {
            Ok(report) => report,
            Err(input) => return Some(*input),
        };
        if self.will_start(report.test()) {
            self.early_reports.push((fixture, report));
        } else {
            self.on_test_report(fixture, report, cx);
        }
        None
    }

    /// Handles the reports about tests that have started, or will not start.
    pub(super) fn take_early_reports(&mut self, cx: &mut Context<'_>) {
        for (fixture, report) in std::mem::take(&mut self.early_reports) {
            if self.will_start(report.test()) {
                self.early_reports.push((fixture, report));
            } else {
                self.on_test_report(fixture, report, cx);
            }
        }
    }

    /// Whether fixtures are being notified that a test is about to start. One that has been
    /// may report before the others have replied. After a collapse, all are notified again.
    fn will_start(&mut self, test: TestId) -> bool {
        if self.end_reason.is_some() || !self.fixtures.all_ready() {
            return false;
        }
        let active = self.scheduler.get(test);
        active.is_some_and(|active| active.run.is_none() && active.is_notified)
    }

    fn on_test_report(&mut self, fixture: usize, report: TestReport, cx: &mut Context<'_>) {
        match report {
            TestReport::Finding(finding) => self.on_finding(fixture, finding, cx),
            TestReport::Observed(test, samples) => self.on_observed(fixture, (test, samples), cx),
            TestReport::FaultInjected(fault) => self.on_fault_injected(fixture, fault, cx),
            TestReport::FaultRemoved(test, name) => {
                self.on_fault_removed(fixture, (test, name), cx);
            }
        }
    }

    /// When fixtures were notified that a test is about to start.
    fn announced(&mut self, test: TestId) -> Option<Micros> {
        self.scheduler.get(test).map(|active| active.announced.into())
    }

    fn on_finding(&mut self, fixture: usize, mut finding: Finding, cx: &mut Context<'_>) {
        if let Some(interval) = &mut finding.interval {
            interval.since = self.announced(finding.test);
        }
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
            samples.since = self.announced(test);
            cx.emit(EventKind::Sampled { test, samples });
        } else {
            let what = format!("samples of `{}`", samples.name);
            self.report_too_late(fixture, (test, what), cx);
        }
    }

    pub(super) fn report_too_late(
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
        self.report_fixture_error(
            fixture,
            format!("it reported about {test}, which does not run: {what}"),
            cx,
        );
    }

    pub(super) fn report_fixture_error(&self, fixture: usize, text: String, cx: &mut Context<'_>) {
        let message = error_message(text);
        let source = Source::Fixture(self.plan.fixtures[fixture].id);
        cx.emit(EventKind::Message { source, message, test: None });
    }
}
