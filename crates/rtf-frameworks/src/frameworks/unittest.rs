//! Python's unittest, and launch_testing, whose tests are unittest's. Runners of the Python SDK find,
//! list and run the tests.

use std::process::Command;

use crate::case::ListedCase;
use crate::framework::{Framework, Launch, ListError, StackDump, TestProgram};

use super::python;

#[derive(Clone, Copy, Debug)]
pub struct Unittest {
    /// The module of the runner.
    runner: &'static str,
}

pub const UNITTEST: Unittest = Unittest { runner: "rtf.frameworks.unittest_runner" };
pub const LAUNCH_TESTING: Unittest = Unittest { runner: "rtf.frameworks.launch_testing_runner" };

impl Framework for Unittest {
    fn list(&self, test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        python::list(test, self.program(test), |_| None).map(Some)
    }

    fn list_for_run(&self, _test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        Ok(None)
    }

    fn command(&self, launch: &Launch<'_>) -> Result<Command, String> {
        Ok(self.program(launch.test))
    }

    fn announces_end(&self) -> bool {
        true
    }

    fn stack_dump(&self) -> StackDump {
        StackDump::SignalToFile
    }
}

impl Unittest {
    fn program(&self, test: &TestProgram) -> Command {
        let mut command = python::interpreter(self.runner);
        command.arg(&test.file).args(&test.args);
        command
    }
}
