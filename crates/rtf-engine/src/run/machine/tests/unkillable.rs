//! Processes that do not end when they are killed, because they wait in the kernel.

use rtf_model::{EventKind, ExitStatus, Phase, TestId, Trigger, Verdict};

use super::world::{FIXTURE, HOOK, TEST, World, hook, suite};
use crate::run::machine::{Input, ProcessEvent, StopLevel};
use rtf_plan::plan::{FixtureBody, ProbePlans, ProcessPlan, SuitePlan};

fn wait(world: &mut World<'_>) {
    while !world.done {
        world.next_deadline();
    }
}

fn warnings(world: &World<'_>) -> Vec<String> {
    let of = |kind: &EventKind| match kind {
        EventKind::Warning { diagnostic } => Some(diagnostic.message.clone()),
        _ => None,
    };
    world.events.iter().filter_map(of).collect()
}

#[test]
fn an_unkillable_test_keeps_its_verdict_and_the_rest_is_skipped() {
    let plan = suite(1, 3);
    let mut world = World::running(&plan);
    while world.record.tests[0].verdict().is_none() {
        world.next_deadline();
    }
    world.tear_down(0);
    world.finish();
    assert_eq!(
        world.record.tests[0].reason(),
        Some("run did not end within 5s; its process was killed and did not end")
    );
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::TimedOut));
    assert_eq!(world.record.verdict(TestId(1)), Some(Verdict::Skipped));
    assert_eq!(warnings(&world), ["the process of test `test0` was killed and did not end"]);
}

#[test]
fn an_unkillable_fixture_is_not_restarted() {
    let plan = suite(1, 2);
    let mut world = World::running(&plan);
    world.collapse(FIXTURE, "the device is gone");
    world.exit(TEST, ExitStatus::Code(0));
    wait(&mut world);
    world.finish();
    assert_eq!(world.record.fixtures[0].starts, 1);
    let problem = &world.record.fixtures[0].problems[0].1;
    assert_eq!(problem, "it did not stop within 3s and was killed; it was killed and did not end");
    assert_eq!(warnings(&world), ["the process of fixture `fixture0` was killed and did not end"]);
}

#[test]
fn an_unkillable_hook_has_failed() {
    let mut plan = suite(0, 2);
    plan.hooks = vec![hook(0, &[Trigger::Failure])];
    let mut world = World::started(&plan);
    world.phase(TEST, Phase::Run);
    world.failure(TEST, "no", false);
    world.end(TEST, "failed");
    world.host_of(HOOK);
    wait(&mut world);
    world.finish();
    let finished = world.record.hooks[0].runs[0].finished.clone();
    let problem = format!("{finished:?}");
    assert!(problem.contains("did not end within 4s; its process was killed"), "{problem}");
    assert_eq!(world.record.verdict(TestId(1)), Some(Verdict::Skipped));
}

/// Regression: it was awaited without limit, then reported as killed.
#[test]
fn a_fixture_that_cannot_start_during_its_stop_is_not_awaited() {
    let plan = process();
    let mut world = World::started(&plan);
    world.stop(StopLevel::TearDown);
    world.input(FIXTURE, ProcessEvent::SpawnFailed("`sim` cannot be started: no".to_owned()));
    assert_eq!(world.now, std::time::Duration::ZERO);
    world.finish();
    assert_eq!(world.record.fixtures[0].problems[0].1, "`sim` cannot be started: no");
}

fn process() -> SuitePlan {
    let mut plan = suite(1, 1);
    let process = ProcessPlan {
        command: vec!["sim".to_owned()],
        probes: ProbePlans::default(),
        stop_signal: 15,
        stop_grace: super::world::SECOND,
        stop_codes: Vec::new(),
        remote: None,
    };
    plan.fixtures[0].body = FixtureBody::Process(std::sync::Arc::new(process));
    plan
}

#[test]
fn a_process_that_crashes_during_its_stop_has_a_problem() {
    for (status, problem) in [
        (ExitStatus::Signal(15), None),
        (ExitStatus::Code(0), None),
        (
            ExitStatus::Code(3),
            Some("its process ended with exit code 3 while it was being stopped"),
        ),
    ] {
        let plan = process();
        let mut world = World::started(&plan);
        world.input(FIXTURE, ProcessEvent::ProbesPassed);
        world.pass(0);
        world.exit(FIXTURE, status);
        world.finish();
        let problems = &world.record.fixtures[0].problems;
        assert_eq!(problems.first().map(|(_, problem)| problem.as_str()), problem);
        assert_eq!(world.record.is_green(), problem.is_none());
    }
}

#[test]
fn a_suite_whose_tear_down_exceeds_its_limit_is_not_green() {
    let mut plan = suite(1, 1);
    plan.settings.timeout = Some(super::world::SECOND);
    let mut world = World::started(&plan);
    world.ready(1);
    world.pass(0);
    world.next_deadline();
    assert_eq!(world.now, super::world::SECOND);
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Passed));
    let problem = &world.record.fixtures[0].problems[0].1;
    assert_eq!(problem, "it was not torn down in time: the suite did not end within 1s");
    assert!(!world.record.is_green());
}

/// The host ends while the next test is being assigned.
#[test]
fn a_test_assigned_to_an_ending_host_gets_a_new_host() {
    let mut plan = suite(1, 2);
    plan.tests.iter_mut().for_each(|test| test.settings.shared = true);
    let mut world = World::started(&plan);
    world.ready(1);
    let host = super::shared::answer_and_continue(&mut world, 0);
    world.release(host);
    let (next, ..) = world.assigned.remove(&host).expect("the next test joins it");
    world.idle.remove(&host);
    // The host reports both: its end, and that the next test did not begin.
    world.feed(Input::Host(host, ProcessEvent::Exited(ExitStatus::Signal(11), Vec::new())));
    world.feed(Input::Host(next, ProcessEvent::NotStarted(ExitStatus::Signal(11))));
    world.pass(1);
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.verdict(TestId(1)), Some(Verdict::Passed));
}
