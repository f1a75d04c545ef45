//! The episodes of a campaign.

use std::sync::Arc;

use rtf_model::{Episode, EpisodeOutcome, EventKind, ExitStatus, Parameter, Phase, Source, TestId};

use super::world::{FIXTURE, SECOND, TEST, World, suite};
use crate::run::machine::{HostId, Input, ProcessEvent, StopLevel};
use rtf_plan::plan::{ResetPlan, SuitePlan};

const SECOND_TEST: Source = Source::Test(TestId(1));

/// A suite with a fixture, two tests, and episodes.
fn plan(episodes: u64) -> SuitePlan {
    let mut plan = suite(1, 2);
    plan.refers_to_values = true;
    let episode = |id| {
        let value = format!("{id}.5");
        Episode { id, seed: 7, parameters: vec![Parameter { name: "mass".to_owned(), value }] }
    };
    plan.episodes = (1..=episodes).map(episode).collect();
    plan
}

fn warm(episodes: u64, restart_every: Option<u32>) -> SuitePlan {
    let mut plan = plan(episodes);
    let command = vec!["reset".to_owned(), "${episode:mass}".to_owned()];
    plan.fixtures[0].reset = Some(ResetPlan { command, timeout: 4 * SECOND, restart_every });
    plan
}

fn started(plan: &SuitePlan) -> World<'_> {
    let mut world = World::timed(plan);
    world.start();
    world
}

/// All tests of an episode pass.
fn pass(world: &mut World<'_>) {
    world.pass(0);
    world.pass(1);
}

fn fail(world: &mut World<'_>, test: Source) {
    world.phase(test, Phase::Run);
    world.failure(test, "stuck", false);
    world.end(test, "failed");
}

/// The process that started last, which is the `<reset>` command.
fn reset_host(world: &World<'_>) -> HostId {
    *world.hosts.keys().next_back().unwrap()
}

fn end_reset(world: &mut World<'_>, code: i32) {
    let host = reset_host(world);
    world.hosts.remove(&host);
    let exited = ProcessEvent::Exited(ExitStatus::Code(code), Vec::new());
    world.feed(Input::Host(host, exited));
}

fn outcomes(world: &World<'_>) -> Vec<(u64, Option<EpisodeOutcome>)> {
    let episodes = world.record.suites[0].episodes.iter();
    let outcome = |(_, outcome, _): &(_, EpisodeOutcome, _)| *outcome;
    episodes.map(|it| (it.episode.id, it.finished.as_ref().map(outcome))).collect()
}

#[test]
fn a_fixture_without_reset_is_restarted_for_each_episode() {
    let plan = plan(2);
    let mut world = started(&plan);
    world.ready(1);
    pass(&mut world);
    assert_eq!(outcomes(&world), [(1, None)], "its tear-down belongs to the episode");
    world.tear_down(0);
    world.ready(1);
    pass(&mut world);
    world.tear_down(0);
    world.finish();
    let passed = Some(EpisodeOutcome::Passed);
    assert_eq!(outcomes(&world), [(1, passed), (2, passed)]);
    assert_eq!(world.record.fixtures[0].starts, 2);
    assert!(world.record.is_green());
}

#[test]
fn a_fixture_with_reset_stays_up() {
    let plan = warm(3, None);
    let mut world = started(&plan);
    world.ready(1);
    pass(&mut world);
    world.restart_transcript();
    end_reset(&mut world, 0);
    insta::assert_snapshot!(world.transcript(), @"
    0.0  fixture-reset fixture=0
    0.0  test-started attempt=1 repetition=2 test=0
    ");
    world.answer(FIXTURE, "passed");
    pass(&mut world);
    end_reset(&mut world, 0);
    world.answer(FIXTURE, "passed");
    pass(&mut world);
    world.tear_down(0);
    world.finish();
    assert_eq!((world.record.fixtures[0].starts, outcomes(&world).len()), (1, 3));
}

#[test]
fn a_reset_that_fails_or_hangs_restarts_the_fixture() {
    let plan = warm(3, None);
    let mut world = started(&plan);
    world.ready(1);
    pass(&mut world);
    end_reset(&mut world, 1);
    world.tear_down(0);
    world.ready(1);
    pass(&mut world);
    world.hosts.remove(&reset_host(&world));
    world.next_deadline();
    world.tear_down(0);
    world.ready(1);
    pass(&mut world);
    world.tear_down(0);
    world.finish();
    let problem = |kind: &EventKind| match kind {
        EventKind::FixtureReset { problem, .. } => problem.clone(),
        _ => None,
    };
    let problems: Vec<_> = world.events.iter().filter_map(problem).collect();
    let expected = ["its command ended with exit code 1", "its command did not end within 4s"];
    assert_eq!(
        (problems, world.record.fixtures[0].starts),
        (expected.map(str::to_owned).into(), 3)
    );
    assert!(world.record.is_green(), "the fixture did not collapse");
}

#[test]
fn a_fixture_is_restarted_after_a_number_of_episodes() {
    let plan = warm(4, Some(2));
    let mut world = started(&plan);
    world.ready(1);
    pass(&mut world);
    end_reset(&mut world, 0);
    world.answer(FIXTURE, "passed");
    pass(&mut world);
    world.tear_down(0);
    world.ready(1);
    pass(&mut world);
    end_reset(&mut world, 0);
    world.answer(FIXTURE, "passed");
    pass(&mut world);
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.fixtures[0].starts, 2);
}

