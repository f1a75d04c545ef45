//! Finds the framework of each test of CTest.
//!
//! A test whose program belongs to a known framework becomes a test of that type, so that
//! `rtf` shows its cases. Tests with properties that only CTest has stay tests of CTest.

use std::collections::{BTreeMap, HashSet};
use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::ctest::ListedTest;
use crate::suite_file::ImportedTest;

/// Properties of a test that the other types also have, or do not need.
const PORTABLE: [&str; 12] = [
    "WORKING_DIRECTORY",
    "TIMEOUT",
    "LABELS",
    "ENVIRONMENT",
    "REQUIRED_FILES",
    "SKIP_REGULAR_EXPRESSION",
    "COST",
    "PROCESSORS",
    "RUN_SERIAL",
    "RESOURCE_LOCK",
    "DISABLED",
    "DEF_SOURCE_LINE",
];

/// How `gtest_discover_tests` and `catch_discover_tests` recognise skipped tests.
const SKIP_EXPRESSIONS: [&str; 2] = [r"\[  SKIPPED \]", r"\[=* SKIPPED"];

/// Texts in programs, and the type of the program. The first match counts.
const MARKS: [(&[u8], &str); 6] = [
    (b"gtest_list_tests", "gtest"),
    (b"libgtest.so", "gtest"),
    (b"catch_discover_tests", "catch2"),
    (b"Catch2 v3", "catch2"),
    (b"[doctest] ", "doctest"),
    (b"boost_unit_test_framework", "boost"),
];

/// A test of another type without its name and its limits, and whether it is one case of many that
/// `gtest_discover_tests`, for example, has found.
type Recognized = (ImportedTest, bool);

/// The tests of a suite: recognised ones first, then one with the remaining tests.
pub fn tests(listed: &[ListedTest], build: &Path, config: Option<&str>) -> Vec<ImportedTest> {
    let needed: HashSet<&String> =
        listed.iter().flat_map(|test| test.property("DEPENDS")).collect();
    let mut imported: Vec<ImportedTest> = Vec::new();
    // Discovered tests by program and everything else that must be equal.
    let mut groups: BTreeMap<String, usize> = BTreeMap::new();
    let mut rest: Vec<&ListedTest> = Vec::new();
    for test in listed {
        let is_portable = is_portable(test, build) && !needed.contains(&test.name);
        let Some((found, is_discovered)) = is_portable.then(|| recognize(test)).flatten() else {
            rest.push(test);
            continue;
        };
        let key = format!("{} {:?} {:?}", found.subject, found.args, found.env);
        if let (Some(&index), true) = (groups.get(&key), is_discovered) {
            imported[index].ctest_names.push(test.name.clone());
            continue;
        }
        if is_discovered {
            groups.insert(key, imported.len());
        }
        imported.push(import(test, found, is_discovered));
    }
    if !rest.is_empty() {
        imported.push(remaining(&rest, listed.len(), build, config));
    }
    imported
}

fn import(test: &ListedTest, found: ImportedTest, is_discovered: bool) -> ImportedTest {
    let timeout = test.property("TIMEOUT").first().filter(|limit| *limit != "0").cloned();
    let (timeout, case_timeout) = if is_discovered { (None, timeout) } else { (timeout, None) };
    let name = match is_discovered {
        true => Path::new(&found.subject).file_name().unwrap_or_default().to_string_lossy().into(),
        false => test.name.clone(),
    };
    ImportedTest {
        name,
        timeout,
        case_timeout,
        tags: test.property("LABELS").to_vec(),
        ctest_names: vec![test.name.clone()],
        ..found
    }
}

fn remaining(rest: &[&ListedTest], all: usize, build: &Path, config: Option<&str>) -> ImportedTest {
    let names = rest.iter().map(|test| test.name.clone());
    let cases = if rest.len() == all { Vec::new() } else { names.clone().collect() };
    let args = config.map_or(Vec::new(), |config| vec!["-C".to_owned(), config.to_owned()]);
    ImportedTest {
        kind: "ctest",
        name: "ctest".to_owned(),
        subject: build.to_string_lossy().into_owned(),
        args,
        cases,
        ctest_names: names.collect(),
        ..ImportedTest::default()
    }
}

