//! The XML files of rostest and of the nodes that it starts.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use roxmltree::{Document, Node};

/// The results of a node that is a test.
#[derive(Debug, Default)]
pub struct NodeResult {
    /// The name of the test, `test-name` in the `.test` file.
    pub name: String,
    /// Why rostest has no results of the node.
    pub problem: Option<Problem>,
    /// How its process died, if a signal ended it.
    pub crash: Option<String>,
    /// The tests that it reported.
    pub tests: Vec<TestResult>,
    /// It counted more problems than it reported.
    pub miscounted: bool,
}

/// A test in a node.
#[derive(Debug, PartialEq, Eq)]
pub struct TestResult {
    /// Its class, without `__main__`.
    pub class: String,
    /// Its method.
    pub name: String,
    pub problems: Vec<Problem>,
    /// Why it was skipped.
    pub skipped: Option<String>,
}

/// A failure or an error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// An error, not a failure.
    pub is_error: bool,
    pub text: String,
    /// File and line.
    pub location: Option<(String, u32)>,
}

/// Reads all results in a directory `test_results`.
///
/// # Errors
/// rostest wrote none, or a file is damaged.
pub fn read(dir: &Path) -> Result<Vec<NodeResult>, String> {
    let mut own = Vec::new();
    let mut of_nodes = BTreeMap::new();
    for file in xml_files(dir) {
        let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let text = read_text(&file)?;
        if let Some(name) = stem.strip_prefix("rosunit-") {
            of_nodes.insert(name.to_owned(), text);
        } else if stem.starts_with("rostest-") {
            own.push(text);
        }
    }
    if own.is_empty() {
        return Err("rostest wrote no results".to_owned());
    }
    let mut nodes = Vec::new();
    for text in &own {
        nodes.extend(read_own(text)?);
    }
    if nodes.is_empty() {
        return Err("the file has no `<test>`".to_owned());
    }
    for node in &mut nodes {
        if let Some(text) = of_nodes.get(&node.name) {
            (node.tests, node.miscounted) = read_node(text)?;
        }
    }
    Ok(nodes)
}

/// The XML files in the directories of packages.
fn xml_files(dir: &Path) -> Vec<PathBuf> {
    let entries = |dir: &Path| std::fs::read_dir(dir).into_iter().flatten().filter_map(Result::ok);
    let mut files: Vec<PathBuf> = entries(dir)
        .flat_map(|package| entries(&package.path()).collect::<Vec<_>>())
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|it| it == "xml"))
        .collect();
    files.sort();
    files
}

/// Control characters of a program's output are not allowed in XML.
fn read_text(file: &Path) -> Result<String, String> {
    let bytes = std::fs::read(file).map_err(|error| format!("{}: {error}", file.display()))?;
    let text = String::from_utf8_lossy(&bytes);
    let is_allowed = |c: &char| !c.is_control() || matches!(c, '\n' | '\t' | '\r');
    Ok(text.chars().filter(is_allowed).collect())
}

fn parse(text: &str) -> Result<Document<'_>, String> {
    Document::parse(text).map_err(|error| format!("a result file is not XML: {error}"))
}

/// The nodes in a file of rostest.
fn read_own(text: &str) -> Result<Vec<NodeResult>, String> {
    let document = parse(text)?;
    let errors: String = all(&document, "system-err").filter_map(|node| node.text()).collect();
    let node = |case: Node<'_, '_>| {
        let name = case.attribute("name").unwrap_or_default();
        let name = name.strip_prefix("test").unwrap_or(name).to_owned();
        let problem = problems(case).into_iter().next();
        let crash = crash(&errors, &name);
        NodeResult { name, problem, crash, ..NodeResult::default() }
    };
    Ok(all(&document, "testcase").map(node).collect())
}

/// The tests in a file of a node, and whether it counted more problems than it reported.
fn read_node(text: &str) -> Result<(Vec<TestResult>, bool), String> {
    let document = parse(text)?;
    let test = |case: Node<'_, '_>| {
        let class = case.attribute("classname").unwrap_or_default();
        let class = class.strip_prefix("__main__.").unwrap_or(class).to_owned();
        let name = case.attribute("name").unwrap_or_default().to_owned();
        let skipped = case.children().find(|it| it.has_tag_name("skipped"));
        let status = case.attribute("status");
        let skipped = match skipped {
            Some(node) => Some(message(node)),
            None if status == Some("notrun") => Some("disabled".to_owned()),
            None => None,
        };
        TestResult { class, name, problems: problems(case), skipped }
    };
    let tests: Vec<TestResult> = all(&document, "testcase").map(test).collect();
    let count = |name: &str| document.root_element().attribute(name).and_then(|it| it.parse().ok());
    let counted = count("errors").unwrap_or(0) + count("failures").unwrap_or(0);
    let reported = tests.iter().filter(|test| !test.problems.is_empty()).count();
    Ok((tests, counted > reported))
}

fn all<'a, 'input>(
    document: &'a Document<'input>,
    name: &'static str,
) -> impl Iterator<Item = Node<'a, 'input>> {
    document.descendants().filter(move |node| node.has_tag_name(name))
}

