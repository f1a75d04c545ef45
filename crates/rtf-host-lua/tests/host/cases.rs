//! Cases, skips and parameters.

use serde_json::json;

use crate::driver::{Host, run, run_body};

#[test]
fn a_case_has_parameters_and_a_location() {
    let (answer, host) = run_body(
        "rtf.case('pose', { joint = 3, dry = true, speed = 0.5 }, function() rtf.report('a') end)\n\
         rtf.case(4, function() end)",
    );
    assert_eq!(answer, json!({"outcome": "passed"}));
    let started = host.all("case-started");
    let parameters = json!([
        {"name": "dry", "value": "true"}, {"name": "joint", "value": "3"},
        {"name": "speed", "value": "0.5"},
    ]);
    assert_eq!(started[0]["parameters"], parameters);
    assert!(started[0]["location"]["file"].as_str().unwrap().ends_with("plugin.lua"));
    let lines = started.iter().map(|start| start["location"]["line"].as_u64().unwrap());
    let lines: Vec<u64> = lines.collect();
    assert_eq!(lines[1], lines[0] + 1);
    assert_eq!((&started[1]["name"], &started[1]["case"]), (&json!("4"), &json!(2)));
    assert_eq!(host.all("message")[0]["case"], 1);
}

#[test]
fn each_end_of_a_case_is_reported_and_the_test_continues() {
    for (line, outcome, problem) in [
        ("rtf.require(false, 'it moves')", "failed", "it moves"),
        ("rtf.fail('it moves')", "failed", "it moves"),
        ("rtf.error('no bench')", "error", "no bench"),
        ("error('surprise')", "error", "surprise"),
        ("error({ code = 42 })", "error", "an error of type table was raised: {code = 42}"),
        (
            "rtf.parameter('speed')",
            "error",
            "there is no parameter \"speed\"; this test has joint, side",
        ),
        (
            "rtf.wait_until(function() return false end, 0.02, 'rest')",
            "failed",
            "rest: not within 0.02 s (last value: false)",
        ),
    ] {
        let body = format!(
            "rtf.case('a', function() {line} rtf.report('never') end)\n\
             rtf.case('b', function() end) rtf.report('after')"
        );
        let (answer, host) = run_body(&body);
        assert_eq!(answer, json!({"outcome": outcome}), "{line}");
        assert!(host.problem().unwrap().starts_with(problem), "{line}: {:?}", host.problem());
        assert_eq!(host.all("case-finished"), [&json!({"case": 1}), &json!({"case": 2})], "{line}");
        let texts = host.texts();
        assert!(!texts.contains(&"report: never".to_owned()), "{line}");
        assert_eq!(texts.last().unwrap(), "report: after", "{line}");
    }
}

#[test]
fn a_critical_assertion_ends_its_cases_and_the_test() {
    let (answer, host) = run_body(
        "rtf.case('arm', function()\n\
           rtf.case('free', function() rtf.require_critical(false, 'it is free') end)\n\
           rtf.report('never')\n\
         end) rtf.report('never')",
    );
    assert_eq!(answer, json!({"outcome": "failed"}));
    assert_eq!(host.texts(), ["failure: it is free"]);
    assert_eq!(host.all("case-finished"), [&json!({"case": 2}), &json!({"case": 1})]);
}

#[test]
fn a_skip_ends_the_case_or_the_test() {
    let (answer, host) = run_body(
        "rtf.case('gripper', function() rtf.skip('not mounted') end) rtf.report('on')\n\
         rtf.skip('no camera')",
    );
    assert_eq!(answer, json!({"outcome": "skipped", "reason": "no camera"}));
    let end = json!({"case": 1, "outcome": "skipped", "reason": "not mounted"});
    assert_eq!(host.all("case-finished"), [&end]);
    assert_eq!(host.texts(), ["report: on"]);
}

#[test]
fn cases_and_skips_elsewhere_are_errors() {
    let (answer, host) = run(
        "function TestCase.setup() rtf.case('early', function() rtf.report('never') end) end\n\
         function TestCase.run() rtf.report('never') end\n\
         function TestCase.tearDown() rtf.skip('late') end",
    );
    assert_eq!(answer, json!({"outcome": "error"}));
    let expected = [
        "error: cases are allowed in `run` only",
        "error: `skip` is allowed in `setup` and `run` only",
    ];
    assert_eq!(host.texts(), expected);
}

#[test]
fn wrong_arguments_are_errors_of_the_caller() {
    for (line, problem) in [
        (
            "rtf.case('a')",
            "case takes a name, a table of parameters that can be omitted, and a function",
        ),
        ("rtf.case('a', 3, function() end)", "case takes a name,"),
        ("rtf.plan_cases('a')", "plan_cases takes a table of names, not a"),
    ] {
        let (answer, host) = run_body(line);
        assert_eq!(answer, json!({"outcome": "error"}), "{line}");
        assert!(host.problem().unwrap().starts_with(problem), "{line}: {:?}", host.problem());
    }
}

#[test]
fn a_test_reads_its_values_of_a_matrix() {
    let (_, host) = run_body(
        "local all = rtf.parameters()\n\
         rtf.report(rtf.parameter('joint') .. all.joint .. all.side)",
    );
    assert_eq!(host.texts(), ["report: 33left"]);
}

#[test]
fn planned_cases_are_announced() {
    let (_, host) = run_body("rtf.plan_cases({ 'a', 2 })");
    assert_eq!(host.all("cases-planned"), [&json!({"names": ["a", "2"]})]);
}

#[test]
fn a_stop_request_ends_the_open_cases_and_the_test() {
    let mut host = Host::start();
    host.start_plugin(
        "run-test",
        "function TestCase.run()\n\
           rtf.case('outer', function()\n\
             rtf.case('inner', function() rtf.report('waiting') rtf.sleep(1000) end)\n\
             rtf.report('never')\n\
           end) rtf.report('never')\n\
         end",
    );
    while host.wait_for("message")["text"] != "waiting" {}
    host.send(None, "interrupt", json!({"reason": "Ctrl-C"}));
    assert_eq!(host.answer(), json!({"outcome": "interrupted", "reason": "Ctrl-C"}));
    assert_eq!(host.texts(), ["report: waiting"]);
    assert!(host.all("case-finished").is_empty());
}