/// Whether another type can run a test as CTest does.
fn is_portable(test: &ListedTest, build: &Path) -> bool {
    let program = real_command(test).0.first();
    let is_program = |file: &String| program == Some(file);
    let skips = test.property("SKIP_REGULAR_EXPRESSION");
    // By default, the directory of its `CMakeLists.txt` in the build directory. Any other
    // one was chosen, because the test needs it.
    let dir = test.property("WORKING_DIRECTORY").first();
    let is_discovered = test.command.iter().any(|arg| arg.starts_with("--gtest_filter="));
    test.properties().all(|name| PORTABLE.contains(&name))
        && skips.iter().all(|skip| SKIP_EXPRESSIONS.contains(&skip.as_str()))
        && test.property("REQUIRED_FILES").iter().all(is_program)
        && dir.is_none_or(|dir| Path::new(dir).starts_with(build))
        // gtest_discover_tests disables the tests that GoogleTest disables.
        && (test.property("DISABLED").is_empty() || is_discovered)
}

/// The command of a test, without the wrapper of ament, and the variables that this sets;
/// no command if the wrapper does more than that.
fn real_command(test: &ListedTest) -> (&[String], Vec<(String, String)>) {
    let command = test.command.as_slice();
    // `run_test_isolated.py` also chooses a domain of ROS 2, as rtf does.
    let is_wrapper = |word: &String| {
        word.ends_with("ament_cmake_test/cmake/run_test.py")
            || word.ends_with("ament_cmake_ros/cmake/run_test_isolated.py")
    };
    if !command.iter().take(3).any(is_wrapper) {
        return (command, Vec::new());
    }
    let Some(at) = command.iter().position(|word| word == "--command") else {
        return (&[], Vec::new());
    };
    let options = &command[..at];
    let is_other = |word: &String| word == "--append-env" || word.starts_with("--skip");
    if options.iter().any(is_other) {
        return (&[], Vec::new());
    }
    let env = options.iter().skip_while(|word| *word != "--env").skip(1);
    let env = env.map_while(|word| word.split_once('=').filter(|_| !word.starts_with("--")));
    let env = env.map(|(name, value)| (name.to_owned(), value.to_owned())).collect();
    (&command[at + 1..], env)
}

fn recognize(test: &ListedTest) -> Option<Recognized> {
    let (command, mut env) = real_command(test);
    let (program, args) = command.split_first()?;
    for assignment in test.property("ENVIRONMENT") {
        let (name, value) = assignment.split_once('=')?;
        env.push((name.to_owned(), value.to_owned()));
    }
    let name = Path::new(program).file_name()?.to_string_lossy();
    let module = args.iter().position(|arg| arg == "-m").filter(|_| name.starts_with("python"));
    let (module, args) = match module {
        Some(at) => (&**args.get(at + 1)?, &args[at + 2..]),
        None => (&*name, args),
    };
    match module {
        "launch_testing.launch_test" | "launch_test" => launch_testing(args, env),
        _ if module.starts_with("pytest") || module == "py.test" => pytest(args, env),
        _ => native(program, args, env),
    }
}

/// `python -m launch_testing.launch_test FILE NAME:=VALUE`, `launch_test …`.
fn launch_testing(args: &[String], env: Vec<(String, String)>) -> Option<Recognized> {
    let of_report =
        |arg: &str| arg.starts_with("--junit-xml=") || arg.starts_with("--package-name=");
    let mut kept = args.iter().filter(|arg| !arg.is_empty() && !of_report(arg)).cloned();
    let subject = kept.next().filter(|file| Path::new(file).is_absolute())?;
    let args: Vec<_> = kept.collect();
    let are_arguments = args.iter().all(|arg| arg.contains(":="));
    let kind = "launch_testing";
    let test = ImportedTest { kind, subject, args, env, ..ImportedTest::default() };
    are_arguments.then_some((test, false))
}

