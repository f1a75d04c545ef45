//! Tests that run many episodes of a campaign in one process.

use rtf_model::protocol::{EpisodeSlots, Notification, Request};
use rtf_model::{
    CaseEpisode, CaseId, CaseStart, Episode, EpisodeEnd, EpisodeOutcome, ExitStatus, MessageKind,
    Outcome, Parameter, Phase, TestId, Verdict,
};

use super::world::{FIXTURE, SECOND, TEST, World, suite};
use crate::run::machine::{Deadline, Input, ProcessEvent, StopLevel, TestTimer};
use rtf_plan::plan::SuitePlan;

const LIMIT: Deadline = Deadline::Test(TestId(0), TestTimer::Limit);

fn episode(id: u64) -> Episode {
    let parameter = Parameter { name: "mass".to_owned(), value: format!("{id}.5") };
    Episode::new(id, 7, vec![parameter])
}

fn plan(slots: u32, episodes: u64) -> SuitePlan {
    let mut plan = suite(1, 1);
    plan.tests[0].slots = Some(EpisodeSlots { slots, max_steps: None, max_time_us: None });
    plan.episodes = (1..=episodes).map(episode).collect();
    plan
}

/// The test runs, and has its first episodes.
fn running(plan: &SuitePlan) -> World<'_> {
    let mut world = World::timed(plan);
    world.start();
    world.ready(plan.fixtures.len());
    world.phase(TEST, Phase::Run);
    world
}

/// The episodes of each message to the host; an empty list says that none follows.
fn sent(world: &World<'_>) -> Vec<Vec<u64>> {
    let ids = |request: &Request| match request {
        Request::Episodes { episodes } => Some(episodes.iter().map(|it| it.id).collect()),
        Request::EndOfEpisodes {} => Some(Vec::new()),
        _ => None,
    };
    world.sent.iter().filter_map(|(_, _, request)| ids(request)).collect()
}

fn begin(world: &mut World<'_>, case: u32, id: u64) {
    let name = "any".to_owned();
    let start = CaseStart {
        episode: Some(CaseEpisode { id, seed: 0 }),
        ..CaseStart::new(CaseId(case), name)
    };
    world.notified(Notification::CaseStarted(start));
}

fn end(world: &mut World<'_>, case: u32, outcome: Outcome) {
    let reason = (outcome != Outcome::Passed).then(|| "it fell".to_owned());
    let episode = EpisodeEnd { steps: Some(12), time_us: Some(500_000), ..EpisodeEnd::default() };
    world.notified(Notification::CaseFinished {
        case: CaseId(case),
        outcome: Some(outcome),
        reason,
        duration_us: None,
        rerun: false,
        episode: Some(Box::new(episode)),
    });
}

fn tear_down(world: &mut World<'_>) {
    world.phase(TEST, Phase::TearDown);
    world.end(TEST, "passed");
    if !world.record.fixtures.is_empty() {
        world.pass_examination(0);
        world.tear_down(0);
    }
    world.finish();
}

fn outcomes(world: &World<'_>) -> Vec<(u64, EpisodeOutcome)> {
    let episodes = world.record.suites[0].episodes.iter();
    episodes.filter_map(|it| Some((it.episode.id, it.finished.as_ref()?.1))).collect()
}

