//! Requests, stop requests and their answers.

use crate::script_host::Runner;

#[test]
fn a_test_announces_its_phases_and_passes() {
    let (mut runner, host) = Runner::start();
    runner.ask("run-test", "report:a;report:b;report:c");
    let expected = [
        r#"{"jsonrpc":"2.0","method":"phase","params":{"phase":"setup"}}"#,
        r#"{"jsonrpc":"2.0","method":"message","params":{"kind":"report","text":"a"}}"#,
        r#"{"jsonrpc":"2.0","method":"phase","params":{"phase":"run"}}"#,
        r#"{"jsonrpc":"2.0","method":"message","params":{"kind":"report","text":"b"}}"#,
        r#"{"jsonrpc":"2.0","method":"phase","params":{"phase":"tear-down"}}"#,
        r#"{"jsonrpc":"2.0","method":"message","params":{"kind":"report","text":"c"}}"#,
        r#"{"jsonrpc":"2.0","id":1,"result":{"outcome":"passed"}}"#,
    ];
    for line in expected {
        assert_eq!(runner.line(), line);
    }
    drop(runner);
    host.join().unwrap().unwrap();
}

#[test]
fn the_answer_has_a_reason_only_for_problems_that_were_not_reported() {
    let (mut runner, _host) = Runner::start();
    for (script, result) in [
        ("report:;fail:f,error:e;error:t", r#""outcome":"failed""#),
        ("report:;error:e,fail:f;report:", r#""outcome":"error""#),
        ("fail:f;stop;report:", r#""outcome":"failed""#),
        ("false;fail:never;report:", r#""outcome":"error","reason":"setup returned false""#),
        ("report:;false;report:", r#""outcome":"failed","reason":"run returned false""#),
        ("report:;report:;fail:t", r#""outcome":"failed""#),
        ("report:;throw:int;report:", r#""outcome":"error""#),
        ("report:;stop;report:", r#""outcome":"error","reason":"run stopped without a reason""#),
        ("report:;measure:1.5,measure:3;report:", r#""outcome":"failed""#),
        ("report:;measure:x;report:", r#""outcome":"failed""#),
        ("report:;sample:1@0.5,sample:3@1.25;report:", r#""outcome":"failed""#),
        ("missing", r#""outcome":"error""#),
        ("report:;report:;report:", r#""outcome":"passed""#),
    ] {
        assert_eq!(runner.run_test(script), result, "{script}");
    }
}

#[test]
fn after_a_failed_set_up_the_test_is_only_torn_down() {
    let (mut runner, _host) = Runner::start();
    runner.ask("run-test", "false;report:never;report:torn down");
    let phases: Vec<String> = (0..3).map(|_| runner.line()).collect();
    assert!(phases[0].contains("setup") && phases[1].contains("tear-down"), "{phases:?}");
    assert!(phases[2].contains("torn down"), "{phases:?}");
    assert!(runner.result().contains("setup returned false"));
}

#[test]
fn a_stop_request_ends_a_sleep_but_not_the_one_in_tear_down() {
    let (mut runner, _host) = Runner::start();
    runner.ask("run-test", "report:;report:sleeping,sleep;report:parking,sleep");
    while !runner.line().contains("sleeping") {}
    runner.send(r#"{"jsonrpc":"2.0","method":"interrupt","params":{"reason":"Ctrl-C"}}"#);
    while !runner.line().contains("parking") {}
    runner.send(r#"{"method":"dump-stack"}"#);
    assert!(runner.line().contains(r#""method":"stack""#), "it still sleeps");
    runner.send(r#"{"jsonrpc":"2.0","method":"interrupt","params":{"reason":"again"}}"#);
    assert_eq!(runner.result(), r#""outcome":"interrupted","reason":"Ctrl-C""#);
    assert_eq!(runner.run_test("report:;report:;report:"), r#""outcome":"passed""#);
}

#[test]
fn a_stop_request_that_crosses_the_answer_stops_nothing() {
    let (mut runner, _host) = Runner::start();
    assert_eq!(runner.run_test("report:;report:;report:"), r#""outcome":"passed""#);
    runner.send(r#"{"jsonrpc":"2.0","method":"interrupt","params":{"reason":"late"}}"#);
    assert_eq!(runner.run_test("report:;report:;report:"), r#""outcome":"passed""#);
}

#[test]
fn a_fixture_is_set_up_checked_and_torn_down() {
    let (mut runner, _host) = Runner::start();
    runner.ask("set-up-fixture", "report:;false;report:");
    assert_eq!(runner.result(), r#""outcome":"passed""#);
    runner.ask("check-fixture", "");
    assert_eq!(runner.result(), r#""outcome":"failed","reason":"check returned false""#);
    runner.ask("run-test", "report:;report:;report:");
    assert!(runner.result().contains("a fixture is still set up"));
    runner.ask("tear-down-fixture", "");
    assert_eq!(runner.result(), r#""outcome":"passed""#);
    runner.ask("check-fixture", "");
    assert_eq!(runner.result(), r#""outcome":"error","reason":"no fixture is set up""#);
    runner.ask("set-up-fixture", "error:no power;report:;report:");
    assert_eq!(runner.result(), r#""outcome":"error""#);
    runner.ask("tear-down-fixture", "");
    assert_eq!(runner.result(), r#""outcome":"passed""#);
}

#[test]
fn invalid_lines_are_refused_and_the_host_continues() {
    let (mut runner, _host) = Runner::silent();
    for (line, code) in [
        (r#"{"id":1,"method":"check-fixture","params":{}}"#, "-32600"),
        (r#"{"id":1,"method":"initialize","params":{"protocol":2,"rtf":"9"}}"#, "-32001"),
        (r#"{"id":1,"method":"initialize"}"#, "-32602"),
        (r#"{"id":1,"method":"dance"}"#, "-32601"),
        ("]", "-32700"),
    ] {
        runner.send(line);
        let answer = runner.line();
        assert!(answer.contains(&format!(r#""error":{{"code":{code},"#)), "{line} → {answer}");
    }
    runner.send(r#"{"id":1,"method":"initialize","params":{"protocol":1,"rtf":"9"}}"#);
    assert!(runner.line().contains("result"));
}

#[test]
fn stacks_are_dumped_while_the_plugin_hangs() {
    let (mut runner, _host) = Runner::start();
    runner.ask("run-test", "report:;report:hanging,sleep;report:");
    while !runner.line().contains("hanging") {}
    runner.send(r#"{"method":"dump-stack"}"#);
    let stack = r#"{"jsonrpc":"2.0","method":"stack","params":{"text":"here"}}"#;
    assert_eq!(runner.line(), stack);
    runner.send(r#"{"method":"interrupt","params":{"reason":"too slow"}}"#);
    assert_eq!(runner.result(), r#""outcome":"interrupted","reason":"too slow""#);
}

#[test]
fn the_last_test_ends_the_host() {
    let (mut runner, host) = Runner::start();
    let params = r#"{"file":"report:;report:;report:","name":"T","is_last":true}"#;
    runner.send(&format!(r#"{{"id":1,"method":"run-test","params":{params}}}"#));
    assert_eq!(runner.result(), r#""outcome":"passed""#);
    host.join().unwrap().unwrap();
}
