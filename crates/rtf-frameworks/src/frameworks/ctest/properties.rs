//! The tests of a build directory, from the JSON that `ctest --show-only=json-v1` prints.

use std::collections::HashMap;
use std::path::PathBuf;
use std::time::Duration;

use regex::Regex;
use serde::Deserialize;
use serde_json::Value;

use super::regex_dialect;

/// Commands that read another file.
const INCLUDES: [&str; 2] = ["include", "find_package"];

/// A test of a build directory.
#[derive(Clone, Debug, Default)]
pub struct CTestCase {
    /// Its name, unique in the directory.
    pub name: String,
    /// Program and arguments; empty if CTest found no program.
    pub command: Vec<String>,
    /// File and line of the `add_test` in a `CMakeLists.txt`.
    pub location: Option<(String, u32)>,
    pub working_dir: Option<PathBuf>,
    pub environment: Vec<String>,
    /// `ENVIRONMENT_MODIFICATION`
    pub environment_changes: Vec<String>,
    pub timeout: Option<Duration>,
    /// `TIMEOUT_AFTER_MATCH`: the limit after an expression has matched.
    pub timeout_after_match: Option<(Duration, Vec<Regex>)>,
    pub will_fail: bool,
    /// `PASS_REGULAR_EXPRESSION`, with the expressions as written.
    pub pass: Vec<(String, Regex)>,
    /// `FAIL_REGULAR_EXPRESSION`
    pub fail: Vec<(String, Regex)>,
    /// `SKIP_REGULAR_EXPRESSION`
    pub skip: Vec<(String, Regex)>,
    /// `SKIP_RETURN_CODE`
    pub skip_code: Option<i32>,
    pub disabled: bool,
    pub labels: Vec<String>,
    /// `DEPENDS`: names of tests.
    pub depends: Vec<String>,
    /// `FIXTURES_SETUP`: the fixtures that it sets up.
    pub sets_up: Vec<String>,
    /// `FIXTURES_CLEANUP`
    pub cleans_up: Vec<String>,
    /// `FIXTURES_REQUIRED`
    pub requires: Vec<String>,
    pub required_files: Vec<String>,
    /// `ATTACHED_FILES`
    pub attached: Vec<String>,
    /// `ATTACHED_FILES_ON_FAIL`
    pub attached_on_fail: Vec<String>,
    /// `MEASUREMENT`: names and values.
    pub measurements: Vec<(String, String)>,
}

impl CTestCase {
    /// Whether its output decides its result.
    pub fn searches_output(&self) -> bool {
        let expressions = [&self.pass, &self.fail, &self.skip];
        expressions.iter().any(|it| !it.is_empty()) || self.timeout_after_match.is_some()
    }
}

#[derive(Deserialize)]
struct Document {
    kind: String,
    tests: Vec<Test>,
    #[serde(default, rename = "backtraceGraph")]
    backtraces: Backtraces,
}

#[derive(Deserialize)]
struct Test {
    name: String,
    #[serde(default)]
    command: Vec<String>,
    backtrace: Option<usize>,
    #[serde(default)]
    properties: Vec<Property>,
}

#[derive(Deserialize)]
struct Property {
    name: String,
    value: Value,
}

#[derive(Default, Deserialize)]
struct Backtraces {
    #[serde(default)]
    commands: Vec<String>,
    #[serde(default)]
    files: Vec<String>,
    #[serde(default)]
    nodes: Vec<Node>,
}

#[derive(Deserialize)]
struct Node {
    command: Option<usize>,
    file: usize,
    line: Option<u32>,
    parent: Option<usize>,
}

/// Reads the document.
///
/// # Errors
/// It is not such a document, or an expression is not valid.
pub fn parse(json: &[u8]) -> Result<Vec<CTestCase>, String> {
    let document: Document = serde_json::from_slice(json)
        .map_err(|error| format!("`ctest` printed no list of tests: {error}"))?;
    if document.kind != "ctestInfo" {
        return Err(format!("`ctest` printed a document of the kind `{}`", document.kind));
    }
    let mut numbers: HashMap<String, usize> = HashMap::new();
    document
        .tests
        .into_iter()
        .map(|test| {
            let number = numbers.entry(test.name.clone()).or_default();
            *number += 1;
            let name = match *number {
                1 => test.name.clone(),
                number => format!("{}#{number}", test.name),
            };
            let location = test.backtrace.and_then(|node| document.backtraces.location(node));
            read_test(
                CTestCase { name, command: test.command, location, ..CTestCase::default() },
                &test.properties,
            )
        })
        .collect()
}

impl Backtraces {
    /// The outermost call, so that tests that a function adds have the lines of its calls.
    fn location(&self, node: usize) -> Option<(String, u32)> {
        let mut found = None;
        let mut next = Some(node);
        // A damaged graph could be circular.
        for _ in 0..self.nodes.len() {
            let Some(node) = next.and_then(|index| self.nodes.get(index)) else { break };
            let command = node.command.and_then(|index| self.commands.get(index));
            let includes = command.is_some_and(|name| INCLUDES.contains(&name.as_str()));
            if let (Some(line), Some(file), false) =
                (node.line, self.files.get(node.file), includes)
            {
                found = Some((file.clone(), line));
            }
            next = node.parent;
        }
        found
    }
}