fn problems(case: Node<'_, '_>) -> Vec<Problem> {
    let is_problem =
        |node: &Node<'_, '_>| node.has_tag_name("failure") || node.has_tag_name("error");
    let problem = |node: Node<'_, '_>| {
        let full = message(node);
        let location = location(&full);
        // rosunit writes the traceback after the message.
        let lines: Vec<&str> =
            full.lines().take_while(|line| !line.starts_with("  File \"")).collect();
        let text = if lines.is_empty() { full.clone() } else { lines.join("\n") };
        let is_error = node.has_tag_name("error");
        let kind = node.attribute("type").filter(|it| is_error && !it.is_empty());
        let text = match kind {
            Some(kind) if !text.contains(kind) && kind != "RLTestTimeoutException" => {
                format!("{kind}: {text}")
            }
            _ => text,
        };
        Problem { is_error, text: text.trim().to_owned(), location }
    };
    case.children().filter(is_problem).map(problem).collect()
}

/// The text of an element; GoogleTest also has it in an attribute.
fn message(node: Node<'_, '_>) -> String {
    let text = node.text().unwrap_or_default().trim();
    let attribute = node.attribute("message").unwrap_or_default();
    if text.is_empty() { attribute.to_owned() } else { text.to_owned() }
}

/// The innermost frame of a traceback, or `FILE:LINE` in the first line, as in GoogleTest.
fn location(text: &str) -> Option<(String, u32)> {
    let frame = |line: &str| {
        let (file, rest) = line.trim().strip_prefix("File \"")?.split_once("\", line ")?;
        let line = rest.split(',').next()?.trim().parse().ok()?;
        Some((file.to_owned(), line))
    };
    let first = || {
        let (file, line) = text.lines().next()?.rsplit_once(':')?;
        Some((file.to_owned(), line.trim().parse().ok()?))
    };
    text.lines().rev().find_map(frame).or_else(first)
}

/// How the process of a node died: `[arm-4] process has died [pid 21, exit code -11, cmd …`.
fn crash(errors: &str, name: &str) -> Option<String> {
    let start = format!("[{name}-");
    let line = errors.lines().rev().find(|line| {
        line.contains(&start) && line.contains("process has died") && line.contains("exit code -")
    })?;
    let signal = line.split_once("exit code -")?.1.split(',').next()?.trim();
    let signal: i32 = signal.parse().ok()?;
    Some(format!("the node ended with {}", rtf_model::ExitStatus::Signal(signal)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const OWN: &str = r#"<?xml version="1.0" encoding="utf-8"?>
<testsuite errors="1" failures="2" name="unittest.suite.TestSuite" tests="3" time="9.5"><testcase classname="rostest.runner.RosTest" name="testarm" time="1.7" /><testcase classname="rostest.runner.RosTest" name="testcrashes" time="0.8"><failure type="AssertionError">False is not true : test [crashes] did not generate test results
  File "/usr/lib/python3/dist-packages/rostest/runner.py", line 164, in fn
</failure></testcase><testcase classname="rostest.runner.RosTest" name="testhangs" time="2.5"><error type="RLTestTimeoutException">max time [2.0s] allotted for test [hangs] of type [arm_tests/hang.py]
</error></testcase><system-out>&lt;![CDATA[ ]]&gt;</system-out><system-err>&lt;![CDATA[
&amp;#x001B;[31m[crashes-4] process has died [pid 21649, exit code -11, cmd /x].
]]&gt;</system-err></testsuite>"#;

    const NODE: &str = r#"<testsuite errors="1" failures="1" name="x" tests="3"><testcase classname="__main__.TestArm" name="test_error" time="0.0003"><error type="RuntimeError">no power
  File "/usr/lib/python3.11/unittest/case.py", line 57, in testPartExecutor
    yield
  File "/p/test_arm.py", line 9, in test_error
    raise RuntimeError('no power')
</error></testcase><testcase classname="__main__.TestArm" name="test_moves" time="0.0004" /></testsuite>"#;

    const GTEST: &str = r#"<testsuites tests="2" failures="1" errors="0"><testsuite name="Arm"><testcase name="Fails" status="run" classname="Arm"><failure message="/p/arm.cpp:7&#x0A;Expected equality" type=""><![CDATA[/p/arm.cpp:7
Expected equality]]></failure></testcase><testcase name="Off" status="notrun" classname="Arm"/></testsuite></testsuites>"#;

    #[test]
    fn the_file_of_rostest() {
        let nodes = read_own(OWN).unwrap();
        let shown: Vec<_> =
            nodes.iter().map(|it| (it.name.as_str(), it.crash.as_deref())).collect();
        let crash = "the node ended with signal 11 (SIGSEGV)";
        assert_eq!(shown, [("arm", None), ("crashes", Some(crash)), ("hangs", None)]);
        let text = |index: usize| nodes[index].problem.as_ref().map(|it| it.text.as_str());
        assert_eq!(
            text(1),
            Some("False is not true : test [crashes] did not generate test results")
        );
        assert_eq!(
            text(2),
            Some("max time [2.0s] allotted for test [hangs] of type [arm_tests/hang.py]")
        );
    }

    #[test]
    fn the_files_of_nodes() {
        let (tests, miscounted) = read_node(NODE).unwrap();
        assert!(miscounted);
        let problem = &tests[0].problems[0];
        assert_eq!(
            (tests[0].class.as_str(), problem.text.as_str()),
            ("TestArm", "RuntimeError: no power")
        );
        assert_eq!(problem.location, Some(("/p/test_arm.py".to_owned(), 9)));
        let (tests, miscounted) = read_node(GTEST).unwrap();
        assert!(!miscounted);
        assert_eq!(tests[0].problems[0].location, Some(("/p/arm.cpp".to_owned(), 7)));
        assert_eq!(tests[1].skipped.as_deref(), Some("disabled"));
    }

    #[test]
    fn missing_results() {
        let dir = tempfile::tempdir().unwrap();
        assert_eq!(read(dir.path()).unwrap_err(), "rostest wrote no results");
    }
}
