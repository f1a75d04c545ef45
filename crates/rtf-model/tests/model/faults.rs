//! Injected faults: their order, and what a record keeps of them.

use rtf_model::{AttemptRecord, EventKind, FaultInjected, FaultKind, OrderChecker, Record};

use crate::support::{SUITE, TEST, run_started, stream, suite, test};

fn injected(name: &str, kind: FaultKind) -> EventKind {
    let (name, effect) = (name.to_owned(), "it".to_owned());
    EventKind::FaultInjected(FaultInjected { test: TEST, name, kind, effect })
}

fn removed(name: &str) -> EventKind {
    EventKind::FaultRemoved { test: TEST, name: name.to_owned() }
}

fn in_test(kinds: impl IntoIterator<Item = EventKind>) -> Vec<EventKind> {
    let before = [
        run_started(),
        suite(0),
        test(0, 0, 1),
        EventKind::SuiteStarted { suite: SUITE },
        EventKind::TestStarted { test: TEST, repetition: 1, attempt: 1 },
    ];
    before.into_iter().chain(kinds).collect()
}

fn first_problem(kinds: Vec<EventKind>) -> Option<String> {
    let mut order = OrderChecker::default();
    stream(kinds).into_iter().find_map(|event| order.check(&event).err()).map(|error| error.rule)
}

#[test]
fn a_fault_that_lasts_is_removed_once() {
    use FaultKind::{Disk, Kill, Stop};
    let legal = [
        injected("a", Stop),
        injected("b", Disk),
        removed("a"),
        injected("a", Stop),
        injected("c", Kill),
        injected("c", Kill),
    ];
    assert_eq!(first_problem(in_test(legal)), None);
    let twice = in_test([injected("a", Stop), injected("a", Stop)]);
    assert_eq!(first_problem(twice).as_deref(), Some("the fault `a` lasts already"));
    for never in [vec![removed("a")], vec![injected("a", Kill), removed("a")]] {
        let problem = first_problem(in_test(never));
        assert_eq!(problem.as_deref(), Some("the fault `a` of test 0 was not injected"));
    }
    let outside = vec![run_started(), suite(0), test(0, 0, 1), injected("a", Stop)];
    assert!(first_problem(outside).is_some());
}

#[test]
fn a_record_pairs_the_end_of_a_fault_with_its_beginning() {
    use FaultKind::{Kill, Stop};
    let kinds = in_test([
        injected("a", Stop),
        removed("a"),
        injected("a", Stop),
        injected("b", Kill),
        removed("a"),
        injected("a", Stop),
    ]);
    let (mut whole, mut lean) = (Record::default(), Record::lean());
    for event in stream(kinds) {
        whole.apply(&event);
        lean.apply(&event);
    }
    let faults = &whole.tests[0].attempts[0].faults;
    let lasted = faults.iter().map(|it| it.removed.map(|removed| removed.since(it.injected)));
    let ended: Vec<bool> = lasted.map(|lasted| lasted.is_some()).collect();
    assert_eq!(ended, [true, true, false, false]);
    // The timeline of the page shows them.
    assert_eq!(lean.tests[0].attempts[0].faults, *faults);
}

/// Memory stays bounded.
#[test]
fn faults_beyond_a_limit_are_not_kept() {
    let most = AttemptRecord::FAULTS_KEPT;
    let mut record = Record::default();
    for event in stream(in_test((0..most + 2).map(|_| injected("c", FaultKind::Kill)))) {
        record.apply(&event);
    }
    assert_eq!(record.tests[0].attempts[0].faults.len(), most);
}