#[test]
fn a_failure_concerns_its_episode_only() {
    let plan = warm(2, None);
    let mut world = started(&plan);
    world.ready(1);
    fail(&mut world, TEST);
    world.next_deadline();
    world.pass(1);
    end_reset(&mut world, 0);
    world.answer(FIXTURE, "passed");
    pass(&mut world);
    world.tear_down(0);
    world.finish();
    let expected = [(1, Some(EpisodeOutcome::Failed)), (2, Some(EpisodeOutcome::Passed))];
    assert_eq!(outcomes(&world), expected);
    let first = world.record.suites[0].episodes[0].finished.clone();
    assert_eq!(first.and_then(|(.., reason)| reason).as_deref(), Some("test0: stuck"));
}

#[test]
fn after_a_critical_failure_the_next_episode_runs() {
    let mut plan = warm(2, None);
    plan.tests[0].settings.critical = true;
    let mut world = started(&plan);
    world.ready(1);
    fail(&mut world, TEST);
    world.next_deadline();
    end_reset(&mut world, 0);
    world.answer(FIXTURE, "passed");
    pass(&mut world);
    world.tear_down(0);
    world.finish();
    let expected = [(1, Some(EpisodeOutcome::Failed)), (2, Some(EpisodeOutcome::Passed))];
    assert_eq!(outcomes(&world), expected);
    assert_eq!(world.record.tests[1].attempts.len(), 1);
}

#[test]
fn a_collapse_is_the_bench_and_a_broken_fixture_ends_the_suite() {
    let plan = warm(3, None);
    let mut world = started(&plan);
    world.ready(1);
    for test in [TEST, SECOND_TEST] {
        world.phase(test, Phase::Run);
        world.collapse(FIXTURE, "lost");
        world.exit(test, ExitStatus::Signal(15));
        world.tear_down(0);
        if !world.done {
            world.ready(1);
        }
    }
    world.finish();
    assert_eq!(outcomes(&world), [(1, Some(EpisodeOutcome::Collapsed))]);
}

#[test]
fn an_interrupted_episode_has_no_result() {
    let plan = warm(2, None);
    let mut world = started(&plan);
    world.ready(1);
    world.phase(TEST, Phase::Run);
    world.stop(StopLevel::TearDown);
    world.exit(TEST, ExitStatus::Signal(15));
    world.tear_down(0);
    world.finish();
    assert_eq!(outcomes(&world), [(1, None)]);
}

#[test]
fn the_limit_of_the_suite_is_that_of_an_episode() {
    let mut plan = warm(2, None);
    plan.settings.timeout = Some(9 * SECOND);
    let mut world = started(&plan);
    world.ready(1);
    world.now += 8 * SECOND;
    pass(&mut world);
    end_reset(&mut world, 0);
    world.answer(FIXTURE, "passed");
    world.now += 8 * SECOND;
    pass(&mut world);
    world.tear_down(0);
    world.finish();
    assert!(world.record.is_green());
}

#[test]
fn tests_get_the_parameters_of_their_episode() {
    let mut plan = plan(1);
    plan.tests[0].plugin.param = "--mass ${episode:mass}".to_owned();
    plan.env = Arc::new(vec![("RTF_PARAM_MASS".to_owned(), "${episode:mass}".to_owned())]);
    let mut world = started(&plan);
    world.ready(1);
    let request = serde_json::to_string(&world.sent.last().unwrap().2).unwrap();
    assert!(request.contains("--mass 1.5"), "{request}");
    assert!(request.contains(r#"{"name":"mass","value":"1.5"}"#), "{request}");
}
