//! Where reports, questions, resets and waits are legal in a stream of events.

use crate::order::{check, check_body, ready, starting, stopped, stopping};
use crate::support::*;
use rtf_model::{
    Attachment, EventKind, FixtureId, Measurement, Question, QuestionAsked, QuestionClosed,
    SuiteId, Verdict,
};

pub fn asked(question: u32) -> EventKind {
    let question = Question { question, text: "closed?".to_owned(), ..Question::default() };
    EventKind::QuestionAsked(Box::new(QuestionAsked { test: TEST, question }))
}

fn answered(question: u32) -> EventKind {
    let (answer, by, reason) = (Some("yes".to_owned()), None, None);
    EventKind::QuestionClosed(QuestionClosed { test: TEST, question, answer, by, reason })
}

fn measured(fixture: Option<FixtureId>) -> EventKind {
    let measurement = Measurement {
        name: "lag".to_owned(),
        value: Some(0.1),
        unit: "s".to_owned(),
        low: None,
        high: None,
        learned: false,
        location: None,
        case: None,
    };
    EventKind::Measured { test: TEST, fixture, measurement }
}

pub fn attached(fixture: Option<FixtureId>) -> EventKind {
    let attachment = Attachment {
        name: "log".to_owned(),
        path: "attachments/log.txt".to_owned(),
        media_type: "text/plain".to_owned(),
        case: None,
        picture: None,
        omitted: false,
    };
    EventKind::Attached { test: TEST, fixture, attachment }
}

#[test]
fn what_a_test_reports_lies_between_its_start_and_its_end() {
    let planned = || EventKind::CasesPlanned { test: TEST, names: vec!["home".to_owned()] };
    let early = "event 5: test 0 is not running";
    for report in [planned(), asked(1), answered(1), measured(None), attached(None)] {
        assert_eq!(check_body(1, [report.clone()]), Err(early.to_owned()), "{report:?}");
    }
    let fixture = Some(SIMULATOR);
    for report in [measured(fixture), attached(fixture)] {
        let running = vec![started(1, 1), report, finished(Verdict::Passed)];
        let error = Err("event 6: fixture 0 is not running".to_owned());
        assert_eq!(check_body(1, running.clone()), error);
        let with_fixture = [vec![starting(1), ready()], running, vec![stopping(), stopped()]];
        assert_eq!(check_body(1, with_fixture.concat()), Ok(()));
    }
    let running = [planned(), measured(None), attached(None), asked(1), answered(1)];
    let body = [vec![started(1, 1)], running.to_vec(), vec![finished(Verdict::Passed)]];
    assert_eq!(check_body(1, body.concat()), Ok(()));
}

#[test]
fn a_question_is_asked_and_closed_once() {
    let rule = |body: &[EventKind]| check_body(1, [&[started(1, 1)], body].concat()).unwrap_err();
    assert_eq!(rule(&[asked(1), asked(1)]), "event 7: test 0: question 1 is asked twice");
    assert_eq!(rule(&[asked(1), answered(2)]), "event 7: test 0: question 2 is not open");
    let ended = [asked(1), finished(Verdict::Passed)];
    assert_eq!(rule(&ended), "event 7: test 0 ends before its questions");
}

#[test]
fn only_a_fixture_that_is_ready_is_reset() {
    let reset = || EventKind::FixtureReset { fixture: SIMULATOR, problem: None };
    let error = Err("event 6: fixture 0 goes from Starting to Ready".to_owned());
    assert_eq!(check_body(1, [starting(1), reset()]), error);
    let body = [starting(1), ready(), reset(), stopping(), stopped(), skipped(0)];
    assert_eq!(check_body(1, body), Ok(()));
}

#[test]
fn a_suite_waits_before_it_starts() {
    let waits = |suite| EventKind::SuiteWaiting {
        suite: SuiteId(suite),
        lock: "robot:arm".to_owned(),
        held_by: "another run".to_owned(),
    };
    let mut kinds = opened(1);
    kinds.insert(kinds.len() - 1, waits(0));
    let all: Vec<_> = kinds.into_iter().chain([skipped(0)]).chain(closed()).collect();
    assert_eq!(check(&stream(all)), Ok(()));
    let late = "event 5: suite 0 waits, but was not planned, or has begun";
    assert_eq!(check_body(1, [waits(0)]), Err(late.to_owned()));
}
