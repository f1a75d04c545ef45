//! A suite that is repeated until a time has passed.

use rtf_model::{ExitStatus, FixtureId, Phase, Source, TestId, Verdict};

use super::world::{SECOND, TEST, World, suite};
use crate::run::FailLimit;
use crate::run::machine::{Input, StopLevel, SuiteMachine};
use rtf_plan::plan::{Retries, SuitePlan};

const TESTS: [Source; 2] = [TEST, Source::Test(TestId(1))];

/// A soak of ten seconds.
fn timed(plan: &SuitePlan, fails: FailLimit) -> World<'_> {
    let mut world = World::timed(plan);
    world.machine = SuiteMachine::new(plan, fails).until(Some(10 * SECOND));
    world.start();
    world
}

fn fail(world: &mut World<'_>, test: usize) {
    world.phase(TESTS[test], Phase::Run);
    world.failure(TESTS[test], "stuck", false);
    world.end(TESTS[test], "failed");
}

fn repetitions(world: &World<'_>, test: usize) -> Vec<u32> {
    world.record.tests[test].attempts.iter().map(|attempt| attempt.repetition).collect()
}

#[test]
fn a_round_that_started_in_time_is_completed() {
    let mut plan = suite(1, 2);
    plan.tests[1].settings.repetitions = 2;
    let mut world = timed(&plan, FailLimit::default());
    let fixture = Source::Fixture(FixtureId(0));
    world.answer(fixture, "passed");
    for _ in 0..2 {
        assert_eq!(world.record.verdict(TestId(0)), None, "nobody knows how many follow");
        for test in [0, 1, 1] {
            world.answer(fixture, "passed");
            world.now += 2 * SECOND;
            world.pass(test);
        }
    }
    world.tear_down(0);
    world.finish();
    // The second round started after 6 s and ended after 12 s.
    assert_eq!(world.record.fixtures[0].starts, 1);
    assert_eq!((repetitions(&world, 0), repetitions(&world, 1)), (vec![1, 2], vec![1, 2, 3, 4]));
    assert_eq!(world.record.tests[1].repetitions(), Some(4));
    assert!(world.record.is_green());
}

#[test]
fn at_least_one_round_runs() {
    let plan = suite(0, 1);
    let mut world = timed(&plan, FailLimit::default());
    world.now += 60 * SECOND;
    world.pass(0);
    world.finish();
    assert_eq!(repetitions(&world, 0), [1]);
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Passed));
}

#[test]
fn the_failure_limit_ends_a_soak_and_keeps_passed_results() {
    let plan = suite(0, 2);
    let mut world = timed(&plan, FailLimit::new(Some(1)));
    world.pass(0);
    world.pass(1);
    fail(&mut world, 0);
    world.finish();
    assert_eq!((repetitions(&world, 0), repetitions(&world, 1)), (vec![1, 2], vec![1]));
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Failed));
    assert_eq!(world.record.verdict(TestId(1)), Some(Verdict::Passed));
}

#[test]
fn a_test_that_fails_in_each_round_counts_once() {
    let plan = suite(0, 2);
    let mut world = timed(&plan, FailLimit::new(Some(2)));
    for _ in 0..3 {
        fail(&mut world, 0);
        world.pass(1);
    }
    assert!(!world.done);
    world.now += 10 * SECOND;
    fail(&mut world, 0);
    world.pass(1);
    world.finish();
    assert_eq!(repetitions(&world, 0), [1, 2, 3, 4]);
}

#[test]
fn ctrl_c_ends_a_soak_and_a_pending_retry_is_skipped() {
    let mut plan = suite(0, 2);
    plan.tests[1].settings.retries = Retries { count: 3, delay: SECOND };
    let mut world = timed(&plan, FailLimit::default());
    world.pass(0);
    fail(&mut world, 1);
    world.stop(StopLevel::TearDown);
    world.finish();
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Passed));
    assert_eq!(world.record.tests[1].skipped.as_deref(), Some("stopped by SIGINT"));
}

#[test]
fn a_test_that_a_user_stopped_is_in_no_further_round() {
    let plan = suite(0, 2);
    let mut world = timed(&plan, FailLimit::default());
    world.pass(0);
    world.feed(Input::StopTest(TestId(1), "ada".to_owned()));
    world.exit(TESTS[1], ExitStatus::Signal(15));
    world.pass(0);
    world.now += 10 * SECOND;
    world.pass(0);
    world.finish();
    assert_eq!((repetitions(&world, 0), repetitions(&world, 1)), (vec![1, 2, 3], vec![1]));
    assert_eq!(world.record.verdict(TestId(1)), Some(Verdict::Interrupted));
}

#[test]
fn a_round_of_parallel_tests_ends_with_the_last_one() {
    let mut plan = suite(0, 2);
    plan.settings.parallel = 2;
    let mut world = timed(&plan, FailLimit::default());
    world.pass(1);
    assert_eq!(repetitions(&world, 1), [1], "the other one is not over");
    world.pass(0);
    assert_eq!((repetitions(&world, 0), repetitions(&world, 1)), (vec![1, 2], vec![1, 2]));
    world.now += 10 * SECOND;
    world.pass(0);
    world.pass(1);
    world.finish();
    assert!(world.record.is_green());
}
