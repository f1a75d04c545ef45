//! Faults that a fixture injects while tests run.

use rtf_model::protocol::Notification;
use rtf_model::{ExitStatus, FaultInjected, FaultKind, FixtureId, Source, TestId};

use super::findings::{answer_notifications, notified, watched};
use super::world::{SECOND, TEST, World, suite};
use crate::run::machine::ProcessEvent;

const INJECTOR: Source = Source::Fixture(FixtureId(0));

fn inject(world: &mut World<'_>, test: u32, kind: FaultKind) {
    let (test, name, effect) = (TestId(test), "drop".to_owned(), "stopped it".to_owned());
    let fault = Notification::FaultInjected(FaultInjected { test, name, kind, effect });
    world.input(INJECTOR, ProcessEvent::Notified(fault));
}

fn remove(world: &mut World<'_>, test: u32) {
    let removed = Notification::FaultRemoved { test: TestId(test), name: "drop".to_owned() };
    world.input(INJECTOR, ProcessEvent::Notified(removed));
}

fn errors<'w>(world: &'w World<'_>) -> Vec<&'w str> {
    world.record.fixtures[0].messages.iter().map(|message| &*message.text).collect()
}

#[test]
fn faults_are_events_of_the_test() {
    let plan = suite(1, 2);
    let mut world = watched(&plan);
    inject(&mut world, 0, FaultKind::Stop);
    remove(&mut world, 0);
    inject(&mut world, 0, FaultKind::Kill);
    inject(&mut world, 0, FaultKind::Kill);
    inject(&mut world, 0, FaultKind::Stop);
    let faults = &world.record.tests[0].attempts[0].faults;
    let removed: Vec<_> = faults.iter().map(|fault| fault.removed.is_some()).collect();
    assert_eq!(removed, [true, false, false, false]);
    assert!(errors(&world).is_empty());
}

/// Several fixtures may be notified: one reports while another one has not replied.
#[test]
fn a_fault_before_the_start_of_the_test_waits_for_it() {
    let plan = suite(1, 2);
    let mut world = notified(&plan);
    inject(&mut world, 0, FaultKind::Stop);
    remove(&mut world, 0);
    assert!(world.record.tests[0].attempts.is_empty());
    answer_notifications(&mut world);
    let [fault] = &*world.record.tests[0].attempts[0].faults else { panic!("one fault") };
    assert!(fault.removed.is_some());
    assert!(errors(&world).is_empty());
}

/// It is notified again after its restart, so the test for which the report waited does not start.
#[test]
fn reports_that_wait_are_errors_before_the_fixture_that_collapsed_stops() {
    let mut plan = suite(1, 2);
    (plan.fixtures[0].restarts, plan.fixtures[0].restart_delay) = (1, SECOND);
    let mut world = notified(&plan);
    inject(&mut world, 0, FaultKind::Stop);
    remove(&mut world, 0);
    world.exit(INJECTOR, ExitStatus::Signal(9));
    let expected = [
        "it reported about `test0`, which does not run: the fault `drop`",
        "it removed the fault `drop`, which it had not injected",
    ];
    assert_eq!(errors(&world), expected);
}

/// The event stream stays legal.
#[test]
fn a_fault_that_cannot_be_is_an_error_of_the_fixture() {
    let plan = suite(1, 2);
    let mut world = watched(&plan);
    inject(&mut world, 0, FaultKind::Stop);
    inject(&mut world, 0, FaultKind::Stop);
    inject(&mut world, 1, FaultKind::Stop);
    remove(&mut world, 0);
    remove(&mut world, 0);
    let expected = [
        "it injected the fault `drop`, which lasts already",
        "it reported about `test1`, which does not run: the fault `drop`",
        "it removed the fault `drop`, which it had not injected",
    ];
    assert_eq!(errors(&world), expected);
    assert_eq!(world.record.tests[0].attempts[0].faults.len(), 1);
}

#[test]
fn a_test_cannot_inject_faults_as_a_fixture() {
    let plan = suite(1, 1);
    let mut world = watched(&plan);
    let removed = Notification::FaultRemoved { test: TestId(0), name: "drop".to_owned() };
    world.input(TEST, ProcessEvent::Notified(removed));
    world.end(TEST, "interrupted");
    world.answer(INJECTOR, "passed");
    let reason = world.record.tests[0].reason();
    let expected = "the host broke the protocol: sent `fault-removed`, which is for fixtures";
    assert_eq!(reason, Some(expected));
}
