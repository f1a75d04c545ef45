//! Values that fixtures provide, and that tests and other fixtures read.

use serde_json::{Value, json};

use crate::driver::{Host, run_body};

/// Sets up a fixture whose `setup` has this body: the answer, and the host, which has ended.
fn set_up(body: &str) -> (Value, Host) {
    let mut host = Host::start();
    let source = format!("function FixtureManager.setup()\n{body}\nend\n");
    host.start_plugin("set-up-fixture", &source);
    let answer = host.answer();
    host.ask("tear-down-fixture");
    host.hang_up();
    assert!(host.end().0.success());
    (answer, host)
}

#[test]
fn a_fixture_provides_values_of_all_types() {
    let (answer, host) = set_up(
        "rtf.provide('port', 40123)\n\
         rtf.provide('gain', 40.0)\n\
         rtf.provide('least', math.mininteger)\n\
         rtf.provide('model', 'B\\xff')\n\
         rtf.provide('ready', false)\n\
         rtf.provide('limits', { -1.5, 1.5 })\n\
         rtf.provide('arm', { joints = { 'elbow', { max = 2 } }, rate = 7 })\n\
         rtf.provide('empty', {})",
    );
    assert_eq!(answer, json!({"outcome": "passed"}));
    let expected = [
        json!({"name": "port", "value": 40123}),
        json!({"name": "gain", "value": 40.0}),
        json!({"name": "least", "value": i64::MIN}),
        json!({"name": "model", "value": "B\u{fffd}"}),
        json!({"name": "ready", "value": false}),
        json!({"name": "limits", "value": [-1.5, 1.5]}),
        json!({"name": "arm", "value": {"joints": ["elbow", {"max": 2}], "rate": 7}}),
        json!({"name": "empty", "value": {}}),
    ];
    assert_eq!(host.all("provided"), expected.iter().collect::<Vec<_>>());
}

#[test]
fn a_value_that_json_does_not_have_is_an_error_of_the_caller() {
    let mixed =
        "contains a table that is neither a list without holes nor has only strings as keys";
    for (value, problem) in [
        ("nil", "is or contains a nil"),
        ("{ print }", "is or contains a function"),
        ("0 / 0", "is not a finite number"),
        ("{ math.huge }", "is not a finite number"),
        ("{ 1, 2, n = 2 }", mixed),
        ("{ 1, 2, nil, 4 }", mixed),
        ("{ [true] = 1 }", "contains a table with a boolean as key"),
        ("(function() local t = {} t.t = t return t end)()", "has more than 100 levels of tables"),
    ] {
        let (answer, host) = set_up(&format!("rtf.provide('a', {value}) rtf.report('never')"));
        assert_eq!(answer, json!({"outcome": "error"}), "{value}");
        assert_eq!(host.problem().unwrap(), format!("the value of `a` {problem}"), "{value}");
        assert_eq!(host.all("message")[0]["location"]["line"], 2, "{value}");
        assert_eq!((host.texts().len(), host.all("provided").len()), (1, 0), "{value}");
    }
}

const READ: &str = "\
    local limits = rtf.fixture_value('simulator.limits')\n\
    limits[1] = 'changed'\n\
    limits = rtf.fixture_value('simulator.limits')\n\
    rtf.report(math.type(rtf.fixture_value('simulator.port')) .. ' '\n\
      .. math.type(rtf.fixture_value('simulator.rate')) .. ' '\n\
      .. rtf.fixture_value('simulator.model') .. ' '\n\
      .. tostring(rtf.fixture_value('simulator.ready') == false) .. ' '\n\
      .. limits[1] .. ' ' .. limits[2].max .. ' ' .. tostring(limits[3]) .. ' ' .. #limits[4])\n\
    rtf.fixture_value('simulator.speed')\n\
    rtf.report('never')";

#[test]
fn a_plugin_reads_values() {
    let known =
        "simulator.port, simulator.rate, simulator.model, simulator.ready, simulator.limits";
    let expected = [
        "report: integer float Bär true -1.5 2 nil 0".to_owned(),
        format!("error: there is no fixture value \"simulator.speed\"; there are {known}"),
    ];
    for (answer, host) in [run_body(READ), set_up(READ)] {
        assert_eq!(host.texts(), expected);
        assert_eq!(host.all("message")[1]["location"]["line"], 10);
        assert_eq!(answer, json!({"outcome": "error"}));
    }
}

/// The runner reports the error: it knows the kind of the plug-in.
#[test]
fn a_test_can_call_provide() {
    let (answer, host) = run_body("rtf.provide('port', 1)");
    assert_eq!(host.all("provided"), [&json!({"name": "port", "value": 1})]);
    assert_eq!(answer, json!({"outcome": "passed"}));
}
