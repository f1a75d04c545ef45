//! The command line of robot-testing-framework 2.x: each option has the same meaning, and writes
//! the same files.

use insta::assert_snapshot;

use crate::support::{Finished, Folder};

const GOOD: &str = "TestCase.setup = function(param)
  robottestingframework.testReport('param: ' .. param .. ', environment: ' .. robottestingframework.getEnvironment())
  return true
end
TestCase.run = function() robottestingframework.testCheck(true, 'closed') end
TestCase.tearDown = function() robottestingframework.testReport('torn down') end
";
const BAD: &str = "TestCase.run = function()
  robottestingframework.testCheck(false, 'joint 3 moves')
  robottestingframework.assertError('no bus')
end
";

/// Two plug-ins, and two suites below.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("Good.lua", GOOD).file("Bad.lua", BAD);
    folder.file("suites/more/Deep.lua", GOOD).file("suites/launch.xml", "<robot/>");
    folder.file(
        "suites/arm.xml",
        "<suite name=\"arm\">\n  <environment>--robot sim</environment>\n  \
         <test type=\"lua\" param=\"--n 3\"> Good.lua </test>\n  \
         <test type=\"lua\"> Bad </test>\n</suite>\n",
    );
    folder.file("suites/more/leg.xml", "<suite name=\"leg\"><test>more/Deep.lua</test></suite>");
    // Both runners' rules find it there.
    folder.file("more/Deep.lua", GOOD);
    folder
}

/// What was printed, the result file with it.
fn shown(folder: &Folder, finished: &Finished, file: &str) -> String {
    let text = folder.shown(finished);
    let written = std::fs::read_to_string(folder.path().join(file));
    let written = written.unwrap_or_else(|_| "(is not there)\n".to_owned());
    format!("{text}----- {file}\n{}", folder.redact(&written))
}

