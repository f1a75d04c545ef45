//! Boost.Test: one process per case.
//!
//! The XML log is written when the stream's buffer is full, so a log of several cases would
//! not show which one is running. The verdict is taken from the XML report at the end.

mod list;
mod log;

use std::path::Path;
use std::process::Command;

use crate::case::ListedCase;
use crate::framework::{
    Framework, Launch, ListError, OpenChannel, ReportChannel, ReportReader, TestProgram,
};
use crate::listing;
use crate::report_dir;

/// Parameters that would change which cases run, or where results go.
const RESERVED: [&str; 22] = [
    "-t",
    "--run_test",
    "-f",
    "--log_format",
    "-l",
    "--log_level",
    "-k",
    "--log_sink",
    "--logger",
    "-m",
    "--report_format",
    "-r",
    "--report_level",
    "-e",
    "--report_sink",
    "-o",
    "--output_format",
    "-c",
    "--result_code",
    "--list_content",
    "--list_labels",
    "--help",
];

/// Variables with the same effect.
const VARIABLES: [&str; 11] = [
    "BOOST_TESTS_TO_RUN",
    "BOOST_TEST_RUN_FILTERS",
    "BOOST_TEST_LOG_FORMAT",
    "BOOST_TEST_LOG_LEVEL",
    "BOOST_TEST_LOG_SINK",
    "BOOST_TEST_LOGGER",
    "BOOST_TEST_REPORT_FORMAT",
    "BOOST_TEST_REPORT_LEVEL",
    "BOOST_TEST_REPORT_SINK",
    "BOOST_TEST_OUTPUT_FORMAT",
    "BOOST_TEST_RESULT_CODE",
];

#[derive(Clone, Copy, Debug)]
pub struct BoostTest;

impl Framework for BoostTest {
    fn list(&self, test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        // Arguments after `--` are for the tests.
        let own = test.args.iter().take_while(|arg| *arg != "--").cloned().collect::<Vec<_>>();
        listing::refuse_reserved(&own, &RESERVED)?;
        let mut command = command(&test.file);
        command.arg("--list_content=DOT").args(&test.args);
        let listed = listing::run(command, listing::LIST_LIMIT)?;
        let texts = [&listed.stderr, &listed.stdout];
        let cases = texts.iter().find_map(|text| parse_list(&String::from_utf8_lossy(text)));
        let options = "--list_content=DOT";
        cases.map(Some).ok_or_else(|| listed.not_of("Boost.Test", &test.file, options))
    }

    fn channel(&self) -> ReportChannel {
        ReportChannel::Descriptor
    }

    fn command(&self, launch: &Launch<'_>) -> Result<Command, String> {
        let mut command = command(&launch.test.file);
        if let OpenChannel::Descriptor(path) = &launch.channel {
            // Also messages and warnings, but not checks that held.
            command.arg(format!("--logger=XML,test_suite,{}", path.display()));
        }
        command.arg("--report_format=XML").arg("--report_level=detailed");
        command.arg(format!("--report_sink={}", report_dir::results(launch.scratch).display()));
        for case in launch.cases.cases {
            command.arg(format!("--run_test={}", filter(&case.name)));
        }
        command.args(&launch.test.args);
        Ok(command)
    }

    fn reader(&self, launch: &Launch<'_>) -> Box<dyn ReportReader> {
        let case = launch.cases.cases.first().cloned().unwrap_or_default();
        Box::new(log::Reader::new(case.name, report_dir::results_file(launch.scratch)))
    }

    fn needs_separate_processes(&self) -> bool {
        true
    }

    fn has_own_report(&self) -> bool {
        true
    }

    fn fork_server_command(&self, test: &TestProgram) -> Option<Command> {
        let mut command = command(&test.file);
        command.arg("--list_content=DOT");
        Some(command)
    }

    fn accepts_exit(&self, _code: i32, _has_problem: bool) -> bool {
        // It also depends on other cases, on which the case depends: the reader checks it.
        true
    }
}

fn command(file: &Path) -> Command {
    let mut command = Command::new(file);
    for name in VARIABLES {
        command.env_remove(name);
    }
    // Otherwise each message of the log has a colour.
    command.arg("--color_output=no");
    command
}

/// The cases in a list; `None` if it is none.
pub(super) fn parse_list(text: &str) -> Option<Vec<ListedCase>> {
    list::parse(text)
}

/// A filter for a case. A comma, which separates names and cannot be escaped, is replaced by
/// a wildcard.
fn filter(path: &str) -> String {
    let name = |name: &str| match name.split_once(',') {
        Some((start, _)) => format!("{start}*"),
        None => name.to_owned(),
    };
    path.split('/').map(name).collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comma_becomes_a_wildcard() {
        assert_eq!(filter("suite/case<int>"), "suite/case<int>");
        assert_eq!(filter("suite/case<std__pair<int,int>>"), "suite/case<std__pair<int*");
    }
}
