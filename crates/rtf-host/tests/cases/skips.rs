//! Skipped cases and tests; calls that are not allowed.

use rtf_host::{CaseEnd, Session, Step, StepEnd};
use rtf_model::MessageKind;
use serde_json::json;

use crate::script_host::{Runner, Script, all, case, done, in_run, send};

#[test]
fn a_skip_ends_the_innermost_case_or_the_test() {
    let (lines, result) = all(in_run!(session, {
        case(session, "gripper", || {
            session.skip("it is not mounted");
            CaseEnd::Stopped
        });
        done(session, "arm");
    }));
    let expected = ["start 1 in -: gripper", "end 1 skipped it is not mounted"];
    assert_eq!(lines[..2], expected);
    assert_eq!(result, json!({"outcome": "passed"}));
    let (_, result) = all(|session, step| {
        assert_ne!(step, Step::Run, "a skipped set-up is not followed by run");
        if step == Step::Setup {
            session.skip("no camera");
        }
        StepEnd::Stopped
    });
    assert_eq!(result, json!({"outcome": "skipped", "reason": "no camera"}));
}

#[test]
fn a_problem_before_or_after_a_skip_has_precedence() {
    let (_, result) = all(in_run!(session, {
        send(session, MessageKind::Failure, "it moves");
        session.skip("no camera");
    }));
    assert_eq!(result, json!({"outcome": "failed"}));
    let (_, result) = all(|session, step| {
        match step {
            Step::Run => session.skip("no camera"),
            Step::TearDown => send(session, MessageKind::Error, "no power"),
            Step::Setup | Step::Check => {}
        }
        StepEnd::Done
    });
    assert_eq!(result, json!({"outcome": "error"}));
}

#[test]
fn cases_and_skips_are_errors_elsewhere() {
    for (wrong, script) in [
        (
            "cases are allowed in `run` only",
            (|session, step| {
                if step == Step::Setup {
                    case(session, "early", || panic!("the body must not run"));
                }
                StepEnd::Done
            }) as Script,
        ),
        ("`skip` is allowed in `setup` and `run` only", |session, step| {
            if step == Step::TearDown {
                session.skip("late");
            }
            StepEnd::Done
        }),
        ("cases are planned in `setup` and `run` only", |session, step| {
            if step == Step::TearDown {
                session.plan_cases(vec!["late".to_owned()]);
            }
            StepEnd::Done
        }),
        ("a case was finished on a thread that has no open case", |session, step| {
            if step == Step::Run {
                session.end_case(CaseEnd::Done);
            }
            StepEnd::Done
        }),
    ] {
        let (lines, result) = all(script);
        assert_eq!(lines, [format!("error in -: {wrong}")]);
        assert_eq!(result, json!({"outcome": "error"}));
    }
    let mut fixture = Runner::start(|session, step| {
        if step == Step::Setup {
            case(session, "in a fixture", || panic!("the body must not run"));
            session.skip("no robot");
        }
        StepEnd::Done
    });
    let (lines, result) = fixture.ask("set-up-fixture", &json!([]));
    assert_eq!(lines.len(), 2, "{lines:?}");
    assert_eq!(result, json!({"outcome": "error"}));
    fixture.ask("tear-down-fixture", &json!([]));
}
