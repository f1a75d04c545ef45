//! Fixtures that collapse: in a test, in set-up, between tests, in tear-down.

use insta::assert_snapshot;
use rtf_model::protocol::Request;
use rtf_model::{ExitStatus, FixtureId, Source, TestId, Verdict};

use super::world::{FIXTURE, SECOND, TEST, World, suite};
use crate::run::machine::{Deadline, FixtureTimer, HostInput, Probes};
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
    assert_snapshot!(world.story(), @"
    0.0  suite-started
    0.0  fixture-starting attempt=1 fixture=0
    0.0  fixture-ready fixture=0
    0.0  test-started attempt=1 repetition=1 test=0
    0.0  test-phase phase=run test=0
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
fn after_the_restart_the_suite_goes_on() {
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
    assert_snapshot!(world.story(), @"
    0.0  suite-started
    0.0  fixture-starting attempt=1 fixture=0
    0.0  fixture-ready fixture=0
    0.0  fixture-starting attempt=1 fixture=1
    0.0  fixture-ready fixture=1
    0.0  test-started attempt=1 repetition=1 test=0
    0.0  test-phase phase=run test=0
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
    plan.tests[0].after_collapse = AfterCollapse::Rerun;
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
fn when_the_restarts_are_used_up_the_rest_is_skipped_with_the_first_cause() {
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
fn a_collapse_while_another_fixture_is_set_up_tears_both_down_and_starts_again() {
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
    assert_snapshot!(world.story(), @"
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

/// It is told a moment after its death: what it left is swept first.
#[test]
fn a_test_that_passes_beside_a_dying_fixture_is_collapsed() {
    let plan = suite(2, 1);
    let mut world = World::running(&plan);
    world.unseen = true;
    world.end(TEST, "passed");
    world.input(Source::Fixture(FixtureId(1)), HostInput::Lives);
    assert!(world.record.tests[0].is_running(), "its last word is not spoken yet");
    world.exit(FIXTURE, ExitStatus::Signal(9));
    world.tear_down(1);
    world.finish();
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed));
}

#[test]
fn a_test_passes_at_once_when_all_fixtures_were_seen_to_live() {
    let plan = suite(2, 1);
    let mut world = World::running(&plan);
    world.unseen = true;
    world.end(TEST, "passed");
    world.examined(0);
    assert!(world.record.tests[0].is_running(), "its last word is not spoken yet");
    world.examined(1);
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Passed));
    assert_eq!(world.now, std::time::Duration::ZERO);
}

#[test]
fn a_fixture_that_is_not_seen_to_live_after_the_last_test_has_collapsed() {
    for (lives, reason) in [
        (true, "check did not answer within 1s"),
        (false, "it could not be seen in time whether its process lives"),
    ] {
        let plan = suite(1, 1);
        let mut world = World::running(&plan);
        world.unseen = true;
        world.end(TEST, "passed");
        if lives {
            world.input(FIXTURE, HostInput::Lives);
        } else {
            world.answer(FIXTURE, "passed");
        }
        assert_eq!(world.next_deadline(), Deadline::Fixture(0, FixtureTimer::Check));
        assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed));
        assert_eq!(world.record.fixtures[0].collapses[0].1, reason);
    }
}

/// The device is gone since the last test ended, and nothing would ask any more.
#[test]
fn a_check_that_fails_after_the_last_test_is_a_collapse_of_that_test() {
    for every in [None, Some(SECOND)] {
        let mut plan = suite(1, 1);
        plan.fixtures[0].check_every = every;
        let mut world = World::running(&plan);
        world.unseen = true;
        world.end(TEST, "passed");
        world.input(FIXTURE, HostInput::Lives);
        assert!(world.record.tests[0].is_running(), "its last word is not spoken yet");
        world.answer(FIXTURE, "failed");
        world.tear_down(0);
        world.finish();
        assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed));
        assert_eq!(world.record.fixtures[0].collapses[0].1, "check failed: says failed");
    }
}

#[test]
fn a_check_is_asked_once_between_two_tests() {
    let plan = suite(1, 3);
    let mut world = World::started(&plan);
    world.ready(1);
    (0..3).for_each(|test| world.pass(test));
    world.tear_down(0);
    world.finish();
    let checks = world.sent.iter().filter(|sent| matches!(sent.2, Request::CheckFixture {}));
    assert_eq!(checks.count(), 4, "before the first test and after each");
}

/// A check that was asked before its end says nothing about the time since then.
#[test]
fn a_test_is_not_passed_by_a_check_that_was_asked_before_its_end() {
    let mut plan = suite(1, 1);
    plan.fixtures[0].check_every = Some(SECOND);
    let mut world = World::running(&plan);
    world.next_deadline();
    world.unseen = true;
    world.end(TEST, "passed");
    world.answer(FIXTURE, "passed");
    assert!(world.record.tests[0].is_running(), "its last word is not spoken yet");
    world.examined(0);
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Passed));
}

#[test]
fn probes_that_cost_a_process_are_asked_after_the_last_test_only() {
    let plan = suite(1, 2);
    let mut world = World::started(&plan);
    world.ready(1);
    world.pass(0);
    world.pass(1);
    assert_eq!(world.probes, [Probes::Quick, Probes::All]);
}

/// A fixture whose memory image is written takes its time to end.
#[test]
fn a_test_waits_for_the_end_of_a_fixture_that_was_seen_to_die() {
    for outcome in ["passed", "failed"] {
        let plan = suite(2, 1);
        let mut world = World::running(&plan);
        world.unseen = true;
        world.end(TEST, outcome);
        world.input(FIXTURE, HostInput::Dies);
        world.now += 5 * SECOND;
        world.input(Source::Fixture(FixtureId(1)), HostInput::Lives);
        assert!(world.record.tests[0].is_running(), "its last word is not spoken yet");
        world.exit(FIXTURE, ExitStatus::Signal(11));
        world.tear_down(1);
        world.finish();
        assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed), "{outcome}");
        let why = &world.record.fixtures[0].collapses[0].1;
        assert_eq!(why, "its process ended with signal 11 (SIGSEGV)");
    }
}

#[test]
fn a_fixture_that_dies_forever_has_collapsed_after_a_while() {
    let plan = suite(1, 1);
    let mut world = World::running(&plan);
    world.unseen = true;
    world.end(TEST, "passed");
    world.input(FIXTURE, HostInput::Dies);
    assert_eq!(world.next_deadline(), Deadline::Fixture(0, FixtureTimer::Death));
    world.exit(FIXTURE, ExitStatus::Signal(9));
    world.finish();
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed));
    let why = &world.record.fixtures[0].collapses[0].1;
    assert_eq!(why, "its process is dying, and does not come to its end");
}

/// A test notices a broken connection before the kernel tells of the death.
#[test]
fn a_test_that_errs_just_before_the_collapse_is_told_is_collapsed() {
    let plan = suite(1, 1);
    let mut world = World::running(&plan);
    world.failure(TEST, "connection reset by peer", false);
    world.end(TEST, "failed");
    assert!(world.record.tests[0].is_running(), "its last word is not spoken yet");
    world.exit(FIXTURE, ExitStatus::Signal(9));
    world.finish();
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed));
}

#[test]
fn a_test_that_fails_beside_a_healthy_fixture_has_failed_a_moment_later() {
    let plan = suite(1, 1);
    let mut world = World::running(&plan);
    world.failure(TEST, "the arm is stuck", false);
    world.end(TEST, "failed");
    let before = world.now;
    world.next_deadline();
    assert!((world.now - before).as_millis() <= 200);
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Failed));
}
