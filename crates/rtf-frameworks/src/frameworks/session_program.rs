//! Programs whose reporter comes from `rtf` and reports through `RTF_SESSION`.

use rtf_model::ExitStatus;

use crate::case_reporter::CaseReporter;
use crate::framework::{Garbage, ReportReader};

/// Reports an error with a hint if the program did not use its reporter.
#[derive(Clone, Debug)]
pub(super) struct SessionReader {
    /// What is missing, and how to add it.
    pub without_report: String,
}

impl ReportReader for SessionReader {
    fn finish(&mut self, end: ExitStatus, cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        let has_cases =
            cases.has_plan() || !cases.results().is_empty() || cases.running().is_some();
        let is_silent = !has_cases && !cases.is_complete();
        if let (true, ExitStatus::Code(code)) = (is_silent, end) {
            let text = format!(
                "the program ended with exit code {code} and reported no test: {}",
                self.without_report
            );
            cases.test_error(text);
        }
        Ok(())
    }
}
