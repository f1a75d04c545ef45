//! Python's unittest. The runner `rtf.frameworks.unittest_runner` of the Python SDK discovers,
//! lists and runs the tests.

use std::process::Command;

use crate::case::ListedCase;
use crate::framework::{Framework, Launch, ListError, StackDump, TestProgram};

use super::python;

const RUNNER: &str = "rtf.frameworks.unittest_runner";

#[derive(Clone, Copy, Debug)]
pub struct Unittest;

impl Framework for Unittest {
    fn list(&self, test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        python::list(test, command(test), |_| None).map(Some)
    }

    fn list_for_run(&self, _test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        Ok(None)
    }

    fn command(&self, launch: &Launch<'_>) -> Result<Command, String> {
        Ok(command(launch.test))
    }

    fn announces_end(&self) -> bool {
        true
    }

    fn stack_dump(&self) -> StackDump {
        StackDump::SignalToFile
    }
}

fn command(test: &TestProgram) -> Command {
    let mut command = python::interpreter(RUNNER);
    command.arg(&test.file).args(&test.args);
    command
}
