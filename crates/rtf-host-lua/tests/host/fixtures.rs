//! Fixtures: set-up, check, collapse, tear-down.

use serde_json::json;

use crate::driver::Host;

#[test]
fn a_fixture_is_set_up_checked_and_torn_down() {
    let mut host = Host::start();
    host.start_plugin(
        "set-up-fixture",
        "local well = true\n\
         function FixtureManager.setup(args) rtf.report(table.concat(args, ' ')) end\n\
         function FixtureManager.check() local was = well; well = false; return was end\n\
         function FixtureManager.tearDown() rtf.collapsed('the bus is silent') rtf.report('down') end\n",
    );
    assert_eq!(host.answer(), json!({"outcome": "passed"}));
    assert_eq!(host.ask("check-fixture"), json!({"outcome": "passed"}));
    assert_eq!(
        host.ask("check-fixture"),
        json!({"outcome": "failed", "reason": "check returned false"})
    );
    assert_eq!(host.ask("tear-down-fixture"), json!({"outcome": "passed"}));
    assert_eq!(host.all("collapsed"), [&json!({"reason": "the bus is silent"})]);
    assert_eq!(host.texts(), ["report: --rate 100", "report: down"]);
    host.hang_up();
    assert!(host.end().0.success());
}

#[test]
fn a_fixture_that_cannot_be_set_up_is_torn_down() {
    let cases = [
        ("return false", json!({"outcome": "error", "reason": "setup returned false"})),
        ("rtf.require(false, 'license')", json!({"outcome": "failed"})),
        ("rtf.error('no license')", json!({"outcome": "error"})),
    ];
    for (line, expected) in cases {
        let mut host = Host::start();
        let tear_down = "function FixtureManager.tearDown() rtf.report('down') end";
        host.start_plugin(
            "set-up-fixture",
            &format!("function FixtureManager.setup() {line} end\n{tear_down}"),
        );
        assert_eq!(host.answer(), expected, "{line}");
        assert_eq!(host.ask("tear-down-fixture"), json!({"outcome": "passed"}));
        assert_eq!(host.texts().last().unwrap(), "report: down");
    }
}

#[test]
fn a_fixture_without_check_is_well() {
    let mut host = Host::start();
    host.start_plugin("set-up-fixture", "function FixtureManager.setup() end");
    host.answer();
    assert_eq!(host.ask("check-fixture"), json!({"outcome": "passed"}));
}

#[test]
fn the_end_of_the_runner_ends_a_fixture_that_is_up() {
    let mut host = Host::start();
    host.start_plugin(
        "set-up-fixture",
        "function FixtureManager.tearDown() rtf.report('down') end",
    );
    host.answer();
    host.hang_up();
    assert_eq!(host.end().0.code(), Some(1));
    assert!(host.texts().is_empty());
}

#[test]
fn a_fixture_is_told_of_each_test() {
    let mut host = Host::start();
    host.start_plugin(
        "set-up-fixture",
        "function FixtureManager.testStarted(test) return test.name ~= 'refused' end\n\
         function FixtureManager.testFinished(test, verdict, reason)\n\
           rtf.report(('%d %s %d.%d %s: %s'):format(test.id, test.name, test.repetition,\n\
             test.attempt, verdict, reason))\n\
           rtf.measure('size', 3.5, 'MB')\n\
           rtf.attach('/proc/self/status', 'run.txt')\n\
         end\n",
    );
    let wanted = json!(["test-started", "test-finished"]);
    assert_eq!(host.answer(), json!({"outcome": "passed", "subscriptions": wanted}));
    let test = json!({"id": 3, "name": "Move", "repetition": 2, "attempt": 1});
    let passed = json!({"outcome": "passed"});
    assert_eq!(host.ask_with("test-started", json!({"test": test})), passed);
    let dir = tempfile::tempdir().unwrap();
    let keep = dir.path().join("kept");
    let ends = json!({"test": test, "verdict": "failed", "reason": "far", "attachments_dir": keep});
    assert_eq!(host.ask_with("test-finished", ends), passed);
    assert_eq!(host.texts(), ["report: 3 Move 2.1 failed: far"]);
    assert_eq!(host.all("measured")[0]["value"], 3.5);
    assert_eq!(host.all("attached")[0]["path"], json!(keep.join("1-run.txt")));
    let refused = json!({"id": 3, "name": "refused", "repetition": 1, "attempt": 1});
    let reason = json!({"outcome": "failed", "reason": "testStarted returned false"});
    assert_eq!(host.ask_with("test-started", json!({"test": refused})), reason);
}
