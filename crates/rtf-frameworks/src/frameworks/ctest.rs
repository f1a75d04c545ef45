//! `CTest`: the tests of a build directory of `CMake`.
//!
//! `ctest --show-only=json-v1` lists them. This host runs their commands itself, and judges
//! them as `ctest` does: exit code, regular expressions, `WILL_FAIL`, `SKIP_RETURN_CODE`.

mod environment;
mod fixtures;
mod judge;
mod measurements;
mod properties;
mod regex_dialect;

use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;
use std::time::Duration;

use rtf_model::{Location, Outcome};

use crate::case::{CaseResult, ListedCase, Repetition};
use crate::framework::{Framework, Launch, ListError, ReportReader, TestProgram};
use crate::listing;
use properties::CTestCase;

/// The limit for listing: `gtest_discover_tests` can start programs then.
const LIST_LIMIT: Duration = Duration::from_secs(120);

/// The options for the configuration of a multi-configuration generator.
const CONFIG_OPTIONS: [&str; 2] = ["-C", "--build-config"];

#[derive(Debug, Default)]
pub struct CTest {
    tests: OnceLock<Vec<CTestCase>>,
}

impl Framework for CTest {
    fn list(&self, test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        let tests = read_tests(test)?;
        let cases = tests.iter().map(listed).collect();
        // A host runs one test.
        drop(self.tests.set(tests));
        Ok(Some(cases))
    }

    fn watches_output(&self, _launch: &Launch<'_>) -> bool {
        true
    }

    fn merges_output(&self, launch: &Launch<'_>) -> bool {
        // As in `ctest`, whose expressions search both outputs in order.
        self.launched(launch).is_some_and(CTestCase::searches_output)
    }

    fn command(&self, launch: &Launch<'_>) -> Result<Command, String> {
        let test = self.launched(launch).ok_or("`ctest` does not list the test any more")?;
        let (program, args) = test.command.split_first().ok_or("the test has no command")?;
        let mut command = Command::new(program);
        command.args(args);
        if let Some(dir) = &test.working_dir {
            if !dir.is_dir() {
                return Err(format!("the working directory `{}` does not exist", dir.display()));
            }
            command.current_dir(dir);
        }
        let inherited = |name: &str| std::env::var(name).ok();
        let changes =
            environment::changes(&test.environment, &test.environment_changes, inherited)?;
        for (name, value) in changes {
            match value {
                Some(value) => command.env(name, value),
                None => command.env_remove(name),
            };
        }
        Ok(command)
    }

    fn reader(&self, launch: &Launch<'_>) -> Box<dyn ReportReader> {
        let test = self.launched(launch).cloned().unwrap_or_default();
        Box::new(judge::Judge::new(test))
    }

    fn needs_separate_processes(&self) -> bool {
        true
    }

    fn execution_order(&self, listed: &[ListedCase], selected: Vec<ListedCase>) -> Vec<ListedCase> {
        let selected: HashSet<&str> = selected.iter().map(|case| case.name.as_str()).collect();
        let all = fixtures::with_fixtures(self.tests(), &selected);
        listed.iter().filter(|case| all.contains(case.name.as_str())).cloned().collect()
    }

    fn decide(&self, case: &ListedCase, results: &HashMap<String, bool>) -> Option<CaseResult> {
        let test = self.tests().iter().find(|test| test.name == case.name)?;
        let failed = fixtures::set_ups(self.tests(), test)
            .find(|(_, set_up)| results.get(*set_up).is_none_or(|passed| !passed));
        let error = |reason: String| Some(CaseResult::new(Outcome::Error, reason));
        if let Some((fixture, set_up)) = failed {
            return error(format!(
                "the test did not run, because its fixture `{fixture}` was not set up: \
                 `{set_up}` did not pass"
            ));
        }
        let dir = test.working_dir.as_deref().unwrap_or(Path::new("."));
        if let Some(file) = test.required_files.iter().find(|file| !dir.join(file).exists()) {
            return error(format!("the test did not run, because `{file}` does not exist"));
        }
        match test.command.first() {
            None => error(
                "the test did not run, because its program was not found: build it, or choose a \
                 configuration with `param=\"-C Release\"`"
                    .to_owned(),
            ),
            Some(_) => None,
        }
    }

    fn repetition(&self, test: &TestProgram) -> Repetition {
        arguments(&test.args).map(|arguments| arguments.repetition).unwrap_or_default()
    }

