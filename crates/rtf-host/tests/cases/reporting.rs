//! Cases, their messages and results, and the samples in them.

use std::time::Duration;

use rtf_host::{CaseEnd, Sample, Session, Step, StepEnd};
use rtf_model::{Measurement, MessageKind, Parameter};
use serde_json::json;

use crate::script_host::{Runner, all, case, done, in_run, report, send};

#[test]
fn a_case_has_a_number_parameters_and_a_location() {
    let mut runner = Runner::start(in_run!(session, {
        let parameter = Parameter { name: "joint".to_owned(), value: "3".to_owned() };
        let location = rtf_model::Location { file: "arm.cpp".to_owned(), line: 7 };
        assert!(session.begin_case("pose".to_owned(), vec![parameter], Some(location)));
        session.end_case(CaseEnd::Done);
    }));
    runner.send(&json!({"id": 1, "method": "run-test", "params": {"file": "f", "name": "T"}}));
    let started = std::iter::repeat_with(|| runner.line())
        .find(|line| line["method"] == "case-started")
        .unwrap();
    let expected = json!({
        "case": 1, "name": "pose", "parameters": [{"name": "joint", "value": "3"}],
        "location": {"file": "arm.cpp", "line": 7},
    });
    assert_eq!(started["params"], expected);
    let expected = json!({"jsonrpc": "2.0", "method": "case-finished", "params": {"case": 1}});
    assert_eq!(runner.line(), expected);
    while runner.line()["id"] != 1 {}
}

#[test]
fn nested_cases_know_their_parent_and_messages_their_case() {
    let (lines, _) = all(in_run!(session, {
        report(session, "before");
        case(session, "Arm", || {
            case(session, "Moves", || {
                report(session, "moving");
                CaseEnd::Done
            });
            report(session, "moved");
            CaseEnd::Done
        });
        report(session, "after");
    }));
    let expected = [
        "report in -: before",
        "start 1 in -: Arm",
        "start 2 in 1: Moves",
        "report in 2: moving",
        "end 2",
        "report in 1: moved",
        "end 1",
        "report in -: after",
    ];
    assert_eq!(lines, expected);
}

#[test]
fn samples_and_measurements_belong_to_their_case() {
    let (lines, _) = all(in_run!(session, {
        let sample = || {
            let (low, high, time, place) = (None, None, None, None);
            session.sample(&Sample { name: "I", value: 1.0, unit: "A", low, high, time, place })
        };
        sample();
        case(session, "a", || {
            sample();
            sample();
            let (low, high, location, case) = (None, None, None, None);
            let (name, unit) = ("t".to_owned(), "s".to_owned());
            let value = Some(1.0);
            session.measure(Measurement {
                learned: false,
                name,
                value,
                unit,
                low,
                high,
                location,
                case,
            });
            sample();
            CaseEnd::Done
        });
        sample();
    }));
    let expected = [
        "1 samples in -",
        "start 1 in -: a",
        "2 samples in 1",
        "measured in 1",
        "1 samples in 1",
        "end 1",
        "1 samples in -",
    ];
    assert_eq!(lines, expected);
}

#[test]
fn a_case_that_stops_without_a_reason_is_an_error() {
    let (lines, _) = all(in_run!(session, {
        case(session, "silent", || CaseEnd::Stopped);
        case(session, "outer", || {
            case(session, "inner", || {
                send(session, MessageKind::Failure, "it moves");
                CaseEnd::Stopped
            });
            CaseEnd::Stopped
        });
    }));
    assert_eq!(lines[1], "end 1 error the case stopped without a reason");
    assert_eq!(lines[4..], ["failure in 3: it moves", "end 3", "end 2"]);
}

#[test]
fn a_name_that_is_too_long_for_a_line_is_an_error() {
    let (lines, result) = all(in_run!(session, {
        case(session, &"x".repeat(17 * 1024 * 1024), || panic!("the body must not run"));
        done(session, "next");
    }));
    let error = "the names or parameters of cases are longer than a line of the protocol";
    assert_eq!(lines, [&format!("error in -: {error}"), "start 1 in -: next", "end 1"]);
    assert_eq!(result, json!({"outcome": "error"}));
}

#[test]
fn after_a_stop_request_no_case_starts_and_none_finishes() {
    let mut runner = Runner::start(in_run!(session, {
        case(session, "open", || {
            report(session, "waiting");
            assert!(session.wait(Duration::from_secs(20)));
            CaseEnd::Stopped
        });
        case(session, "next", || panic!("the body must not run"));
    }));
    runner.send(&json!({"id": 1, "method": "run-test", "params": {"file": "f", "name": "T"}}));
    while runner.line()["params"]["text"] != "waiting" {}
    runner.send(&json!({"method": "interrupt", "params": {"reason": "Ctrl-C"}}));
    let mut lines = Vec::new();
    let result = loop {
        let line = runner.line();
        if line["id"] == 1 {
            break line["result"].clone();
        }
        lines.push(line);
    };
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert_eq!(lines[0]["params"]["phase"], "tear-down");
    assert_eq!(result, json!({"outcome": "interrupted", "reason": "Ctrl-C"}));
}
