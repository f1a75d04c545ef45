//! pytest. The plug-in `rtf.frameworks.pytest_plugin` of the Python SDK reports and lists the
//! items.

use std::process::Command;

use rtf_model::protocol::CaseSelector;
use serde::Serialize;

use crate::case::ListedCase;
use crate::framework::{Framework, Launch, ListError, StackDump, TestProgram};
use crate::listing::{self, Listed};

use super::python;

const PLUGIN: &str = "rtf.frameworks.pytest_plugin";

/// Arguments with which pytest runs no tests.
const RESERVED: [&str; 9] = [
    "--collect-only",
    "--co",
    "--setup-plan",
    "--fixtures",
    "--fixtures-per-test",
    "--markers",
    "--help",
    "-h",
    "--version",
];

/// Names the file with the selection, for the workers of pytest-xdist.
const SELECTION_VARIABLE: &str = "RTF_SELECTED_CASES";

/// The items that workers of pytest-xdist run. They have no session.
#[derive(Debug, Serialize)]
struct Selection<'a> {
    wanted: Vec<CaseSelector>,
    finished: Vec<&'a str>,
}

impl<'a> Selection<'a> {
    fn of(launch: &Launch<'a>) -> Self {
        let cases = launch.cases;
        if cases.cases.is_empty() {
            // The plug-in announces them.
            let finished = launch.finished.keys().map(String::as_str).collect();
            return Self { wanted: launch.wanted.to_vec(), finished };
        }
        let equals = |case: &ListedCase| CaseSelector::Equals(case.name.clone());
        let selected = cases.cases.iter().filter(|_| !cases.is_all).map(equals);
        Self { wanted: selected.collect(), finished: Vec::new() }
    }

    fn is_all(&self) -> bool {
        self.wanted.is_empty() && self.finished.is_empty()
    }
}

/// The exit code without any item. That no case was reported is an error in any case.
const NO_TESTS: i32 = 5;

#[derive(Clone, Copy, Debug)]
pub struct Pytest;

impl Framework for Pytest {
    fn list(&self, test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        if let Some(argument) = listing::reserved(&test.args, &RESERVED) {
            return Err(ListError::new(format!("with `{argument}`, pytest runs no tests")));
        }
        let command = command(test, &["--collect-only", "-qq"]);
        python::list(test, command, explain).map(Some)
    }

    fn list_for_run(&self, _test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        // The plug-in announces the items.
        Ok(None)
    }

    fn command(&self, launch: &Launch<'_>) -> Result<Command, String> {
        let mut command = command(launch.test, &[]);
        command.env_remove(SELECTION_VARIABLE);
        let selection = Selection::of(launch);
        if !selection.is_all() {
            let file = launch.scratch.join("selection.json");
            let text = serde_json::to_vec(&selection).map_err(|error| error.to_string())?;
            std::fs::write(&file, text).map_err(|error| error.to_string())?;
            command.env(SELECTION_VARIABLE, file);
        }
        Ok(command)
    }

    fn accepts_exit(&self, code: i32, has_problem: bool) -> bool {
        // `NO_TESTS`: all modules skipped themselves.
        code == 0 || code == NO_TESTS || has_problem
    }

    fn announces_end(&self) -> bool {
        true
    }

    fn stack_dump(&self) -> StackDump {
        StackDump::SignalToFile
    }
}

fn command(test: &TestProgram, options: &[&str]) -> Command {
    let mut command = python::interpreter("pytest");
    // The file is first: the last option of the suite may take any number of values.
    command.args(["-p", PLUGIN]).args(options).arg(&test.file).args(&test.args);
    command
}

fn explain(listed: &Listed) -> Option<String> {
    let text = String::from_utf8_lossy(&listed.stderr);
    let interpreter = python::interpreter_name();
    text.trim_end().ends_with("No module named pytest").then(|| {
        format!(
            "`{interpreter}` has no pytest\nto install it: `{interpreter} -m pip install pytest`, \
             or on Debian the package python3-pytest"
        )
    })
}
