//! The present process of the program: its cases, what it has reported, and what it left behind.

use rtf_model::LeakedProcess;
use rtf_model::protocol::Notification;

use super::CaseReporter;
use crate::case::Selection;

impl CaseReporter<'_> {
    /// A new process begins, which runs these cases.
    pub fn begin_process(&mut self, selection: &Selection<'_>) {
        (self.has_problem, self.finished, self.last_finished) = (false, 0, None);
        self.finished_here.clear();
        self.is_complete = false;
        self.has_only_case = selection.cases.len() == 1;
        self.is_first_process = self.expected.is_none();
        let names = || selection.cases.iter().map(|case| case.name.clone()).collect();
        self.selection = (!selection.is_all).then(names);
    }

    /// The present process left these processes behind, which were killed.
    pub fn leave(&mut self, processes: Vec<LeakedProcess>) {
        if processes.is_empty() {
            return;
        }
        let held = self.held_end.as_ref().map(|(case, _)| *case);
        let running = || self.open.iter().find(|open| open.parent.is_none()).map(|open| open.case);
        let case = self.has_only_case.then(|| held.or_else(running)).flatten();
        self.session.forward(&Notification::ProcessesLeft { case, processes });
    }

    /// The result of the present process is complete.
    pub fn end_process(&mut self) {
        self.has_only_case = false;
        self.report_end();
    }

    pub fn complete_report(&mut self) {
        self.is_complete = true;
    }

    /// Whether the present process has reported everything.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.is_complete
    }

    #[must_use]
    pub fn has_problem(&self) -> bool {
        self.has_problem || self.open.iter().any(|open| open.has_problem)
    }

    /// How many top-level cases finished in the present process.
    #[must_use]
    pub fn finished(&self) -> usize {
        self.finished
    }

    /// Whether the present process reported neither a case nor a problem.
    #[must_use]
    pub fn has_no_result(&self) -> bool {
        self.finished == 0 && !self.has_problem() && !self.is_skipped
    }

    /// The top-level case that finished last.
    #[must_use]
    pub fn last_finished(&self) -> Option<&str> {
        self.last_finished.as_deref()
    }
}
