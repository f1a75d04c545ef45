//! The present process of the program: its cases, what it has reported, and what it left behind.

use std::collections::HashSet;

use rtf_model::LeakedProcess;
use rtf_model::protocol::Notification;

use super::CaseReporter;
use crate::case::Selection;

/// What the reporter knows about the present process.
#[derive(Debug, Default)]
pub(super) struct PresentProcess {
    /// Whether its cases were announced by an earlier one, so that it runs the rest.
    pub is_later: bool,
    /// The top-level cases that it runs; `None` if all.
    pub selection: Option<HashSet<String>>,
    /// Whether it runs one case only: what it leaves behind is left by this case.
    pub has_only_case: bool,
    /// Whether it reported a problem.
    pub has_problem: bool,
    /// Whether it announced that it has reported everything.
    pub is_complete: bool,
    /// The top-level cases that finished in it, which it may repeat.
    pub finished: HashSet<String>,
    /// How often a top-level case finished in it.
    pub count: usize,
    pub last_finished: Option<String>,
}

impl CaseReporter<'_> {
    /// A new process begins, which runs these cases.
    pub fn begin_process(&mut self, selection: &Selection<'_>) {
        let names = || selection.cases.iter().map(|case| case.name.clone()).collect();
        self.process = PresentProcess {
            is_later: self.expected.is_some(),
            selection: (!selection.is_all).then(names),
            has_only_case: selection.cases.len() == 1,
            ..PresentProcess::default()
        };
    }

    /// The present process left these processes behind, which were killed.
    pub fn leave(&mut self, processes: Vec<LeakedProcess>) {
        if processes.is_empty() {
            return;
        }
        let held = self.held_end.as_ref().map(|(case, _)| *case);
        let running = || self.open.iter().find(|open| open.parent.is_none()).map(|open| open.case);
        let case = self.process.has_only_case.then(|| held.or_else(running)).flatten();
        self.session.forward(&Notification::ProcessesLeft { case, processes });
    }

    /// The result of the present process is complete.
    pub fn end_process(&mut self) {
        self.process.has_only_case = false;
        self.report_end();
    }

    pub fn complete_report(&mut self) {
        self.process.is_complete = true;
    }

    /// Whether the present process has reported everything.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.process.is_complete
    }

    #[must_use]
    pub fn has_problem(&self) -> bool {
        self.process.has_problem || self.open.iter().any(|open| open.has_problem)
    }

    /// How many top-level cases finished in the present process.
    #[must_use]
    pub fn finished(&self) -> usize {
        self.process.count
    }

    /// Whether the present process reported neither a case nor a problem.
    #[must_use]
    pub fn has_no_result(&self) -> bool {
        self.process.count == 0 && !self.has_problem() && !self.is_skipped
    }

    /// The top-level case that finished last.
    #[must_use]
    pub fn last_finished(&self) -> Option<&str> {
        self.process.last_finished.as_deref()
    }
}
