//! Suites whose resources were prepared or refused.

use insta::assert_snapshot;
use rtf_model::{FixtureId, Source, SuiteId, SuitePrepared, TestId, Trigger, Verdict};

use super::world::{World, hook, suite};
use crate::run::machine::StopLevel;
use rtf_plan::plan::{Preparation, SuitePlan};

fn refused() -> SuitePlan {
    let mut plan = suite(1, 2);
    plan.hooks = vec![hook(0, &Trigger::ALL)];
    plan.tests[1].settings.repetitions = 3;
    plan.settings.timeout = Some(super::world::SECOND);
    plan.preparation = Preparation::Refused("no private network: refused".to_owned());
    plan
}

#[test]
fn the_preparation_is_reported_before_anything_starts() {
    let mut plan = suite(1, 1);
    plan.preparation = Preparation::Done(SuitePrepared {
        suite: SuiteId(0),
        network: None,
        ports: Vec::new(),
        variables: Vec::new(),
        join_command: "export A=1".to_owned(),
    });
    let world = World::started(&plan);
    assert_snapshot!(world.transcript(), @"
    0.0  suite-started
    0.0  suite-prepared join_command=export A=1
    0.0  fixture-starting attempt=1 fixture=0
    ");
    assert_eq!(
        world.record.suites[0].prepared.as_ref().expect("a preparation").join_command,
        "export A=1"
    );
}

#[test]
fn without_preparation_each_test_is_an_error_and_nothing_starts() {
    let plan = refused();
    let mut world = World::started(&plan);
    world.finish();
    assert!(world.hosts.is_empty(), "{:?}", world.hosts);
    assert_snapshot!(world.transcript(), @"
    0.0  suite-started
    0.0  test-started attempt=1 repetition=1 test=0
    0.0  test-finished phase=load reason=no private network: refused test=0 verdict=error
    0.0  test-started attempt=1 repetition=1 test=1
    0.0  test-finished phase=load reason=no private network: refused test=1 verdict=error
    0.0  test-skipped reason=no private network: refused test=1
    0.0  suite-finished
    ");
    for test in [TestId(0), TestId(1)] {
        assert_eq!(world.record.verdict(test), Some(Verdict::Error));
    }
    assert!(!world.record.is_green());
}

#[test]
fn a_stop_before_the_start_skips_the_tests_in_any_case() {
    let plan = refused();
    let mut world = World::new(&plan);
    world.stop(StopLevel::TearDown);
    world.start();
    world.deadlines.clear();
    world.finish();
    assert!(!world.hosts.values().any(|of| *of == Source::Fixture(FixtureId(0))));
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Skipped));
}
