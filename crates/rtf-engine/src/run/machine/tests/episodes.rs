//! The episodes of a campaign.

use std::sync::Arc;

use rtf_model::{Episode, EpisodeOutcome, EventKind, ExitStatus, Parameter, Phase, Source, TestId};

use rtf_model::protocol::Reply;

use super::shared::continue_after;
use super::world::{FIXTURE, SECOND, TEST, World, suite};
use crate::hook::RUN_REQUEST;
use crate::run::machine::{Deadline, HostId, Input, ProcessEvent, StopLevel};
use rtf_plan::plan::{HookBody, ResetPlan, SuitePlan};
use rtf_process::codec::INITIALIZE;

const SECOND_TEST: Source = Source::Test(TestId(1));

/// A suite with a fixture, two tests, and episodes.
fn plan(episodes: u64) -> SuitePlan {
    let mut plan = suite(1, 2);
    plan.refers_to_values = true;
    let episode = |id| {
        let value = format!("{id}.5");
        Episode {
            id,
            seed: 7,
            parameters: vec![Parameter { name: "mass".to_owned(), value }],
            masked: Vec::new(),
        }
    };
    plan.episodes = (1..=episodes).map(episode).collect();
    plan
}

fn warm(episodes: u64, restart_every: Option<u32>) -> SuitePlan {
    let mut plan = plan(episodes);
    let command = vec!["reset".to_owned(), "${episode:mass}".to_owned()];
    let body = HookBody::Command(command);
    plan.fixtures[0].reset = Some(ResetPlan { body, timeout: 4 * SECOND, restart_every });
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

/// The fixture is reset, and all tests of the next episode pass.
fn pass_after_reset(world: &mut World<'_>) {
    end_reset(world, 0);
    world.answer(FIXTURE, "passed");
    pass(world);
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
    pass_after_reset(&mut world);
    world.tear_down(0);
    world.finish();
    assert_eq!((world.record.fixtures[0].starts, outcomes(&world).len()), (1, 3));
}

/// As a hook: it has to pass.
#[test]
fn a_plug_in_resets_a_fixture() {
    let mut plan = warm(3, None);
    let plugin = plan.tests[0].plugin.clone();
    plan.fixtures[0].reset.as_mut().unwrap().body = HookBody::Plugin(plugin);
    let mut world = started(&plan);
    world.ready(1);
    pass(&mut world);
    let answer = |world: &mut World<'_>, outcome: &str| {
        let answer = serde_json::json!({ "outcome": outcome, "reason": "the arm is stuck" });
        let replied = ProcessEvent::Replied(RUN_REQUEST, Reply::Result(answer));
        world.feed(Input::Host(reset_host(world), replied));
        end_reset(world, 0);
    };
    let requested = world.sent.last().map(|(host, id, _)| (*host, *id));
    assert_eq!(requested, Some((reset_host(&world), Some(RUN_REQUEST))));
    answer(&mut world, "passed");
    world.answer(FIXTURE, "passed");
    pass(&mut world);
    answer(&mut world, "failed");
    world.tear_down(0);
    world.ready(1);
    pass(&mut world);
    world.tear_down(0);
    world.finish();
    let problem = |kind: &EventKind| match kind {
        EventKind::FixtureReset { problem, .. } => Some(problem.clone()),
        _ => None,
    };
    let problems: Vec<_> = world.events.iter().filter_map(problem).collect();
    assert_eq!(problems, [None, Some("the arm is stuck".to_owned())]);
    assert_eq!(world.record.fixtures[0].starts, 2);
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
    let expected = ["it ended with exit code 1", "it did not end within 4s"];
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
    pass_after_reset(&mut world);
    world.tear_down(0);
    world.ready(1);
    pass(&mut world);
    pass_after_reset(&mut world);
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
    pass_after_reset(&mut world);
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
    pass_after_reset(&mut world);
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

/// Also after it has failed: the host sets the variables of each episode.
#[test]
fn tests_of_several_episodes_share_a_host() {
    let mut plan = plan(3);
    plan.fixtures.clear();
    plan.tests.truncate(1);
    plan.tests[0].settings.shared = true;
    plan.tests[0].env = vec![("RTF_PARAM_MASS".to_owned(), "${episode:mass}".to_owned())];
    let mut world = started(&plan);
    let initialized = serde_json::json!({ "protocol": 1, "host": "h", "supports_shared": true });
    world.input(TEST, ProcessEvent::Replied(INITIALIZE, Reply::Result(initialized)));
    for _ in 0..2 {
        let host = continue_after(&mut world, 0, Some("stuck"));
        world.release(host);
        assert!(world.begin_assigned(host), "the host gets the next episode");
    }
    world.pass(0);
    world.finish();
    let joined = world.joined.iter();
    let joined: Vec<_> = joined.map(|it| (it.variables[0].value.as_str(), it.is_last)).collect();
    assert_eq!(joined, [("2.5", false), ("3.5", true)]);
    assert!(world.joined.iter().all(|plugin| plugin.continues_after_failure));
    let (failed, passed) = (Some(EpisodeOutcome::Failed), Some(EpisodeOutcome::Passed));
    assert_eq!(outcomes(&world), [(1, failed), (2, failed), (3, passed)]);
}

/// The limit passes before a test has started, so that no test has a problem.
#[test]
fn an_episode_whose_tests_did_not_run_has_not_passed() {
    let mut plan = warm(2, None);
    plan.settings.timeout = Some(9 * SECOND);
    plan.fixtures[0].limits.setup = 20 * SECOND;
    let mut world = started(&plan);
    world.next_deadline();
    world.tear_down(0);
    world.finish();
    assert_eq!(outcomes(&world), [(1, Some(EpisodeOutcome::Error))]);
}

#[test]
fn repetitions_of_earlier_episodes_do_not_count() {
    let mut plan = warm(2, None);
    plan.tests[1].settings.repetitions = 2;
    let mut world = started(&plan);
    world.ready(1);
    pass(&mut world);
    world.pass(1);
    pass_after_reset(&mut world);
    world.pass(1);
    world.tear_down(0);
    world.finish();
    let passed = Some(EpisodeOutcome::Passed);
    assert_eq!(outcomes(&world), [(1, passed), (2, passed)]);
}

/// A suite with one episode, whose others arrive while it runs.
fn stream() -> SuitePlan {
    let mut plan = warm(1, None);
    plan.settings.timeout = Some(90 * SECOND);
    plan.awaits_episodes = true;
    plan
}

fn arrive(world: &mut World<'_>, id: u64) {
    let episode = plan(id).episodes.last().cloned();
    world.feed(Input::Episode(episode));
}

#[test]
fn an_episode_has_its_result_before_the_next_one_arrives() {
    let plan = stream();
    let mut world = started(&plan);
    world.ready(1);
    pass(&mut world);
    assert_eq!(outcomes(&world), [(1, Some(EpisodeOutcome::Passed))]);
    assert_eq!(world.hosts.len(), 1, "only the fixture runs: it is not reset yet");
    assert!(!world.deadlines.contains_key(&Deadline::Suite));
    arrive(&mut world, 2);
    arrive(&mut world, 3);
    pass_after_reset(&mut world);
    pass_after_reset(&mut world);
    world.feed(Input::Episode(None));
    world.tear_down(0);
    world.finish();
    assert_eq!((world.record.fixtures[0].starts, outcomes(&world).len()), (1, 3));
}

#[test]
fn a_stream_can_end_during_an_episode() {
    let plan = stream();
    let mut world = started(&plan);
    world.ready(1);
    arrive(&mut world, 2);
    world.feed(Input::Episode(None));
    pass(&mut world);
    pass_after_reset(&mut world);
    world.tear_down(0);
    world.finish();
    assert_eq!(outcomes(&world).len(), 2);
}

#[test]
fn a_collapse_between_episodes_belongs_to_none() {
    let plan = stream();
    let mut world = started(&plan);
    world.ready(1);
    pass(&mut world);
    world.collapse(FIXTURE, "gone");
    world.tear_down(0);
    arrive(&mut world, 2);
    world.ready(1);
    pass(&mut world);
    world.feed(Input::Episode(None));
    world.tear_down(0);
    world.finish();
    let passed = Some(EpisodeOutcome::Passed);
    assert_eq!(outcomes(&world), [(1, passed), (2, passed)]);
    assert_eq!(world.record.fixtures[0].starts, 2);
}
