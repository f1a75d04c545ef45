//! Fixtures that collapse: in a test, in set-up, between tests, in tear-down.

use insta::assert_snapshot;
use rtf_model::protocol::Request;
use rtf_model::{ExitStatus, FixtureId, Source, TestId, Verdict};

use super::world::{FIXTURE, SECOND, TEST, World, suite};
use crate::run::machine::{Deadline, FixtureTimer, ProbeSelection, ProcessEvent};
use rtf_plan::plan::AfterCollapse;

const GONE: &str = "the motor driver is gone";

/// Defect 4 of the predecessor: a collapse during the only test was never reported.
#[test]
fn a_collapse_during_the_only_test_interrupts_it() {
    let plan = suite(1, 1);
    let mut world = World::running(&plan);
    world.collapse(FIXTURE, GONE);
    world.end(TEST, "interrupted");
    world.tear_down(0);
    world.finish();
    assert_snapshot!(world.transcript(), @"
    0.0  fixture-collapsed fixture=0 reason=the motor driver is gone
    0.0  test-stopping cause=collapse reason=fixture `fixture0` collapsed: the motor driver is gone test=0
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=run reason=fixture `fixture0` collapsed: the motor driver is gone test=0 verdict=collapsed
    0.0  fixture-stopping fixture=0
    0.0    → close the channel
    0.0  fixture-stopped fixture=0
    0.0  suite-finished
    ");
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed));
    assert!(!world.record.is_green());
}

#[test]
fn after_the_restart_the_suite_continues() {
    let plan = suite(2, 2);
    let mut world = World::running(&plan);
    world.exit(FIXTURE, ExitStatus::Signal(9));
    world.end(TEST, "passed");
    world.tear_down(1);
    world.ready(2);
    world.pass(1);
    world.tear_down(1);
    world.tear_down(0);
    world.finish();
    assert_snapshot!(world.transcript(), @"
    0.0  fixture-collapsed fixture=0 reason=its process ended with signal 9 (SIGKILL)
    0.0  test-stopping cause=collapse reason=fixture `fixture0` collapsed: its process ended with signal 9 (SIGKILL) test=0
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=run reason=fixture `fixture0` collapsed: its process ended with signal 9 (SIGKILL) test=0 verdict=collapsed
    0.0  fixture-stopping fixture=1
    0.0    → close the channel
    0.0  fixture-stopped fixture=1
    0.0  fixture-stopping fixture=0
    0.0  fixture-stopped fixture=0
    0.0  fixture-starting attempt=2 fixture=0
    0.0  fixture-ready fixture=0
    0.0  fixture-starting attempt=2 fixture=1
    0.0  fixture-ready fixture=1
    0.0  test-started attempt=1 repetition=1 test=1
    0.0  test-phase phase=setup test=1
    0.0  test-phase phase=run test=1
    0.0  test-phase phase=tear-down test=1
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=exit test=1 verdict=passed
    0.0  fixture-stopping fixture=1
    0.0    → close the channel
    0.0  fixture-stopped fixture=1
    0.0  fixture-stopping fixture=0
    0.0    → close the channel
    0.0  fixture-stopped fixture=0
    0.0  suite-finished
    ");
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed));
    assert_eq!(world.record.verdict(TestId(1)), Some(Verdict::Passed));
}

#[test]
fn a_rerun_keeps_both_attempts_and_the_last_one_counts() {
    let mut plan = suite(1, 1);
    plan.tests[0].settings.after_collapse = AfterCollapse::Rerun;
    let mut world = World::running(&plan);
    world.collapse(FIXTURE, GONE);
    world.end(TEST, "interrupted");
    world.tear_down(0);
    world.ready(1);
    world.pass(0);
    world.tear_down(0);
    world.finish();
    let test = &world.record.tests[0];
    let verdicts: Vec<_> = test.attempts.iter().filter_map(|a| a.verdict()).collect();
    assert_eq!(verdicts, [Verdict::Collapsed, Verdict::Passed]);
    assert_eq!(test.verdict(), Some(Verdict::Passed));
    assert!(!world.record.is_green(), "a collapse is not green unless it is tolerated");
}

#[test]
fn without_restarts_left_the_rest_is_skipped_with_the_first_cause() {
    let mut plan = suite(1, 3);
    plan.fixtures[0].restarts = 0;
    let mut world = World::running(&plan);
    world.collapse(FIXTURE, GONE);
    world.end(TEST, "interrupted");
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.totals().of(Verdict::Skipped), 2);
    assert_eq!(
        world.record.tests[2].reason(),
        Some("fixture `fixture0` is broken: the motor driver is gone")
    );
}

