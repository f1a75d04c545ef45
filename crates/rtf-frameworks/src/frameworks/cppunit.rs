//! CppUnit.
//!
//! A library that is loaded into the program (`LD_PRELOAD`) adds a listener to each
//! `CppUnit::TestResult`, which reports through `RTF_SESSION` and skips tests that are not
//! selected. Programs that link CppUnit statically add the listener in their main function
//! (`rtf/cppunit.hpp`). Tests are not listed before a run: if the library has no effect, the
//! program would run them.

use std::process::Command;

use super::session_program::SessionReader;
use crate::framework::{Framework, Launch, ReportReader};
use crate::preload;

const LIBRARY: &str = "librtf-cppunit.so";

const ADD_HEADER: &str = "add `rtf::report_cases(…)` of `rtf/cppunit.hpp` to its main function";

#[derive(Clone, Copy, Debug)]
pub struct CppUnit;

impl Framework for CppUnit {
    fn command(&self, launch: &Launch<'_>) -> Result<Command, String> {
        let mut command = launch.test.command();
        if let Some(library) = preload::library(LIBRARY) {
            preload::add(&mut command, &[library], launch.scratch)?;
        }
        Ok(command)
    }

    fn reader(&self, _launch: &Launch<'_>) -> Box<dyn ReportReader> {
        let without_report = match preload::library(LIBRARY) {
            Some(_) => format!("it does not use CppUnit, or links it statically; {ADD_HEADER}"),
            None => format!("this rtf was built without `{LIBRARY}`; {ADD_HEADER}"),
        };
        Box::new(SessionReader { without_report })
    }
}
