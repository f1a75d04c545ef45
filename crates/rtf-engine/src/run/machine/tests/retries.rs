//! Retries of failed tests.

use std::time::Duration;

use insta::assert_snapshot;
use rtf_model::{ExitStatus, ExpectedFailure, Phase, Source, TestId, Verdict};

use super::world::{SECOND, TEST, World, hook, suite};
use crate::run::FailLimit;
use crate::run::machine::{Deadline, StopLevel, SuiteMachine};
use rtf_plan::plan::{Retries, SuitePlan};

fn plan(count: u32, delay: Duration) -> SuitePlan {
    let mut plan = suite(0, 2);
    plan.tests[0].settings.retries = Retries { count, delay };
    plan
}

fn fail(world: &mut World<'_>, critical: bool) {
    world.phase(TEST, Phase::Run);
    world.failure(TEST, "stuck", critical);
    world.end(TEST, "failed");
}

#[test]
fn a_pass_at_the_second_attempt_is_flaky() {
    let plan = plan(2, Duration::ZERO);
    let mut world = World::started(&plan);
    fail(&mut world, false);
    world.pass(0);
    world.pass(1);
    world.finish();
    assert_snapshot!(world.transcript(), @"
    0.0  suite-started
    0.0  test-started attempt=1 repetition=1 test=0
    0.0  test-phase phase=run test=0
    0.0  message source={test:0}
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=run reason=stuck rerun=true test=0 verdict=failed
    0.0  test-started attempt=2 repetition=1 test=0
    0.0  test-phase phase=setup test=0
    0.0  test-phase phase=run test=0
    0.0  test-phase phase=tear-down test=0
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=exit test=0 verdict=passed
    0.0  test-started attempt=1 repetition=1 test=1
    0.0  test-phase phase=setup test=1
    0.0  test-phase phase=run test=1
    0.0  test-phase phase=tear-down test=1
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=exit test=1 verdict=passed
    0.0  suite-finished
    ");
    assert!(world.record.is_green());
    assert!(world.record.tests[0].is_flaky());
    assert!(!world.record.tests[1].is_flaky());
}

#[test]
fn each_repetition_has_separate_retries() {
    let mut plan = plan(1, Duration::ZERO);
    plan.tests[0].settings.repetitions = 2;
    let mut world = World::started(&plan);
    fail(&mut world, false);
    world.pass(0);
    fail(&mut world, false);
    fail(&mut world, false);
    world.pass(1);
    world.finish();
    let numbers: Vec<_> =
        world.record.tests[0].attempts.iter().map(|a| (a.repetition, a.attempt)).collect();
    assert_eq!(numbers, [(1, 1), (1, 2), (2, 1), (2, 2)]);
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Failed));
    assert!(!world.record.tests[0].is_flaky());
}

#[test]
fn ctrl_c_ends_the_delay_of_a_retry() {
    let plan = plan(5, 10 * SECOND);
    let mut world = World::started(&plan);
    fail(&mut world, false);
    assert!(world.hosts.is_empty());
    assert_eq!(world.next_deadline(), Deadline::Retry(TestId(0)));
    fail(&mut world, false);
    assert!(world.hosts.is_empty());
    world.stop(StopLevel::TearDown);
    world.finish();
    assert_snapshot!(world.transcript(), @"
     0.0  suite-started
     0.0  test-started attempt=1 repetition=1 test=0
     0.0  test-phase phase=run test=0
     0.0  message source={test:0}
     0.0    → close the channel
     0.0  test-finished exit={code:0} phase=run reason=stuck rerun=true test=0 verdict=failed
    10.0  test-started attempt=2 repetition=1 test=0
    10.0  test-phase phase=run test=0
    10.0  message source={test:0}
    10.0    → close the channel
    10.0  test-finished exit={code:0} phase=run reason=stuck rerun=true test=0 verdict=failed
    10.0  test-skipped reason=stopped by SIGINT test=0
    10.0  test-skipped reason=stopped by SIGINT test=1
    10.0  suite-finished
    ");
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Failed));
}

#[test]
fn a_critical_assertion_is_not_retried_and_each_attempt_triggers_hooks() {
    let mut plan = plan(5, Duration::ZERO);
    plan.hooks = vec![hook(0, &[rtf_model::Trigger::Failure])];
    let mut world = World::started(&plan);
    let park = Source::Hook(rtf_model::HookId(0));
    for critical in [false, true] {
        fail(&mut world, critical);
        world.exit(park, ExitStatus::Code(0));
    }
    world.finish();
    assert_eq!(world.record.tests[0].attempts.len(), 2);
    assert_eq!(world.record.verdict(TestId(1)), Some(Verdict::Skipped));
    assert_eq!(world.record.hooks[0].runs.len(), 2);
}

#[test]
fn at_the_failure_limit_the_rest_is_skipped() {
    let mut plan = suite(1, 3);
    plan.tests[0].settings.repetitions = 3;
    let mut world = World::new(&plan);
    let fails = FailLimit::new(Some(1));
    world.machine = SuiteMachine::new(&plan, fails.clone());
    world.start();
    let fixture = Source::Fixture(rtf_model::FixtureId(0));
    world.answer(fixture, "passed");
    world.answer(fixture, "passed");
    fail(&mut world, false);
    world.tear_down(0);
    world.finish();
    let why = Some("1 test has not passed (--max-fail 1)");
    assert_eq!(world.record.tests[2].skipped.as_deref(), why);
    // The next suite of the run starts nothing.
    let mut next = World::new(&plan);
    next.machine = SuiteMachine::new(&plan, fails);
    next.start();
    next.finish();
    assert_eq!(next.record.totals().of(Verdict::Skipped), 3);
}

#[test]
fn failures_of_another_suite_end_a_suite_after_its_test() {
    let plan = suite(0, 3);
    let fails = FailLimit::new(Some(1));
    let [mut failing, mut other] = [(); 2].map(|()| {
        let mut world = World::new(&plan);
        world.machine = SuiteMachine::new(&plan, fails.clone());
        world.start();
        world
    });
    fail(&mut failing, false);
    failing.finish();
    // The running test finishes, and none follows.
    let test = Source::Test(TestId(0));
    other.answer(test, "passed");
    other.exit(test, ExitStatus::Code(0));
    other.finish();
    assert_eq!(other.record.verdict(TestId(0)), Some(Verdict::Passed));
    let why = Some("1 test has not passed (--max-fail 1)");
    assert_eq!(other.record.tests[1].skipped.as_deref(), why);
    assert_eq!(other.record.totals().of(Verdict::Skipped), 2);
}

/// A known failure is neither retried nor counted for `--max-fail`, and the suite continues
/// although the test is critical.
#[test]
fn a_known_failure_has_no_consequences() {
    let mut plan = suite(0, 2);
    plan.tests[0].settings.retries = Retries { count: 3, delay: Duration::ZERO };
    plan.tests[0].settings.critical = true;
    let verdicts = vec![Verdict::Failed];
    plan.tests[0].expected = Some(Box::new(ExpectedFailure { verdicts, ..Default::default() }));
    let mut world = World::running(&plan);
    world.failure(TEST, "the elbow drifts", false);
    world.end(TEST, "failed");
    world.pass(1);
    world.finish();
    assert_eq!(world.record.tests[0].attempts.len(), 1);
    assert_eq!(world.record.verdict(TestId(1)), Some(Verdict::Passed));
    assert!(world.record.is_green());
}