#[test]
fn a_collapse_during_another_set_up_restarts_both_fixtures() {
    let plan = suite(2, 1);
    let mut world = World::started(&plan);
    world.answer(FIXTURE, "passed");
    world.collapse(FIXTURE, GONE);
    world.tear_down(1);
    world.tear_down(0);
    world.ready(2);
    world.pass(0);
    world.tear_down(1);
    world.tear_down(0);
    world.finish();
    assert_snapshot!(world.transcript(), @"
    0.0  suite-started
    0.0  fixture-starting attempt=1 fixture=0
    0.0  fixture-ready fixture=0
    0.0  fixture-starting attempt=1 fixture=1
    0.0  fixture-collapsed fixture=0 reason=the motor driver is gone
    0.0  fixture-stopping fixture=1
    0.0    → close the channel
    0.0  fixture-stopped fixture=1
    0.0  fixture-stopping fixture=0
    0.0    → close the channel
    0.0  fixture-stopped fixture=0
    0.0  fixture-starting attempt=2 fixture=0
    0.0  fixture-ready fixture=0
    0.0  fixture-starting attempt=2 fixture=1
    0.0  fixture-ready fixture=1
    0.0  test-started attempt=1 repetition=1 test=0
    0.0  test-phase phase=setup test=0
    0.0  test-phase phase=run test=0
    0.0  test-phase phase=tear-down test=0
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=exit test=0 verdict=passed
    0.0  fixture-stopping fixture=1
    0.0    → close the channel
    0.0  fixture-stopped fixture=1
    0.0  fixture-stopping fixture=0
    0.0    → close the channel
    0.0  fixture-stopped fixture=0
    0.0  suite-finished
    ");
}

#[test]
fn a_check_that_fails_before_a_test_restarts_the_fixture_first() {
    let plan = suite(1, 1);
    let mut world = World::started(&plan);
    world.answer(FIXTURE, "passed");
    world.answer(FIXTURE, "failed");
    world.tear_down(0);
    world.ready(1);
    world.pass(0);
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.fixtures[0].collapses[0].1, "check failed: says failed");
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Passed));
}

/// A plug-in's threads may also report between requests; that is no problem of a check.
#[test]
fn the_first_problem_that_is_reported_during_a_check_is_its_reason() {
    let mut plan = suite(1, 1);
    plan.fixtures[0].check_every = Some(SECOND);
    let mut world = World::running(&plan);
    world.failure(FIXTURE, "reported between two requests", false);
    assert_eq!(world.next_deadline(), Deadline::Fixture(0, FixtureTimer::CheckDue));
    world.failure(FIXTURE, "no heartbeat\nwithin 2 s", false);
    world.failure(FIXTURE, "no torque", false);
    world.answer(FIXTURE, "failed");
    assert_eq!(world.record.fixtures[0].collapses[0].1, "check failed: no heartbeat\nwithin 2 s");
}

#[test]
fn a_fixture_that_dies_between_tests_is_restarted() {
    let plan = suite(1, 1);
    let mut world = World::started(&plan);
    world.end(FIXTURE, "passed");
    world.ready(1);
    world.pass(0);
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.fixtures[0].starts, 2);
}

#[test]
fn a_collapse_during_the_last_tear_down_is_not_green() {
    let plan = suite(2, 1);
    let mut world = World::started(&plan);
    world.ready(2);
    world.pass(0);
    world.collapse(FIXTURE, GONE);
    world.tear_down(1);
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Passed));
    assert!(!world.record.is_green());
}

/// Its end is reported late, because leftover processes are killed first.
#[test]
fn a_test_that_passes_while_a_fixture_is_dying_is_collapsed() {
    let plan = suite(2, 1);
    let mut world = World::running(&plan);
    world.hides_liveness = true;
    world.end(TEST, "passed");
    world.input(Source::Fixture(FixtureId(1)), ProcessEvent::Alive);
    assert!(world.record.tests[0].is_running(), "it has no verdict yet");
    world.exit(FIXTURE, ExitStatus::Signal(9));
    world.tear_down(1);
    world.finish();
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed));
}

#[test]
fn a_test_passes_as_soon_as_all_fixtures_passed_their_examination() {
    let plan = suite(2, 1);
    let mut world = World::running(&plan);
    world.hides_liveness = true;
    world.end(TEST, "passed");
    world.pass_examination(0);
    assert!(world.record.tests[0].is_running(), "it has no verdict yet");
    world.pass_examination(1);
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Passed));
    assert_eq!(world.now, std::time::Duration::ZERO);
}