/// `python -m pytest PATH`, `pytest PATH`.
fn pytest(args: &[String], env: Vec<(String, String)>) -> Option<Recognized> {
    let mut kept = Vec::new();
    let mut paths = Vec::new();
    let mut args = args.iter();
    while let Some(arg) = args.next() {
        let is_cache = |option: &String| option.starts_with("cache_dir=");
        if arg == "-o" && args.as_slice().first().is_some_and(is_cache) {
            args.next();
        } else if arg.starts_with("--junit") || arg == "-rs" {
            // rtf writes reports itself.
        } else if Path::new(arg).is_absolute() {
            paths.push(arg.clone());
        } else {
            kept.push(arg.clone());
        }
    }
    let [subject] = paths.as_slice() else { return None };
    let subject = subject.clone();
    let test = ImportedTest { kind: "pytest", subject, args: kept, env, ..ImportedTest::default() };
    Some((test, false))
}

/// A program that is linked with a framework.
fn native(program: &str, args: &[String], env: Vec<(String, String)>) -> Option<Recognized> {
    let kind = kind_of(Path::new(program))?;
    let mut args: Vec<String> = args.to_vec();
    let mut is_case = false;
    match kind {
        "gtest" => {
            args.retain(|arg| !arg.starts_with("--gtest_output="));
            let is_discovered = args.iter().any(|arg| arg == "--gtest_also_run_disabled_tests");
            let at = args.iter().position(|arg| arg.starts_with("--gtest_filter="));
            match at {
                Some(at) if is_discovered => {
                    args.remove(at);
                    is_case = true;
                    args.retain(|arg| arg != "--gtest_also_run_disabled_tests");
                }
                // A filter of the user.
                Some(_) => return None,
                None => {}
            }
        }
        // `catch_discover_tests` passes the name of the test case first.
        "catch2" if args.first().is_some_and(|arg| !arg.starts_with('-')) => {
            args.remove(0);
            is_case = true;
        }
        // `doctest_discover_tests`
        "doctest" => {
            if let Some(at) = args.iter().position(|arg| arg.starts_with("--test-case=")) {
                args.remove(at);
                is_case = true;
            }
        }
        _ => {}
    }
    let subject = program.to_owned();
    Some((ImportedTest { kind, subject, args, env, ..ImportedTest::default() }, is_case))
}

