//! AUnit.
//!
//! The harness uses the runner in `sdk/ada/aunit`, which reports through `RTF_SESSION` and
//! does not run routines that are not selected. Tests are not listed before a run: a harness
//! that uses AUnit's own runner would run them.

use std::process::Command;

use super::session_program::SessionReader;
use crate::case::ListedCase;
use crate::framework::{Framework, Launch, ListError, ReportChannel, ReportReader, TestProgram};

#[derive(Clone, Copy, Debug)]
pub struct AUnit;

impl Framework for AUnit {
    fn list(&self, _test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        Ok(None)
    }

    fn channel(&self) -> ReportChannel {
        ReportChannel::None
    }

    fn command(&self, launch: &Launch<'_>) -> Result<Command, String> {
        Ok(launch.test.command())
    }

    fn reader(&self, _launch: &Launch<'_>) -> Box<dyn ReportReader> {
        let without_report =
            "its main procedure must instantiate `RTF_AUnit.Test_Runner`, not `AUnit.Run`";
        Box::new(SessionReader { without_report: without_report.to_owned() })
    }
}