#[test]
fn episodes_are_handed_out_as_slots_become_free_and_end_in_any_order() {
    let mut plan = plan(2, 6);
    plan.fixtures.clear();
    let mut world = running(&plan);
    assert_eq!(sent(&world), [vec![1, 2, 3, 4]], "two run, and two wait");
    begin(&mut world, 1, 1);
    begin(&mut world, 2, 2);
    end(&mut world, 2, Outcome::Passed);
    assert_eq!(sent(&world)[1..], [vec![5]]);
    begin(&mut world, 3, 3);
    world.message_in(3, MessageKind::Failure, "it slipped");
    end(&mut world, 3, Outcome::Passed);
    assert_eq!(sent(&world)[2..], [vec![6], vec![]], "none follows");
    end(&mut world, 1, Outcome::TimedOut);
    for (case, id) in [(4, 5), (5, 4), (6, 6)] {
        begin(&mut world, case, id);
        end(&mut world, case, Outcome::Passed);
    }
    tear_down(&mut world);
    use EpisodeOutcome::{Failed, Passed};
    let expected = [(2, Passed), (3, Failed), (1, Failed), (5, Passed), (4, Passed), (6, Passed)];
    assert_eq!(outcomes(&world), expected);
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::TimedOut));
    let case = &world.record.tests[0].attempts[0].cases.kept()[2];
    assert_eq!((&*case.start.name, &*case.start.parameters[0].value), ("3", "3.5"));
    assert_eq!(case.start.episode, Some(CaseEpisode { id: 3, seed: 7 }));
    let suite = world.record.suites[0].plan.suite;
    let measured = world.record.episode_measurements(suite);
    let measured: Vec<_> = measured.iter().map(|(_, it)| (&*it.name, it.value)).collect();
    assert_eq!(measured, [("steps", Some(12.0)), ("simulated time", Some(0.5))]);
}

#[test]
fn an_episode_alone_runs_with_no_other_one() {
    let mut plan = plan(2, 4);
    let mut episodes = plan.episodes.to_vec();
    episodes[1].alone = true;
    plan.episodes = episodes.into();
    let mut world = running(&plan);
    assert_eq!(sent(&world), [[1]]);
    begin(&mut world, 1, 1);
    assert_eq!(sent(&world).len(), 1);
    end(&mut world, 1, Outcome::Passed);
    assert_eq!(sent(&world)[1..], [[2]]);
    begin(&mut world, 2, 2);
    end(&mut world, 2, Outcome::Passed);
    assert_eq!(sent(&world)[2..], [vec![3, 4], vec![]]);
}

#[test]
fn blinded_trials_do_not_show_their_versions() {
    let mut plan = plan(2, 2);
    let mut episodes = plan.episodes.to_vec();
    episodes.iter_mut().for_each(|episode| episode.masked = vec!["1.5".to_owned()]);
    plan.episodes = episodes.into();
    let mut world = running(&plan);
    begin(&mut world, 1, 1);
    let started = world.log.last().cloned().unwrap_or_default();
    assert!(started.contains("mass") && !started.contains("1.5"), "{started}");
}

#[test]
fn of_several_open_episodes_none_has_a_result_when_the_process_ends() {
    let plan = plan(2, 4);
    let mut world = running(&plan);
    begin(&mut world, 1, 1);
    end(&mut world, 1, Outcome::Passed);
    begin(&mut world, 2, 2);
    begin(&mut world, 3, 3);
    world.message_in(3, MessageKind::Failure, "it slipped");
    world.exit(TEST, ExitStatus::Signal(11));
    world.pass_examination(0);
    world.next_deadline();
    world.tear_down(0);
    world.finish();
    assert_eq!(outcomes(&world), [(1, EpisodeOutcome::Passed)]);
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Crashed));
}

#[test]
fn a_crash_is_the_result_of_the_only_open_episode() {
    let plan = plan(2, 1);
    let mut world = running(&plan);
    begin(&mut world, 1, 1);
    world.exit(TEST, ExitStatus::Signal(11));
    world.pass_examination(0);
    world.next_deadline();
    world.tear_down(0);
    world.finish();
    assert_eq!(outcomes(&world), [(1, EpisodeOutcome::Failed)]);
}

#[test]
fn a_collapse_is_that_of_the_only_open_episode() {
    let plan = plan(2, 4);
    let mut world = running(&plan);
    begin(&mut world, 1, 1);
    world.collapse(FIXTURE, "gone");
    world.end(TEST, "interrupted");
    world.tear_down(0);
    world.finish();
    assert_eq!(outcomes(&world), [(1, EpisodeOutcome::Collapsed)]);
}