    fn accepts_exit(&self, _code: i32, _has_problem: bool) -> bool {
        true
    }
}

impl CTest {
    fn tests(&self) -> &[CTestCase] {
        self.tests.get().map(Vec::as_slice).unwrap_or_default()
    }

    fn launched(&self, launch: &Launch<'_>) -> Option<&CTestCase> {
        let case = launch.cases.cases.first()?;
        self.tests().iter().find(|test| test.name == case.name)
    }
}

pub(super) fn listed(test: &CTestCase) -> ListedCase {
    ListedCase {
        name: test.name.clone(),
        location: test.location.clone().map(|(file, line)| Location { file, line }),
        tags: test.labels.clone(),
        disabled: test.disabled,
        timeout: test.timeout,
        ..ListedCase::default()
    }
}

/// Lists the tests of a build directory, in the order in which they run.
fn read_tests(test: &TestProgram) -> Result<Vec<CTestCase>, ListError> {
    if !test.file.join("CTestTestfile.cmake").is_file() {
        let message = "no build directory of CMake with tests: it contains no \
                       `CTestTestfile.cmake` (configure it; its project calls `enable_testing()`)";
        return Err(ListError::new(message));
    }
    let mut command = Command::new("ctest");
    command.current_dir(&test.file).arg("--show-only=json-v1").args(arguments(&test.args)?.config);
    let found = listing::run(command, LIST_LIMIT)?;
    let is_empty = |tests: &Vec<CTestCase>| tests.is_empty() && test.args.is_empty();
    match parse_list(&found.stdout) {
        Ok(tests) if is_empty(&tests) => Err(ListError::new(
            "the build directory has no tests; with several configurations, choose one with \
             `param=\"-C Release\"`",
        )),
        Ok(tests) => Ok(tests),
        Err(error) => Err(ListError::new(
            format!("{error}\n{}", String::from_utf8_lossy(found.stderr.trim_ascii())).trim_end(),
        )),
    }
}

/// The tests in a list, in the order in which they run.
///
/// # Errors
/// It is no list, or the tests cannot be ordered.
pub(super) fn parse_list(json: &[u8]) -> Result<Vec<CTestCase>, String> {
    properties::parse(json).and_then(fixtures::ordered)
}

/// The reader for a test with the properties of the first one in a list.
pub(super) fn reader_of_first(list: &[u8], name: &str) -> Box<dyn ReportReader> {
    let tests = parse_list(list).unwrap_or_default();
    let first = tests.into_iter().next().unwrap_or_default();
    Box::new(judge::Judge::new(CTestCase { name: name.to_owned(), ..first }))
}

/// What the arguments of a test say.
#[derive(Debug, Default)]
struct Arguments<'a> {
    /// Those for `ctest`: the configuration.
    config: Vec<&'a str>,
    repetition: Repetition,
}

fn arguments(args: &[String]) -> Result<Arguments<'_>, ListError> {
    let mut found = Arguments::default();
    let mut rest = args.iter().map(String::as_str);
    while let Some(arg) = rest.next() {
        let (option, value) = arg.split_once('=').map_or((arg, None), |(it, v)| (it, Some(v)));
        let value = value.or_else(|| rest.next());
        match (option, value) {
            (option, Some(value)) if CONFIG_OPTIONS.contains(&option) => {
                found.config = vec!["--build-config", value];
            }
            ("--repeat", Some(value)) => {
                found.repetition = repetition(value).ok_or_else(|| unknown_argument(args))?;
            }
            _ => return Err(unknown_argument(args)),
        }
    }
    Ok(found)
}

/// `until-pass:3`.
fn repetition(text: &str) -> Option<Repetition> {
    let (mode, times) = text.split_once(':')?;
    let times = times.parse().ok().filter(|times| *times > 0)?;
    Some(match mode {
        "until-pass" => Repetition::UntilPass(times),
        "until-fail" => Repetition::UntilFail(times),
        "after-timeout" => Repetition::AfterTimeout(times),
        _ => return None,
    })
}

fn unknown_argument(args: &[String]) -> ListError {
    let args = args.join(" ");
    ListError::new(format!(
        "`{args}`: the only arguments are `-C CONFIGURATION` and `--repeat MODE:N`; rtf runs the \
         tests itself; select them with `cases`"
    ))
}