fn read_test(mut test: CTestCase, properties: &[Property]) -> Result<CTestCase, String> {
    for Property { name, value } in properties {
        let compiled = || expressions(&test.name, name, value);
        match name.as_str() {
            "WORKING_DIRECTORY" => test.working_dir = value.as_str().map(PathBuf::from),
            "ENVIRONMENT" => test.environment = texts(value),
            "ENVIRONMENT_MODIFICATION" => test.environment_changes = texts(value),
            "TIMEOUT" => test.timeout = value.as_f64().and_then(limit),
            "TIMEOUT_AFTER_MATCH" => {
                let limit = value["timeout"].as_f64().and_then(limit);
                let expressions = expressions(&test.name, name, &value["regex"])?;
                let expressions = expressions.into_iter().map(|(_, regex)| regex).collect();
                test.timeout_after_match = limit.map(|limit| (limit, expressions));
            }
            "WILL_FAIL" => test.will_fail = is_true(value),
            "PASS_REGULAR_EXPRESSION" => test.pass = compiled()?,
            "FAIL_REGULAR_EXPRESSION" => test.fail = compiled()?,
            "SKIP_REGULAR_EXPRESSION" => test.skip = compiled()?,
            "SKIP_RETURN_CODE" => {
                test.skip_code = value.as_i64().and_then(|code| i32::try_from(code).ok())
            }
            "DISABLED" => test.disabled = is_true(value),
            "LABELS" => test.labels = texts(value),
            "DEPENDS" => test.depends = texts(value),
            "FIXTURES_SETUP" => test.sets_up = texts(value),
            "FIXTURES_CLEANUP" => test.cleans_up = texts(value),
            "FIXTURES_REQUIRED" => test.requires = texts(value),
            "REQUIRED_FILES" => test.required_files = texts(value),
            "ATTACHED_FILES" => test.attached = texts(value),
            "ATTACHED_FILES_ON_FAIL" => test.attached_on_fail = texts(value),
            "MEASUREMENT" => test.measurements = measurements(value),
            // COST, PROCESSORS, RESOURCE_LOCK, RUN_SERIAL: the tests run one after the other.
            _ => {}
        }
    }
    Ok(test)
}

fn expressions(test: &str, property: &str, value: &Value) -> Result<Vec<(String, Regex)>, String> {
    let compile = |pattern: String| match regex_dialect::compile(&pattern) {
        Ok(regex) => Ok((pattern, regex)),
        Err(error) => Err(format!("{property} of `{test}`: {error}")),
    };
    texts(value).into_iter().map(compile).collect()
}

fn texts(value: &Value) -> Vec<String> {
    let text = |value: &Value| match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    match value {
        Value::Array(values) => values.iter().map(text).collect(),
        other => vec![text(other)],
    }
}

fn is_true(value: &Value) -> bool {
    match value {
        Value::Bool(value) => *value,
        Value::String(text) => {
            matches!(text.to_ascii_uppercase().as_str(), "1" | "ON" | "TRUE" | "YES" | "Y")
        }
        other => other.as_f64().is_some_and(|number| number != 0.0),
    }
}

/// A limit in seconds; 0 means none.
fn limit(seconds: f64) -> Option<Duration> {
    Duration::try_from_secs_f64(seconds).ok().filter(|limit| !limit.is_zero())
}

fn measurements(value: &Value) -> Vec<(String, String)> {
    let entries = value.as_array().map(Vec::as_slice).unwrap_or_default();
    let text = |entry: &Value, key: &str| texts(&entry[key]).concat();
    entries.iter().map(|entry| (text(entry, "measurement"), text(entry, "value"))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn properties_of_a_test() {
        let json = r#"{"kind":"ctestInfo","backtraceGraph":{"commands":["add_test","my_test","include"],
            "files":["/p/my.cmake","/p/CMakeLists.txt"],
            "nodes":[{"command":2,"file":1,"line":2},{"command":1,"file":1,"line":7,"parent":0},{"command":0,"file":0,"line":3,"parent":1}]},
            "tests":[{"name":"a","command":["/bin/sh","-c","x"],"backtrace":2,"properties":[
                {"name":"TIMEOUT","value":1.5},{"name":"WILL_FAIL","value":true},
                {"name":"LABELS","value":["l1","l2"]},{"name":"PASS_REGULAR_EXPRESSION","value":["a","b+"]},
                {"name":"MEASUREMENT","value":[{"measurement":"m","value":"3"}]},
                {"name":"TIMEOUT_AFTER_MATCH","value":{"regex":["ready"],"timeout":5.0}},
                {"name":"SKIP_RETURN_CODE","value":4},{"name":"NEW_IN_CMAKE_9","value":{}}]},
              {"name":"a","properties":[{"name":"TIMEOUT","value":0.0}]}]}"#;
        let tests = parse(json.as_bytes()).unwrap();
        let test = &tests[0];
        assert_eq!(test.location, Some(("/p/CMakeLists.txt".to_owned(), 7)));
        assert_eq!(test.timeout, Some(Duration::from_millis(1500)));
        assert_eq!(test.labels, ["l1", "l2"]);
        assert_eq!(test.pass.len(), 2);
        assert_eq!(test.measurements, [("m".to_owned(), "3".to_owned())]);
        assert_eq!((test.will_fail, test.skip_code), (true, Some(4)));
        assert_eq!(test.timeout_after_match.as_ref().unwrap().0, Duration::from_secs(5));
        assert_eq!(
            (tests[1].name.as_str(), tests[1].timeout, tests[1].command.len()),
            ("a#2", None, 0)
        );
    }

    #[test]
    fn bad_documents() {
        assert!(
            parse(b"Test project /x\n")
                .unwrap_err()
                .starts_with("`ctest` printed no list of tests")
        );
        assert!(parse(br#"{"kind":"other","tests":[]}"#).is_err());
        let bad_regex = br#"{"kind":"ctestInfo","tests":[{"name":"a","properties":[
            {"name":"FAIL_REGULAR_EXPRESSION","value":["(x"]}]}]}"#;
        assert!(parse(bad_regex).unwrap_err().starts_with("FAIL_REGULAR_EXPRESSION of `a`"));
    }
}