#[test]
fn a_fixture_that_fails_the_last_examination_has_collapsed() {
    for (lives, reason) in [
        (true, "check did not answer within 1s"),
        (false, "its process could not be examined in time"),
    ] {
        let plan = suite(1, 1);
        let mut world = World::running(&plan);
        world.hides_liveness = true;
        world.end(TEST, "passed");
        if lives {
            world.input(FIXTURE, ProcessEvent::Alive);
        } else {
            world.answer(FIXTURE, "passed");
        }
        assert_eq!(world.next_deadline(), Deadline::Fixture(0, FixtureTimer::Check));
        assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed));
        assert_eq!(world.record.fixtures[0].collapses[0].1, reason);
    }
}

/// No further check would detect that the device is gone.
#[test]
fn a_check_that_fails_after_the_last_test_makes_it_collapsed() {
    for every in [None, Some(SECOND)] {
        let mut plan = suite(1, 1);
        plan.fixtures[0].check_every = every;
        let mut world = World::running(&plan);
        world.hides_liveness = true;
        world.end(TEST, "passed");
        world.input(FIXTURE, ProcessEvent::Alive);
        assert!(world.record.tests[0].is_running(), "it has no verdict yet");
        world.answer(FIXTURE, "failed");
        world.tear_down(0);
        world.finish();
        assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed));
        assert_eq!(world.record.fixtures[0].collapses[0].1, "check failed: says failed");
    }
}

#[test]
fn check_is_called_once_between_two_tests() {
    let plan = suite(1, 3);
    let mut world = World::started(&plan);
    world.ready(1);
    (0..3).for_each(|test| world.pass(test));
    world.tear_down(0);
    world.finish();
    let checks = world.sent.iter().filter(|sent| matches!(sent.2, Request::CheckFixture {}));
    assert_eq!(checks.count(), 4, "before the first test and after each");
}

#[test]
fn a_check_requested_before_a_tests_end_does_not_confirm_it() {
    let mut plan = suite(1, 1);
    plan.fixtures[0].check_every = Some(SECOND);
    let mut world = World::running(&plan);
    world.next_deadline();
    world.hides_liveness = true;
    world.end(TEST, "passed");
    world.answer(FIXTURE, "passed");
    assert!(world.record.tests[0].is_running(), "it has no verdict yet");
    world.pass_examination(0);
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Passed));
}

#[test]
fn slow_probes_run_only_after_the_last_test() {
    let plan = suite(1, 2);
    let mut world = World::started(&plan);
    world.ready(1);
    world.pass(0);
    world.pass(1);
    assert_eq!(world.probes, [ProbeSelection::Quick, ProbeSelection::All]);
}

/// Writing a core dump takes time.
#[test]
fn a_test_waits_for_the_end_of_a_dying_fixture() {
    for outcome in ["passed", "failed"] {
        let plan = suite(2, 1);
        let mut world = World::running(&plan);
        world.hides_liveness = true;
        world.end(TEST, outcome);
        world.input(FIXTURE, ProcessEvent::Dying);
        world.now += 5 * SECOND;
        world.input(Source::Fixture(FixtureId(1)), ProcessEvent::Alive);
        assert!(world.record.tests[0].is_running(), "it has no verdict yet");
        world.exit(FIXTURE, ExitStatus::Signal(11));
        world.tear_down(1);
        world.finish();
        assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed), "{outcome}");
        let why = &world.record.fixtures[0].collapses[0].1;
        assert_eq!(why, "its process ended with signal 11 (SIGSEGV)");
    }
}

#[test]
fn a_dying_fixture_that_does_not_end_has_collapsed() {
    let plan = suite(1, 1);
    let mut world = World::running(&plan);
    world.hides_liveness = true;
    world.end(TEST, "passed");
    world.input(FIXTURE, ProcessEvent::Dying);
    assert_eq!(world.next_deadline(), Deadline::Fixture(0, FixtureTimer::Death));
    world.exit(FIXTURE, ExitStatus::Signal(9));
    world.finish();
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed));
    let why = &world.record.fixtures[0].collapses[0].1;
    assert_eq!(why, "its process is dying but does not end");
}

/// A test detects a broken connection before the kernel reports the death.
#[test]
fn a_failure_just_before_the_collapse_is_reported_is_collapsed() {
    let plan = suite(1, 1);
    let mut world = World::running(&plan);
    world.failure(TEST, "connection reset by peer", false);
    world.end(TEST, "failed");
    assert!(world.record.tests[0].is_running(), "it has no verdict yet");
    world.exit(FIXTURE, ExitStatus::Signal(9));
    world.finish();
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed));
}

#[test]
fn a_test_that_fails_with_a_healthy_fixture_has_failed() {
    let plan = suite(1, 1);
    let mut world = World::running(&plan);
    world.failure(TEST, "the arm is stuck", false);
    world.end(TEST, "failed");
    let before = world.now;
    world.next_deadline();
    assert!((world.now - before).as_millis() <= 200);
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Failed));
}
