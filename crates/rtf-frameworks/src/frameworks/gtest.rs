//! GoogleTest, also with GoogleMock.
//!
//! The result stream (`--gtest_stream_result_to`) reports the start and the end of each
//! test as it happens. In it, a skipped test looks like a failed one (google/googletest#3411),
//! so the verdict of such a test is taken from the program's output, which contains
//! `[  SKIPPED ]` or `[  FAILED  ]`; if the process runs only this test, from the JSON report.
//! Properties are in that report, at the end.

mod stream;

use std::path::Path;
use std::process::Command;

use rtf_model::{Location, Parameter};
use serde::Deserialize;
use serde_json::Value;

use crate::case::ListedCase;
use crate::framework::{
    Framework, Launch, ListError, OpenChannel, ReportChannel, ReportReader, TestProgram,
};
use crate::listing;
use crate::report_dir;

/// Above this length, the filter is passed in a file: an argument has at most 128 KiB.
const FILTER_BYTES: usize = 64 * 1024;

/// Without it, the output shows which tests were skipped.
const BRIEF: &str = "--gtest_brief";

const RUN_DISABLED: &str = "--gtest_also_run_disabled_tests";

/// Flags that would change which tests run, or where results go.
const RESERVED: [&str; 5] = [
    "--gtest_filter",
    "--gtest_output",
    "--gtest_list_tests",
    "--gtest_stream_result_to",
    "--gtest_flagfile",
];

/// Variables with the same effect.
const VARIABLES: [&str; 8] = [
    "GTEST_BRIEF",
    "GTEST_FILTER",
    "GTEST_OUTPUT",
    "GTEST_LIST_TESTS",
    "GTEST_STREAM_RESULT_TO",
    "GTEST_REPEAT",
    "GTEST_TOTAL_SHARDS",
    "GTEST_SHARD_INDEX",
];

#[derive(Clone, Copy, Debug)]
pub struct GoogleTest;

/// The JSON report, and the JSON list.
#[derive(Debug, Deserialize)]
struct Report {
    testsuites: Vec<Suite>,
}

#[derive(Debug, Deserialize)]
struct Suite {
    name: String,
    testsuite: Vec<Test>,
}

#[derive(Debug, Deserialize)]
struct Test {
    name: String,
    file: Option<String>,
    line: Option<u32>,
    type_param: Option<String>,
    value_param: Option<String>,
    /// Also the properties.
    #[serde(flatten)]
    rest: serde_json::Map<String, Value>,
}

impl Test {
    fn was_skipped(&self) -> bool {
        self.rest.get("result").is_some_and(|result| result == "SKIPPED")
    }

    fn parameters(&self) -> Vec<Parameter> {
        let named = [("type", &self.type_param), ("value", &self.value_param)];
        let parameter = |name: &str, value: String| Parameter { name: name.to_owned(), value };
        named
            .into_iter()
            .filter_map(|(name, value)| Some(parameter(name, utf8(value.as_deref()?))))
            .collect()
    }
}

impl Framework for GoogleTest {
    fn list(&self, test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        listing::refuse_reserved(&test.args, &RESERVED)?;
        let (text, listed) = listing::run_with_file(|list| {
            let mut command = command(test);
            command.arg("--gtest_list_tests").arg(output_flag(list));
            command
        })?;
        let runs_disabled = test.args.iter().any(|arg| arg.starts_with(RUN_DISABLED));
        let cases = parse_list(&text, runs_disabled);
        let options = "--gtest_list_tests";
        cases.map(Some).ok_or_else(|| listed.not_of("GoogleTest", &test.file, options))
    }

    fn channel(&self) -> ReportChannel {
        ReportChannel::Socket
    }

    fn watches_output(&self, launch: &Launch<'_>) -> bool {
        !is_only_case(launch)
    }

    fn command(&self, launch: &Launch<'_>) -> Result<Command, String> {
        let mut command = command(launch.test);
        command.arg(output_flag(&report_dir::results(launch.scratch)));
        if let OpenChannel::Socket(address) = &launch.channel {
            command.arg(format!("--gtest_stream_result_to={address}"));
        }
        let names: Vec<&str> = launch.cases.cases.iter().map(|case| case.name.as_str()).collect();
        if launch.cases.is_all {
            return Ok(command);
        }
        let filter = format!("--gtest_filter={}", names.join(":"));
        if filter.len() <= FILTER_BYTES {
            command.arg(filter);
        } else {
            let file = launch.scratch.join("filter");
            std::fs::write(&file, filter).map_err(|error| error.to_string())?;
            command.arg(format!("--gtest_flagfile={}", file.display()));
        }
        Ok(command)
    }

    fn reader(&self, launch: &Launch<'_>) -> Box<dyn ReportReader> {
        let report = report_dir::results_file(launch.scratch);
        Box::new(stream::Reader::new(launch.cases.cases, report, is_only_case(launch)))
    }

    fn omits_disabled(&self) -> bool {
        true
    }

    fn has_own_report(&self) -> bool {
        true
    }

    fn fork_server_command(&self, test: &TestProgram) -> Option<Command> {
        let mut command = command(test);
        command.arg("--gtest_list_tests");
        Some(command)
    }
}

/// Whether the process runs one selected case, so that nothing is lost if its verdict is taken
/// from the JSON report at the end.
fn is_only_case(launch: &Launch<'_>) -> bool {
    launch.cases.cases.len() == 1 && !launch.cases.is_all
}

fn command(test: &TestProgram) -> Command {
    let mut command = Command::new(&test.file);
    command.args(test.args.iter().filter(|arg| !arg.starts_with(BRIEF)));
    for name in VARIABLES {
        command.env_remove(name);
    }
    command
}

/// Restores UTF-8: GoogleTest up to 1.12 writes each of its bytes as a character.
fn utf8(text: &str) -> String {
    let bytes: Option<Vec<u8>> = text.chars().map(|it| u8::try_from(u32::from(it)).ok()).collect();
    bytes.and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_else(|| text.to_owned())
}

fn output_flag(file: &Path) -> String {
    format!("--gtest_output=json:{}", file.display())
}

/// The cases in a list; `None` if it is none.
pub(super) fn parse_list(text: &[u8], runs_disabled: bool) -> Option<Vec<ListedCase>> {
    let report = serde_json::from_slice::<Report>(text).ok()?;
    Some(cases(&report, runs_disabled))
}

fn cases(report: &Report, runs_disabled: bool) -> Vec<ListedCase> {
    let of_suite = |suite: &Suite| -> Vec<ListedCase> {
        let case = |test: &Test| {
            let name = format!("{}.{}", suite.name, test.name);
            let is_disabled =
                |part: &str| part.starts_with("DISABLED_") || part.contains("/DISABLED_");
            let disabled = !runs_disabled && (is_disabled(&suite.name) || is_disabled(&test.name));
            let location =
                test.file.clone().map(|file| Location { file, line: test.line.unwrap_or(0) });
            ListedCase {
                name,
                location,
                parameters: test.parameters(),
                disabled,
                ..ListedCase::default()
            }
        };
        suite.testsuite.iter().map(case).collect()
    };
    report.testsuites.iter().flat_map(of_suite).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_that_were_written_as_characters_are_utf8_again() {
        assert_eq!(utf8("\u{c3}\u{bc} a"), "\u{fc} a");
        assert_eq!(utf8("\u{fc} \u{20ac}"), "\u{fc} \u{20ac}");
        assert_eq!(utf8("\u{e9}"), "\u{e9}");
    }
}
