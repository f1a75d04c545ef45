//! What pytest and unittest have in common: the user's interpreter, and the file in which
//! our reporters list cases.

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use rtf_model::{Location, Parameter};
use serde::Deserialize;

use crate::case::ListedCase;
use crate::framework::{ListError, TestProgram};
use crate::listing::{self, Listed, file_name};

/// The limit for listing the cases of a test: all its modules are imported.
const LIST_LIMIT: Duration = Duration::from_secs(110);

/// Selects the interpreter.
const INTERPRETER_VARIABLE: &str = "RTF_PYTHON";
const INTERPRETER: &str = "python3";

/// The file to which the reporters list cases.
const LISTING_VARIABLE: &str = "RTF_LISTING";

/// The line of a list.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Line {
    Case(Case),
    Problem(Problem),
    Finished(bool),
}

#[derive(Debug, Deserialize)]
struct Case {
    name: String,
    location: Option<Location>,
    #[serde(default)]
    tags: Vec<String>,
    #[serde(default)]
    parameters: Vec<Parameter>,
}

#[derive(Debug, Deserialize)]
struct Problem {
    text: String,
    location: Option<Location>,
}

/// Runs a module although the working directory may have one named `rtf`.
const START: &str = "rtf_start";

/// The user's interpreter with a module.
pub(super) fn interpreter(module: &str) -> Command {
    let mut command = Command::new(interpreter_name());
    command.args(["-m", START, module]);
    command
}

pub(super) fn interpreter_name() -> String {
    let chosen = std::env::var(INTERPRETER_VARIABLE).ok().filter(|name| !name.is_empty());
    chosen.unwrap_or_else(|| INTERPRETER.to_owned())
}

/// Runs a command that lists the cases of a test. `explain` describes known problems of a
/// command that did not list them.
pub(super) fn list(
    test: &TestProgram,
    mut command: Command,
    explain: impl FnOnce(&Listed) -> Option<String>,
) -> Result<Vec<ListedCase>, ListError> {
    let dir = tempfile::tempdir().map_err(|error| ListError::new(error.to_string()))?;
    let list = dir.path().join("cases");
    command.env(LISTING_VARIABLE, &list);
    let listed = listing::run(command, LIST_LIMIT).map_err(|error| ListError {
        message: format!("{error}\n`{INTERPRETER_VARIABLE}` selects the interpreter"),
        ..error
    })?;
    let text = std::fs::read_to_string(&list).unwrap_or_default();
    let (mut cases, mut problems, mut is_complete) = (Vec::new(), Vec::new(), false);
    for line in text.lines() {
        match serde_json::from_str(line) {
            Ok(Line::Case(case)) => cases.push(listed_case(case)),
            Ok(Line::Problem(problem)) => problems.push(problem),
            Ok(Line::Finished(finished)) => is_complete = finished,
            Err(error) => {
                return Err(ListError::new(format!(
                    "the list of cases has the line {line}: {error}"
                )));
            }
        }
    }
    if !problems.is_empty() {
        return Err(problem(&test.file, &problems));
    }
    if is_complete {
        return Ok(cases);
    }
    let known = explain(&listed).map(ListError::new);
    Err(known.unwrap_or_else(|| {
        let (name, status) = (file_name(&test.file), listed.status);
        listed.error(format!("the cases of `{name}` could not be listed ({status})"))
    }))
}

fn listed_case(case: Case) -> ListedCase {
    let Case { name, location, tags, parameters } = case;
    ListedCase { name, location, tags, parameters, ..ListedCase::default() }
}

fn problem(file: &Path, problems: &[Problem]) -> ListError {
    let texts: Vec<&str> = problems.iter().map(|problem| problem.text.as_str()).collect();
    // The line belongs to the file of the test.
    let is_here = |location: &&Location| Path::new(&location.file) == file;
    let line = problems.iter().filter_map(|it| it.location.as_ref()).find(is_here);
    ListError { message: texts.join("\n"), line: line.map(|location| location.line) }
}
