//! The outcome of a test.

use serde_json::json;

use crate::driver::{Host, run, run_body};

const TEAR_DOWN: &str = "function TestCase.tearDown() rtf.report('torn down') end\n";

#[test]
fn a_pass_goes_through_all_steps() {
    let (answer, host) = run_body("rtf.report('hello') rtf.check(1 == 1, 'one is one')");
    assert_eq!(answer, json!({"outcome": "passed"}));
    assert_eq!(host.texts(), ["report: hello", "check: one is one"]);
    let phases: Vec<_> = host.all("phase").iter().map(|phase| phase["phase"].clone()).collect();
    assert_eq!(phases, ["setup", "run", "tear-down"]);
}

/// The predecessor passed `testCheck(nil, …)`, took `%` in a text for a format,
/// and left out the tear-down after an assertion (defect 9 of its list).
#[test]
fn a_problem_is_reported_and_the_test_torn_down() {
    let cases = [
        ("rtf.check(false, 'closed')", "failed", "closed", true),
        ("rtf.check(nil, 'closed')", "failed", "closed", true),
        ("rtf.require(nil, 'calibrated')", "failed", "calibrated", false),
        ("rtf.require_critical(false, 'stop pressed')", "failed", "stop pressed", false),
        ("rtf.fail('50% too fast, %s %d')", "failed", "50% too fast, %s %d", false),
        ("rtf.error('no encoder')", "error", "no encoder", false),
        ("pcall(rtf.require, false, 'caught')", "failed", "caught", true),
        ("coroutine.wrap(function() rtf.fail('inside') end)()", "failed", "inside", false),
    ];
    for (line, outcome, problem, continues) in cases {
        let run_function =
            format!("function TestCase.run()\n{line}\nrtf.report('on') rtf.fail('later') end\n");
        let (answer, host) = run(&format!("{run_function}{TEAR_DOWN}"));
        assert_eq!(answer, json!({"outcome": outcome}), "{line}");
        assert_eq!(host.problem().unwrap(), problem, "{line}");
        assert_eq!(host.texts().contains(&"report: on".to_owned()), continues, "{line}");
        assert_eq!(host.texts().last().unwrap(), "report: torn down", "{line}");
    }
}

#[test]
fn a_raised_value_is_an_error_with_type_text_location_and_traceback() {
    let cases = [
        ("error('no bus')", "no bus"),
        ("local joint = nil; joint.move()", "attempt to index a nil value (local 'joint')"),
        (
            "error({ code = 42, axis = 'x' })",
            "an error of type table was raised: {axis = 'x', code = 42}",
        ),
        ("error(42)", "an error of type number was raised: 42"),
        ("error(nil)", "an error of type nil was raised: nil"),
        (
            "error(setmetatable({}, { __tostring = function() return 'E17' end }))",
            "an error of type table was raised: E17",
        ),
    ];
    for (line, text) in cases {
        let (answer, host) = run_body(line);
        assert_eq!(answer["outcome"], "error", "{line}");
        let message = host.all("message")[0];
        let lines: Vec<_> = message["text"].as_str().unwrap().lines().collect();
        assert_eq!(lines[..2], [text, "stack traceback:"], "{line}");
        assert!(lines.iter().any(|line| line.contains("plugin.lua:2:")), "{lines:?}");
        let file = host.dir.path().join("plugin.lua");
        assert_eq!(message["location"], json!({"file": file, "line": 2}), "{line}");
    }
}

#[test]
fn an_endless_recursion_is_an_error() {
    let (answer, host) =
        run("local function deeper() return 1 + deeper() end\nTestCase.run = deeper\n");
    assert_eq!(answer["outcome"], "error");
    assert!(host.problem().unwrap().contains("stack overflow"), "{:?}", host.texts());
}

#[test]
fn after_a_problem_in_setup_run_is_not_called() {
    let cases = [
        ("return false", json!({"outcome": "error", "reason": "setup returned false"})),
        ("rtf.check(false, 'power')", json!({"outcome": "failed"})),
        ("rtf.require(false, 'power')", json!({"outcome": "failed"})),
        ("rtf.error('no power')", json!({"outcome": "error"})),
    ];
    for (line, expected) in cases {
        let source = format!(
            "function TestCase.setup()\n{line}\nend\nfunction TestCase.run() rtf.report('never') end\n{TEAR_DOWN}"
        );
        let (answer, host) = run(&source);
        assert_eq!(answer, expected, "{line}");
        assert_eq!(host.all("phase").len(), 2);
        assert_eq!(host.texts().last().unwrap(), "report: torn down");
    }
}

#[test]
fn only_false_fails_a_setup() {
    for returned in ["", "nil", "true", "0"] {
        let source = format!(
            "function TestCase.setup() return {returned} end\nfunction TestCase.run() end\n"
        );
        assert_eq!(run(&source).0, json!({"outcome": "passed"}), "{returned}");
    }
}

#[test]
fn a_problem_in_tear_down_does_not_pass() {
    let tear_down = "function TestCase.tearDown() rtf.check(false, 'parked') end\n";
    let (answer, host) = run(&format!("function TestCase.run() end\n{tear_down}"));
    assert_eq!(answer, json!({"outcome": "failed"}));
    assert_eq!(host.texts(), ["failure: parked"]);
}

#[test]
fn a_measurement_outside_its_limits_does_not_pass() {
    let (answer, host) = run_body("rtf.measure('rate', 87.5, 'Hz', 95, 105) rtf.report('on')");
    assert_eq!(answer, json!({"outcome": "failed"}));
    assert_eq!(host.texts(), ["report: on"]);
}

#[test]
fn os_exit_ends_the_process_without_an_answer() {
    let mut host = Host::start();
    host.start_plugin("run-test", "function TestCase.run() print('bye') rtf.fail('x') end\nfunction TestCase.tearDown() os.exit(0) end");
    let (status, printed) = host.end();
    assert!(status.success());
    assert_eq!(printed, "bye\n");
    assert!(host.seen.iter().all(|message| message["id"] != 1));
}

#[test]
fn finalizers_run_before_the_process_ends() {
    let mut host = Host::start();
    host.start_plugin(
        "run-test",
        "arm = setmetatable({}, { __gc = function() print('parked') end })\nfunction TestCase.run() io.write('a') end",
    );
    assert_eq!(host.answer(), json!({"outcome": "passed"}));
    assert_eq!(host.end().1, "aparked\n");
}
