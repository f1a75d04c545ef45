//! What a record knows of a fixture, event by event.

use crate::order::{left, ready, starting, stopped, stopping};
use crate::record::record;
use crate::support::*;
use rtf_model::{
    EventKind, FixtureProvided, FixtureRecord, FixtureState, Message, MessageKind, Source, Usage,
};

fn after(body: impl IntoIterator<Item = EventKind>) -> FixtureRecord {
    record(opened(1).into_iter().chain(body)).fixtures.remove(0)
}

fn provided(name: &str) -> EventKind {
    let (name, value) = (name.to_owned(), Some(serde_json::json!(1)));
    EventKind::FixtureProvided(FixtureProvided { fixture: SIMULATOR, name, value, secret: false })
}

fn collapsed() -> EventKind {
    let log_tail = vec!["no joints".to_owned()];
    EventKind::FixtureCollapsed { fixture: SIMULATOR, reason: "gone".to_owned(), log_tail }
}

fn said(kind: MessageKind) -> EventKind {
    let text = format!("{kind:?}");
    let (location, comparison, case, interval) = (None, None, None, None);
    let message = Message { kind, text, location, comparison, critical: false, case, interval };
    EventKind::Message { source: Source::Fixture(SIMULATOR), message, test: None }
}

#[test]
fn each_event_leads_to_a_state() {
    let mut body = Vec::new();
    let mut states = vec![after([]).state];
    for event in [starting(1), ready(), collapsed(), stopping(), stopped()] {
        body.push(event);
        states.push(after(body.clone()).state);
    }
    use FixtureState::{Collapsed, Pending, Ready, Starting, Stopped, Stopping};
    assert_eq!(states, [Pending, Starting, Ready, Collapsed, Stopping, Stopped]);
}

#[test]
fn a_start_forgets_what_the_last_one_provided() {
    let first = vec![starting(1), provided("port"), ready()];
    let once = after(first.clone());
    assert_eq!((once.starts, once.values.len(), once.ready.is_some()), (1, 1, true));
    assert!(once.started < once.ready);
    let restart = [collapsed(), stopping(), stopped(), starting(2)];
    let twice = after([first, restart.to_vec()].concat());
    assert_eq!((twice.starts, twice.values.len(), twice.ready), (2, 0, None));
    assert!(twice.started > once.started);
    let reasons: Vec<_> = twice.collapses.iter().map(|(_, reason)| reason.as_str()).collect();
    assert_eq!((reasons, twice.log_tail), (vec!["gone"], vec!["no joints".to_owned()]));
}

#[test]
fn a_life_has_the_times_of_its_parts() {
    let use_of = |memory| EventKind::ResourcesMeasured {
        source: Source::Fixture(SIMULATOR),
        usage: Usage { processes: 1, memory, descriptors: 9 },
        tests_served: None,
    };
    let body = [starting(1), ready(), use_of(8), use_of(9), collapsed(), stopping(), stopped()];
    let lives = after(body).lives;
    let [life] = &lives[..] else { panic!("{lives:?}") };
    let collapse = life.collapsed.as_ref().map(|(at, _)| *at);
    let times = [Some(life.starting), life.ready, collapse, life.stopping, life.stopped];
    assert!(times.iter().all(Option::is_some) && times.is_sorted(), "{times:?}");
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
    assert!(life.starting.0 > 0);
    assert_eq!(life.usage.seen(), 2);
}

#[test]
fn failures_and_processes_that_are_left_are_kept() {
    use MessageKind::{Check, Error, Failure, Report};
    let mut body = vec![starting(1), ready()];
    body.extend([Report, Check, Failure, Error].map(said));
    body.push(left(Source::Fixture(SIMULATOR)));
    if let Some(EventKind::ProcessesLeaked { processes, .. }) = body.last_mut() {
        processes.push(process(7, None));
    }
    let fixture = after(body);
    let kinds: Vec<_> = fixture.messages.iter().map(|message| message.kind).collect();
    assert_eq!(kinds, [Failure, Error]);
    assert_eq!(fixture.leaked.len(), 1);
}

#[test]
fn a_problem_of_a_tear_down_is_told_with_the_last_lines() {
    let stopped = EventKind::FixtureStopped {
        fixture: SIMULATOR,
        problem: Some("it was killed".to_owned()),
        log_tail: vec!["bye".to_owned()],
    };
    let fixture = after([starting(1), ready(), stopping(), stopped]);
    assert_eq!(fixture.state, FixtureState::Stopped);
    assert_eq!(fixture.problems(false), ["fixture `fixture-0`: it was killed"]);
    assert_eq!(fixture.log_tail, ["bye"]);
    assert_eq!(fixture.lives[0].problem.as_deref(), Some("it was killed"));
}
