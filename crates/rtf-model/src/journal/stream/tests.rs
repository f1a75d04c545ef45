use super::*;
use crate::{Phase, RunStarted, SuitePlanned, TestFinished, TestId, TestPlanned, Verdict};

fn test(id: u32) -> TestPlanned {
    TestPlanned {
        learned: Vec::new(),
        test: TestId(id),
        suite: SuiteId(0),
        name: format!("t{id}"),
        plugin_type: String::new(),
        plugin: String::new(),
        plugin_hash: None,
        source_hash: None,
        repetitions: 1,
        timed: false,
        tags: Vec::new(),
        parameters: Vec::new(),
        was: None,
        expected: None,
    }
}

fn stream() -> Vec<Event> {
    let started = RunStarted {
        version: 1,
        run: "run".into(),
        rtf: "0".into(),
        started_at: String::new(),
        command: Vec::new(),
        working_dir: String::new(),
        suites: 1,
        tests: 2,
        manifest: Box::default(),
    };
    let suite = SuitePlanned {
        suite: SuiteId(0),
        name: "s".into(),
        file: String::new(),
        description: String::new(),
        environment: String::new(),
        tolerates_collapse: false,
        parallel: 1,
        requires: Vec::new(),
        skips_fail: false,
    };
    let mut kinds = vec![
        EventKind::RunStarted(started),
        EventKind::SuitePlanned(suite),
        EventKind::TestPlanned(test(0)),
        EventKind::TestPlanned(test(1)),
        EventKind::SuiteStarted { suite: SuiteId(0) },
    ];
    for test in [TestId(0), TestId(1)] {
        let (verdict, reason, phase) = (Verdict::Passed, None, Phase::Exit);
        let end = TestFinished {
            test,
            verdict,
            reason,
            phase,
            exit: None,
            rerun: false,
            decided_by: None,
        };
        kinds.push(EventKind::TestStarted { test, repetition: 1, attempt: 1 });
        kinds.push(EventKind::TestFinished(end));
    }
    kinds.push(EventKind::SuiteFinished { suite: SuiteId(0) });
    kinds.push(EventKind::RunFinished { interrupted: None });
    let events = (0..).zip(kinds).map(|(seq, kind)| Event { seq, at: Micros(seq), kind });
    events.collect()
}

fn renumbered(mut events: Vec<Event>) -> Vec<Event> {
    (0..).zip(&mut events).for_each(|(seq, event)| event.seq = seq);
    events
}

fn problems(events: &[Event]) -> Vec<String> {
    let mut checker = StreamChecker::default();
    events.iter().filter_map(|event| checker.check(event, true).problem).collect()
}

#[test]
fn a_whole_stream_has_no_problems() {
    assert_eq!(problems(&stream()), [""; 0]);
}

/// Also where the numbers hide it: each plan, and the beginning, is missed.
#[test]
fn an_event_that_is_missing_is_noticed() {
    for missing in 0..stream().len() - 1 {
        let mut events = stream();
        events.remove(missing);
        assert!(!problems(&events).is_empty(), "event {missing}");
        if missing < 4 {
            assert!(!problems(&renumbered(events)).is_empty(), "event {missing}");
        }
    }
}

#[test]
fn a_lost_plan_is_named() {
    let mut events = stream();
    events.remove(3);
    let found = problems(&renumbered(events));
    assert_eq!(found[0], "1 of 2 tests are planned");
    assert_eq!(found[1], "it concerns test 1, which is not planned");
}

#[test]
fn an_event_that_comes_twice_counts_once() {
    let events = stream();
    let mut checker = StreamChecker::default();
    assert!(checker.check(&events[0], true).is_new);
    let again = checker.check(&events[0], true);
    assert!(!again.is_new);
    assert_eq!(again.problem.as_deref(), Some("found event 0 where event 1 is expected"));
    assert_eq!(checker.check(&events[1], true), EventCheck { is_new: true, problem: None });
}

/// A number that a fault changed does not hide the events after it.
#[test]
fn the_number_of_a_changed_line_is_not_believed() {
    let mut events = stream();
    events[5].seq = 4_000;
    let mut checker = StreamChecker::default();
    for (place, event) in events.iter().enumerate() {
        let checked = checker.check(event, place != 5);
        assert!(checked.is_new, "event {place}");
        assert_eq!(checked.problem.is_some(), place == 5, "event {place}");
    }
}

#[test]
fn what_follows_the_end_and_what_goes_back_in_time_is_noticed() {
    let mut events = stream();
    events.push(Event {
        seq: 11,
        at: Micros(50),
        kind: EventKind::SuiteFinished { suite: SuiteId(0) },
    });
    assert_eq!(problems(&events), ["it follows the end of the run"]);
    let mut events = stream();
    events[6].at = Micros(0);
    assert_eq!(problems(&events), ["it is earlier than the previous event"]);
}