#[test]
fn each_episode_has_the_limit_from_its_start() {
    let plan = plan(2, 3);
    let mut world = running(&plan);
    let limit = plan.tests[0].limits.run;
    begin(&mut world, 1, 1);
    world.now += SECOND;
    begin(&mut world, 2, 2);
    let first = world.now - SECOND;
    assert_eq!(world.deadlines[&LIMIT], first + limit);
    end(&mut world, 1, Outcome::Passed);
    assert_eq!(world.deadlines[&LIMIT], first + SECOND + limit);
    world.next_deadline();
    let reason = format!("episode 2 did not end within {limit:?}");
    assert!(world.log.iter().any(|line| line.contains(&reason)), "{:#?}", world.log);
}

#[test]
fn no_limit_runs_while_no_episode_has_arrived() {
    let mut plan = plan(2, 1);
    plan.awaits_episodes = true;
    let mut world = running(&plan);
    begin(&mut world, 1, 1);
    end(&mut world, 1, Outcome::Passed);
    assert!(!world.deadlines.contains_key(&LIMIT));
    world.feed(Input::Episode(Some(episode(2))));
    assert!(world.deadlines.contains_key(&LIMIT));
    world.feed(Input::Episode(None));
    assert_eq!(sent(&world), [vec![1], vec![2], vec![]]);
    begin(&mut world, 2, 2);
    end(&mut world, 2, Outcome::Passed);
    tear_down(&mut world);
    assert_eq!(outcomes(&world).len(), 2);
}

#[test]
fn a_run_that_ends_early_is_an_error() {
    for (ids, expected) in [(2, "without 3 of the episodes"), (0, "without 4 of the episodes")] {
        let plan = plan(2, 4);
        let mut world = running(&plan);
        for id in 1..ids {
            begin(&mut world, u32::try_from(id).unwrap(), id);
            end(&mut world, u32::try_from(id).unwrap(), Outcome::Passed);
        }
        tear_down(&mut world);
        assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Error));
        let reason = world.record.tests[0].reason().unwrap().to_owned();
        assert!(reason.contains(expected), "{reason}");
    }
}

#[test]
fn an_episode_that_was_not_sent_is_a_protocol_error() {
    let problem = |act: &dyn Fn(&mut World<'_>)| {
        let plan = plan(1, 2);
        let mut world = running(&plan);
        act(&mut world);
        world.exit(TEST, ExitStatus::Code(0));
        world.pass_examination(0);
        world.tear_down(0);
        world.finish();
        world.record.tests[0].reason().unwrap_or_default().to_owned()
    };
    let twice = problem(&|world| {
        begin(world, 1, 1);
        end(world, 1, Outcome::Passed);
        begin(world, 2, 1);
    });
    assert!(twice.contains("started episode 1, which it did not get or started before"), "{twice}");
    let unknown = problem(&|world| begin(world, 1, 17));
    assert!(unknown.contains("started episode 17, which it did not get"), "{unknown}");
    let many = problem(&|world| {
        begin(world, 1, 1);
        begin(world, 2, 2);
    });
    assert!(many.contains("started episode 2 although all 1 slots are in use"), "{many}");
    let outside = problem(&|world| world.case(1, "alone", None));
    assert!(outside.contains("started the case `alone` outside of an episode"), "{outside}");
}

#[test]
fn an_interrupted_run_gives_its_episodes_no_result() {
    let plan = plan(2, 4);
    let mut world = running(&plan);
    begin(&mut world, 1, 1);
    world.stop(StopLevel::TearDown);
    world.input(TEST, ProcessEvent::Exited(ExitStatus::Code(0), Vec::new()));
    world.tear_down(0);
    world.finish();
    assert!(outcomes(&world).is_empty());
}
