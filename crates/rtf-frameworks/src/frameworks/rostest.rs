//! rostest: a `.test` file of ROS 1, on the master of the suite.
//!
//! rostest writes XML files in the directory `test_results` of `ROS_HOME`: one for each node
//! that is a test, and one about these nodes. They are read when rostest has ended.

mod results;

use std::path::{Path, PathBuf};
use std::process::Command;

use rtf_model::{ExitStatus, Location, MessageKind, Outcome};

use crate::case::{CaseResult, ListedCase, StartedCase};
use crate::case_reporter::CaseReporter;
use crate::framework::{Framework, Garbage, Launch, ListError, ReportReader, TestProgram};
use results::{NodeResult, Problem, TestResult};

/// Debian's packages; a ROS distribution has `ros-NAME-rostest`.
const HINT: &str = "install rostest (Debian: python3-rostest) or source the `setup.bash` of ROS";

#[derive(Clone, Copy, Debug)]
pub struct Rostest;

impl Framework for Rostest {
    fn list(&self, _test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        let path = std::env::var_os("PATH").unwrap_or_default();
        let is_installed = std::env::split_paths(&path).any(|dir| dir.join("rostest").is_file());
        match is_installed {
            true => Ok(None),
            false => Err(ListError::new(format!("there is no program `rostest`; {HINT}"))),
        }
    }

    fn command(&self, launch: &Launch<'_>) -> Result<Command, String> {
        let home = home(launch.scratch);
        // The results of an earlier process.
        drop(std::fs::remove_dir_all(&home));
        std::fs::create_dir_all(&home).map_err(|error| error.to_string())?;
        let mut command = Command::new("rostest");
        command.arg("--reuse-master").arg(&launch.test.file).args(&launch.test.args);
        command.env("ROS_HOME", home);
        Ok(command)
    }

    fn reader(&self, launch: &Launch<'_>) -> Box<dyn ReportReader> {
        Box::new(RostestReader { results: home(launch.scratch).join("test_results") })
    }
}

fn home(scratch: &Path) -> PathBuf {
    scratch.join("ros")
}

/// Reads the results when rostest has ended.
struct RostestReader {
    results: PathBuf,
}

impl ReportReader for RostestReader {
    fn finish(&mut self, end: ExitStatus, cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        let nodes = match (results::read(&self.results), end) {
            (Ok(nodes), _) => nodes,
            // The supervisor reports the crash of rostest.
            (Err(_), ExitStatus::Signal(_)) => return Ok(()),
            (Err(error), ExitStatus::Code(_)) => {
                let text = format!("{error} ({end}); its output has the reason");
                cases.test_error(text);
                return Ok(());
            }
        };
        for node in nodes {
            report_node(node, cases);
        }
        Ok(())
    }
}

fn report_node(node: NodeResult, cases: &mut CaseReporter<'_>) {
    let NodeResult { name, problem, crash, tests, miscounted } = node;
    let is_empty = tests.is_empty();
    for TestResult { class, name: method, problems, skipped } in tests {
        let path = [name.as_str(), &class, &method].join(".").replace("..", ".");
        cases.start(StartedCase { name: path.clone(), ..StartedCase::default() });
        for Problem { is_error, text, location } in problems {
            let kind = if is_error { MessageKind::Error } else { MessageKind::Failure };
            let location = location.map(|(file, line)| Location { file, line });
            cases.message(Some(&path), kind, text, location);
        }
        let result = match skipped {
            Some(reason) if reason.is_empty() => CaseResult::new(Outcome::Skipped, "skipped"),
            Some(reason) => CaseResult::new(Outcome::Skipped, reason),
            None => CaseResult::default(),
        };
        cases.finish(&path, result);
    }
    let result = match (problem, crash) {
        (Some(problem), _)
            if problem.text.contains("RLTestTimeoutException")
                || problem.text.starts_with("max time [") =>
        {
            CaseResult::new(Outcome::TimedOut, problem.text)
        }
        (Some(_), Some(crash)) => CaseResult::new(Outcome::Crashed, crash),
        (Some(problem), None) => CaseResult::new(Outcome::Error, problem.text),
        (None, _) if is_empty => CaseResult::new(Outcome::Error, "the node reported no test"),
        (None, _) if miscounted => {
            let reason = "the node counted more problems than it reported";
            CaseResult::new(Outcome::Error, reason)
        }
        (None, _) => return,
    };
    cases.add(StartedCase { name, ..StartedCase::default() }, result);
}