/// The framework of a program, by texts in it.
fn kind_of(program: &Path) -> Option<&'static str> {
    let mut bytes = Vec::new();
    File::open(program).ok()?.read_to_end(&mut bytes).ok()?;
    if !bytes.starts_with(b"\x7fELF") {
        return None;
    }
    let contains = |mark: &[u8]| bytes.windows(mark.len()).any(|piece| piece == mark);
    MARKS.iter().find(|(mark, _)| contains(mark)).map(|(_, kind)| *kind)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RUN_TEST: &str = "/usr/share/ament_cmake_test/cmake/run_test.py";

    /// A program that contains the mark of GoogleTest.
    fn program(dir: &Path, mark: &str) -> String {
        let file = dir.join("arm_test");
        std::fs::write(&file, format!("\u{7f}ELF {mark}")).unwrap();
        file.to_string_lossy().into_owned()
    }

    fn shown(tests: &[ImportedTest]) -> Vec<String> {
        tests
            .iter()
            .map(|test| {
                let ImportedTest { kind, name, args, cases, .. } = test;
                format!("{kind} {name} {args:?} {cases:?} {}", test.ctest_names.join("+"))
            })
            .collect()
    }

    #[test]
    fn discovered_tests_are_one_test() {
        let dir = tempfile::tempdir().unwrap();
        let arm = program(dir.path(), "--gtest_list_tests");
        let discovered = |name: &str| {
            let filter = format!("--gtest_filter={name}");
            let command = [arm.as_str(), &filter, "--gtest_also_run_disabled_tests"];
            ListedTest::new(
                name,
                &command,
                &[("SKIP_REGULAR_EXPRESSION", r"\[  SKIPPED \]"), ("TIMEOUT", "9")],
            )
        };
        let own_filter = ListedTest::new("own", &[&arm, "--gtest_filter=A.*"], &[]);
        let with_args = ListedTest::new("args", &[&arm, "--robot", "sim"], &[("LABELS", "slow")]);
        let inverted = ListedTest::new("inverted", &[&arm], &[("WILL_FAIL", "true")]);
        let elsewhere = ListedTest::new("elsewhere", &[&arm], &[("WORKING_DIRECTORY", "/usr")]);
        let first = ListedTest::new("first", &[&arm], &[]);
        let second = ListedTest::new("second", &["/bin/sh"], &[("DEPENDS", "first")]);
        let listed = [
            discovered("A.a"),
            own_filter,
            discovered("A.b"),
            with_args,
            inverted,
            elsewhere,
            first,
            second,
        ];
        let tests = tests(&listed, dir.path(), None);
        let expected = [
            "gtest arm_test [] [] A.a+A.b",
            r#"gtest args ["--robot", "sim"] [] args"#,
            r#"ctest ctest [] ["own", "inverted", "elsewhere", "first", "second"] own+inverted+elsewhere+first+second"#,
        ];
        assert_eq!(shown(&tests), expected);
        assert_eq!(tests[0].case_timeout.as_deref(), Some("9"));
        assert_eq!(tests[1].tags, ["slow"]);
    }

    #[test]
    fn the_wrapper_of_ament_is_removed() {
        let dir = tempfile::tempdir().unwrap();
        let arm = program(dir.path(), "libgtest.so.1.12");
        let wrapper = ["/usr/bin/python3", "-u", RUN_TEST, "r.xml", "--package-name", "arm"];
        let command = |options: &[&str], rest: &[&str]| {
            let words = [&wrapper[..], options, &["--command"], rest].concat();
            ListedTest::new("test_arm", &words, &[("REQUIRED_FILES", &arm), ("TIMEOUT", "600")])
        };
        let gtest = command(
            &["--env", "A=1", "B=x=y", "--output-file", "o"],
            &[&arm, "--gtest_output=xml:r.xml"],
        );
        let found = tests(&[gtest], dir.path(), None);
        assert_eq!(shown(&found), ["gtest test_arm [] [] test_arm"]);
        let env =
            [("A", "1"), ("B", "x=y")].map(|(name, value)| (name.to_owned(), value.to_owned()));
        assert_eq!(found[0].env, env);
        assert_eq!(found[0].timeout.as_deref(), Some("600"));
        let skipped = command(&["--skip-test"], &[&arm]);
        assert_eq!(shown(&tests(&[skipped], dir.path(), None)), ["ctest ctest [] [] test_arm"]);
    }

    #[test]
    fn launch_tests_without_the_options_for_reports() {
        let isolated = "/opt/ros/share/ament_cmake_ros/cmake/run_test_isolated.py";
        let command = format!(
            "/usr/bin/python3 -u {isolated} r.xml --package-name arm --command \
             /usr/bin/python3 -m launch_testing.launch_test /p/arm_launch_test.py side:=left \
             --junit-xml=r.xml --package-name=arm"
        );
        let words: Vec<&str> = command.split_whitespace().collect();
        let listed = [ListedTest::new("test_arm", &words, &[("TIMEOUT", "60")])];
        let found = tests(&listed, Path::new("/b"), None);
        assert_eq!(shown(&found), [r#"launch_testing test_arm ["side:=left"] [] test_arm"#]);
        assert_eq!(found[0].subject, "/p/arm_launch_test.py");
        let with_option = ListedTest::new("shown", &["launch_test", "/a.py", "--show-args"], &[]);
        assert_eq!(
            shown(&tests(&[with_option], Path::new("/b"), None)),
            ["ctest ctest [] [] shown"]
        );
    }

    #[test]
    fn pytest_without_the_options_for_reports() {
        let command =
            "/usr/bin/python3 -u -m pytest /p/test_py.py -o cache_dir=/c --junit-xml=x -k fast";
        let words: Vec<&str> = command.split(' ').collect();
        let listed = [ListedTest::new("test_py", &words, &[])];
        let found = tests(&listed, Path::new("/b"), None);
        assert_eq!(shown(&found), [r#"pytest test_py ["-k", "fast"] [] test_py"#]);
        assert_eq!(found[0].subject, "/p/test_py.py");
        // Two files are not one test.
        let listed = [ListedTest::new("two", &["pytest", "/a.py", "/b.py"], &[])];
        assert_eq!(
            shown(&tests(&listed, Path::new("/b"), Some("Debug"))),
            [r#"ctest ctest ["-C", "Debug"] [] two"#]
        );
    }
}