#[test]
fn no_rtf_toml_holds() {
    let folder = folder();
    folder.file(
        "rtf.toml",
        "environment = \"--robot other\"\nresults = \"elsewhere\"\nno-such-key = 1\n",
    );
    let finished = folder.testrunner(&["-t", "Good.lua", "-v"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert!(finished.stdout.contains("environment: \n"), "{}", finished.stdout);
    assert!(!folder.path().join("elsewhere").exists());
}

#[test]
fn a_test_that_passes() {
    let folder = folder();
    let given = ["--param", "--from \"a b\"", "-e", "--robot icub"];
    let finished = folder.testrunner(&[["-t", "Good.lua"].as_slice(), &given].concat());
    assert_snapshot!(shown(&folder, &finished, "result.txt"), @r#"
    exit code 0
    ----- stdout

    ---------- results -----------
    Total number of test cases   : 1
    Number of passed test cases  : 1
    Number of failed test cases  : 0
    ----- stderr
    ----- result.txt
    Test case Good started...
    [INFO]  (Good) reports: param: --from "a b", environment: --robot icub
    [INFO]  (Good) checks: closed
    [INFO]  (Good) reports: torn down
    Test case Good passed!

    ---------- summary -----------
    Total number of test cases   : 1
    Number of passed test cases  : 1
    Number of failed test cases  : 0
    "#);
}

#[test]
fn a_suite_with_a_test_that_does_not() {
    let folder = folder();
    let finished = folder.testrunner(&["--suite", "suites/arm.xml"]);
    assert_snapshot!(shown(&folder, &finished, "result.txt"), @"
    exit code 1
    ----- stdout
    [FAIL]  (Bad) checks: joint 3 moves
    [ERROR] (Bad) no bus

    ---------- results -----------
    Total number of test suites  : 1
    Number of passed test suites : 0
    Number of failed test suites : 1
    Total number of test cases   : 2
    Number of passed test cases  : 1
    Number of failed test cases  : 1
    ----- stderr
    ----- result.txt
    Test suite arm started...
    Test case Good started...
    [INFO]  (Good) reports: param: --n 3, environment: --robot sim
    [INFO]  (Good) checks: closed
    [INFO]  (Good) reports: torn down
    Test case Good passed!
    Test case Bad started...
    [FAIL]  (Bad) checks: joint 3 moves
    [ERROR] (Bad) no bus
    Test case Bad failed!
    Test suite arm failed!

    ---------- summary -----------
    Total number of test suites  : 1
    Number of passed test suites : 0
    Number of failed test suites : 1
    Total number of test cases   : 2
    Number of passed test cases  : 1
    Number of failed test cases  : 1
    ");
    assert_eq!(folder.journal().record.tests.len(), 2, "`rtf show` knows the run");
}

#[test]
fn verbose_tells_what_passes_too_and_detail_where_it_is_written() {
    let folder = folder();
    let verbose = folder.testrunner(&["-v", "-s", "suites/arm.xml", "--no-summary"]);
    assert_snapshot!(folder.shown(&verbose), @"
    exit code 1
    ----- stdout
    Starting test runner.
    Test suite arm started...
    Test case Good started...
    [INFO]  (Good) reports: param: --n 3, environment: --robot sim
    [INFO]  (Good) checks: closed
    [INFO]  (Good) reports: torn down
    Test case Good passed!
    Test case Bad started...
    [FAIL]  (Bad) checks: joint 3 moves
    [ERROR] (Bad) no bus
    Test case Bad failed!
    Test suite arm failed!
    Ending test runner.
    ----- stderr
    ");
    let detail = folder.testrunner(&["--detail", "--test", "Bad.lua", "--no-output"]);
    assert_snapshot!(folder.shown(&detail), @"
    exit code 1
    ----- stdout
    [FAIL]  (Bad) checks: joint 3 moves
    [FOLDER]/Bad.lua at 2.

    [ERROR] (Bad) no bus
    [FOLDER]/Bad.lua at 3.


    ---------- results -----------
    Total number of test cases   : 1
    Number of passed test cases  : 0
    Number of failed test cases  : 1
    ----- stderr
    ");
    let both = folder.testrunner(&["-dv", "--test=Good.lua", "--no-summary"]);
    assert!(both.stdout.contains("(Good) checks: closed\n"), "{}", both.stdout);
    assert!(both.stdout.contains("/Good.lua at 5.\n\n"), "{}", both.stdout);
    assert!(folder.read("result.txt").contains("/Good.lua at 5.\n\n"));
}

#[test]
fn what_a_plug_in_prints_is_on_standard_output_and_not_in_the_file() {
    let folder = folder();
    folder.file("Prints.lua", "TestCase.run = function() print('motor current 7 A') end\n");
    let finished = folder.testrunner(&["-t", "Prints.lua", "--no-summary"]);
    assert_eq!((finished.stdout.as_str(), finished.code), ("motor current 7 A\n", Some(0)));
    assert!(!folder.read("result.txt").contains("motor"));
}

#[test]
fn folders_of_plug_ins_and_of_suites() {
    let folder = folder();
    let total = |args: &[&str]| {
        let finished = folder.testrunner(args);
        let text = finished.stdout + &finished.stderr;
        let block = text.split_once("-----------\n").map_or(text.as_str(), |(_, block)| block);
        block.lines().filter(|line| line.contains("Total")).collect::<Vec<_>>().join("; ")
    };
    assert_snapshot!(total(&["--tests", "."]), @"Total number of test cases   : 2");
    assert_snapshot!(total(&["--tests", ".", "-r"]), @"Total number of test cases   : 4");
    assert_snapshot!(total(&["--suites", "suites"]), @"Total number of test suites  : 1; Total number of test cases   : 2");
    assert_snapshot!(total(&["--suites", "suites", "--recursive"]), @"Total number of test suites  : 2; Total number of test cases   : 3");
    assert_snapshot!(total(&["--suites", "suites", "-t", "Good.lua", "--tests", "more"]), @"Total number of test suites  : 1; Total number of test cases   : 4");
}

#[test]
fn suites_of_1_x() {
    let folder = folder();
    let suite =
        folder.read("suites/arm.xml").replace("<suite", "<suit").replace("</suite>", "</suit>");
    std::fs::create_dir(folder.path().join("first")).expect("a directory");
    std::fs::write(folder.path().join("first/arm.xml"), suite).expect("a suite");
    for arguments in [["--suit", "first/arm.xml"], ["--suits", "first"]] {
        let finished = folder.testrunner(&arguments);
        assert!(
            finished.stdout.contains("Total number of test cases   : 2"),
            "{}",
            finished.stdout
        );
    }
}

#[test]
fn plug_ins_run_before_suites() {
    let folder = folder();
    folder.testrunner(&["--suites", "suites", "-t", "Bad.lua", "-p", "x", "--tests", "more"]);
    let text = folder.read("result.txt");
    let begun = text.lines().filter(|line| line.ends_with("started..."));
    assert_snapshot!(begun.collect::<Vec<_>>().join("\n"), @"
    Test case Bad started...
    Test case Deep started...
    Test suite arm started...
    Test case Good started...
    Test case Bad started...
    ");
    assert!(text.contains("(Deep) reports: param: , environment: \n"), "not for folders: {text}");
}

#[test]
fn a_test_runs_as_often_as_it_is_told() {
    let folder = folder();
    for (given, runs) in [("3", 3), ("1", 1), ("0", 1)] {
        let finished = folder.testrunner(&["-t", "Good.lua", "--repetition", given]);
        assert_eq!(finished.code, Some(0), "{}", finished.stderr);
        let text = folder.read("result.txt");
        assert_eq!(text.matches("checks: closed").count(), runs, "{text}");
        assert_eq!(text.matches("Test case Good").count(), 2, "{text}");
    }
}

#[test]
fn output_and_its_type() {
    let folder = folder();
    folder.testrunner(&["-t", "Good.lua", "--output-type", "junit"]);
    let junit = folder.read("result.xml");
    assert!(junit.contains("<testcase name=\"Good.lua\""), "{junit}");
    folder.testrunner(&["-t", "Good.lua", "-o", "out/x", "--output-type=junit"]);
    assert!(folder.read("out/x").contains("<testcase name=\"Good.lua\""));
    folder.testrunner(&["-t", "Good.lua", "--output", "out/y"]);
    assert!(folder.read("out/y").ends_with("Number of failed test cases  : 0\n"));
    assert!(!folder.path().join("result.txt").exists());
}

/// The class names of a JUnit report, and what the tests said.
fn junit_lines(folder: &Folder) -> String {
    let report = folder.redact(&folder.read("result.xml"));
    let lines =
        report.lines().map(str::trim).filter_map(|line| match line.strip_prefix("<testcase ") {
            Some(attributes) => attributes.split_once(" timestamp=").map(|(names, _)| names),
            None => line.strip_prefix("<system-out>").or(line.starts_with('[').then_some(line)),
        });
    lines.collect::<Vec<_>>().join("\n")
}

/// A server saw `Named#2` in the class `arm`, and what the test printed.
#[test]
fn a_junit_report_has_the_names_and_the_output_of_2_x() {
    let folder = folder();
    folder.file(
        "Named.lua",
        "TestCase.setup = function(param)
  if param ~= '' then robottestingframework.setName(param) end
  return true
end
TestCase.run = function() print('current 7 A') robottestingframework.testReport('on') end\n",
    );
    let test = |attributes: &str| format!("<test type='lua' {attributes}> Named.lua </test>");
    let tests = ["", "param='Right Leg'", "", "name='left' param='Left Leg'"].map(test).concat();
    folder.file("arm.xml", &format!("<suite name='arm'>{tests}<test> Bad.lua </test></suite>"));
    let junit = ["-t", "Good.lua", "-e", "lab", "--output-type", "junit"];
    folder.testrunner(&[junit.as_slice(), &["-s", "arm.xml"]].concat());
    assert_snapshot!(junit_lines(&folder), @r#"
    name="Good.lua" classname="default.Good.lua"
    [INFO]  (Good.lua) reports: param: , environment: lab
    [INFO]  (Good.lua) checks: closed
    [INFO]  (Good.lua) reports: torn down
    name="Named.lua" classname="arm.Named.lua"
    [INFO]  (Named.lua) reports: on
    name="Right Leg" classname="arm.Right Leg"
    [INFO]  (Right Leg) reports: on
    name="Named.lua" classname="arm.Named.lua"
    [INFO]  (Named.lua) reports: on
    name="left" classname="arm.left"
    [INFO]  (left) reports: on
    name="Bad.lua" classname="arm.Bad.lua"
    [FAIL]  (Bad.lua) checks: joint 3 moves
    [ERROR] (Bad.lua) no bus
    "#);
    folder.testrunner(&["-t", "Bad.lua", "--output-type", "junit", "--detail"]);
    assert_snapshot!(junit_lines(&folder), @r#"
    name="Bad.lua" classname="default.Bad.lua"
    [FAIL]  (Bad.lua) checks: joint 3 moves ([FOLDER]/Bad.lua at 2)
    [ERROR] (Bad.lua) no bus ([FOLDER]/Bad.lua at 3)
    "#);
}

#[test]
fn no_output_leaves_nothing_behind() {
    let folder = folder();
    let temporary = folder.path().join("tmp");
    std::fs::create_dir(&temporary).expect("a folder");
    let before = std::fs::read_dir(folder.path()).expect("a folder").count();
    let mut command = folder.testrunner_command(&["-t", "Bad.lua", "--no-output", "--no-summary"]);
    let output = command.env("TMPDIR", &temporary).output().expect("rtf runs");
    assert_eq!(output.status.code(), Some(1));
    let stdout = String::from_utf8_lossy(&output.stdout);
    assert!(stdout.contains("joint 3 moves") && !stdout.contains("Total"), "{stdout}");
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), before);
    assert_eq!(std::fs::read_dir(temporary).expect("a folder").count(), 0);
}

#[test]
fn version_and_help() {
    let folder = folder();
    assert_snapshot!(folder.shown(&folder.testrunner(&["--version"])), @"
    exit code 0
    ----- stdout
    robottestingframework-testrunner version 2.0.1 (compatible; rtf 0.1.0)
    ----- stderr
    ");
    assert_snapshot!(folder.shown(&folder.testrunner(&["--help"])), @"
    exit code 0
    ----- stdout
    The command line of robot-testing-framework 2.x, for existing scripts; `rtf run` has more options

    Usage: robottestingframework-testrunner [OPTIONS] (--test NAME | --tests DIR | --suite FILE | --suites DIR)...

    Options:
      -t, --test <NAME>         Run one plug-in
          --tests <DIR>         Run the plug-ins of a directory
      -s, --suite <FILE>        Run one suite
          --suites <DIR>        Run the suites of a directory
          --no-output           Write no result file and delete the results
          --no-summary          Print no summary
      -o, --output <FILE>       Result file [default: result.txt, or result.xml for junit]
          --output-type <TYPE>  Format of the result file: text or junit [default: text]
      -p, --param <TEXT>        Parameter string of --test
      -e, --environment <TEXT>  Environment string of --test
          --repetition <N>      Run --test N times
      -w, --web-reporter        Show the run in a browser
          --web-port <PORT>     Port of the web page [default: 8080]
      -r, --recursive           Search directories recursively
      -d, --detail              Print the source location of each message
      -v, --verbose             Print all messages, not only failures and errors
          --version             Print the version
      -?, --help                Print this help
    ----- stderr
    ");
    assert_eq!(folder.testrunner(&["-?"]).stdout, folder.testrunner(&["--help"]).stdout);
}

#[test]
fn what_is_no_option() {
    let folder = folder();
    assert_snapshot!(folder.shown(&folder.testrunner(&[])), @"
    exit code 1
    ----- stdout
    ----- stderr
    error: no test and no suite is given
    hint: add `--test`, `--tests`, `--suite` or `--suites`; `robottestingframework-testrunner --help` explains them
    ");
    assert_snapshot!(folder.shown(&folder.testrunner(&["--tset", "Good.lua"])), @"
    exit code 1
    ----- stdout
    ----- stderr
    error: unexpected argument '--tset' found

      tip: a similar argument exists: '--test'

    Usage: robottestingframework-testrunner [OPTIONS] (--test NAME | --tests DIR | --suite FILE | --suites DIR)...

    For more information, try '--help'.
    ");
    assert_snapshot!(folder.shown(&folder.testrunner(&["-t"])), @"
    exit code 1
    ----- stdout
    ----- stderr
    error: a value is required for '--test <NAME>' but none was supplied

    For more information, try '--help'.
    ");
    assert_snapshot!(folder.shown(&folder.testrunner(&["-t", "Good.lua", "more", "--no-output"])), @"
    exit code 0
    ----- stdout

    ---------- results -----------
    Total number of test cases   : 1
    Number of passed test cases  : 1
    Number of failed test cases  : 0
    ----- stderr
    warning: `more` is not an option, ignored
    ");
}

#[test]
fn a_value_may_look_like_an_option_and_the_last_one_counts() {
    let folder = folder();
    let finished = folder.testrunner(&["-t", "Bad.lua", "-t", "Good.lua", "-p", "x", "-p", "-v"]);
    assert_eq!(finished.code, Some(0), "{}", finished.stderr);
    assert!(folder.read("result.txt").contains("param: -v,"));
    assert!(!finished.stdout.contains("INFO"), "{}", finished.stdout);
}

/// Names in a suite start in the current folder, where the tests also work.
#[test]
fn the_current_folder_is_where_everything_is_looked_for() {
    let folder = folder();
    let here = "TestCase.run = function() io.open('here', 'w'):close() end\n";
    folder.file("Here.lua", here).file("suites/Here.lua", "error('the wrong one')\n");
    folder.file("suites/Beside.lua", here);
    folder.file(
        "suites/s.xml",
        "<suite name='s'><test>Here.lua</test><test>Beside.lua</test></suite>",
    );
    let finished = folder.testrunner(&["-s", "suites/s.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert!(folder.path().join("here").exists());
}
