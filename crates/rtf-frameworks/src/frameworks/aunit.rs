//! AUnit.
//!
//! The harness uses the runner in `sdk/ada/aunit`, which reports through `RTF_SESSION` and
//! does not run routines that are not selected. Tests are not listed before a run: a harness
//! that uses AUnit's own runner would run them.

use super::session_program::SessionReader;
use crate::framework::{Framework, Launch, ReportReader};

#[derive(Clone, Copy, Debug)]
pub struct AUnit;

impl Framework for AUnit {
    fn reader(&self, _launch: &Launch<'_>) -> Box<dyn ReportReader> {
        let without_report =
            "its main procedure must instantiate `RTF_AUnit.Test_Runner`, not `AUnit.Run`";
        Box::new(SessionReader { without_report: without_report.to_owned() })
    }
}
