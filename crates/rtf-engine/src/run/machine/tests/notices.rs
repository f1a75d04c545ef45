//! What fixtures are told of tests, and what becomes of one that does not bear it.

use rtf_model::protocol::{Notification, Reply, Request};
use rtf_model::{
    Attachment, FixtureId, HookId, Measurement, Message, MessageKind, Source, Trigger, Verdict,
};

use super::world::{TEST, World, hook, suite};
use crate::run::machine::{Deadline, FixtureTimer, HostInput, StopLevel};

const RECORDER: Source = Source::Fixture(FixtureId(0));

/// What the fixture was told last.
fn told(world: &World<'_>) -> String {
    match &world.sent.last().expect("something was sent").2 {
        Request::TestStarted(starts) => {
            let test = &starts.test;
            format!("{} {}.{} starts", test.name, test.repetition, test.attempt)
        }
        Request::TestFinished(ends) => {
            let reason = ends.reason.as_deref().unwrap_or("no reason");
            format!("{} {}: {reason}", ends.test.name, ends.verdict)
        }
        other => format!("{other:?}"),
    }
}

/// A suite whose fixture was told that its test begins, and whose test runs.
fn begun<'p>(plan: &'p rtf_plan::plan::SuitePlan) -> World<'p> {
    let mut world = World::started(plan);
    world.set_up_to_hear(0);
    world.answer(RECORDER, "passed");
    assert_eq!(told(&world), "test0 1.1 starts");
    assert!(!world.story().contains("test-started"), "{}", world.story());
    world.answer(RECORDER, "passed");
    world
}

fn report(world: &mut World<'_>, kind: MessageKind, text: &str) {
    let (location, comparison) = (None, None);
    let message = Message { kind, text: text.to_owned(), location, comparison, critical: false };
    world.input(RECORDER, HostInput::Told(Notification::Message(message)));
}

fn attach(world: &mut World<'_>) {
    let attachment = Attachment {
        name: "run.mcap".to_owned(),
        path: "attachments/fixture-0/1/1-run.mcap".to_owned(),
        media_type: String::new(),
    };
    world.input(RECORDER, HostInput::Attached(Ok(attachment)));
}

#[test]
fn what_a_fixture_keeps_at_the_end_of_a_test_is_the_tests() {
    let plan = suite(1, 1);
    let mut world = begun(&plan);
    report(&mut world, MessageKind::Report, "the disk is slow");
    world.pass(0);
    assert_eq!(told(&world), "test0 passed: no reason");
    attach(&mut world);
    let (value, low, high, location) = (Some(3.5), None, None, None);
    let (name, unit) = ("size".to_owned(), "MB".to_owned());
    let measurement = Measurement { name, value, unit, low, high, location };
    world.input(RECORDER, HostInput::Told(Notification::Measured(measurement)));
    let samples = r#"{"name":"speed","points":[[0,1]]}"#;
    let samples = serde_json::from_str(samples).unwrap();
    world.input(RECORDER, HostInput::Told(Notification::Sampled(samples)));
    report(&mut world, MessageKind::Report, "kept 3.5 MB");
    assert!(!world.story().contains("test-finished"), "{}", world.story());
    world.answer(RECORDER, "passed");
    world.tear_down(0);
    world.finish();
    insta::assert_snapshot!(world.story(), @"
    0.0  suite-started
    0.0  fixture-starting attempt=1 fixture=0
    0.0  fixture-ready fixture=0
    0.0  test-started attempt=1 repetition=1 test=0
    0.0  message source={fixture:0}
    0.0  test-phase phase=setup test=0
    0.0  test-phase phase=run test=0
    0.0  test-phase phase=tear-down test=0
    0.0    → close the channel
    0.0  test-phase phase=notify test=0
    0.0  attached attachment={media_type:,name:run.mcap,path:attachments/fixture-0/1/1-run.mcap} fixture=0 test=0
    0.0  measured fixture=0 measurement={name:size,unit:MB,value:3.5} test=0
    0.0  message source={fixture:0}
    0.0  message source={fixture:0} test=0
    0.0  test-finished exit={code:0} phase=exit test=0 verdict=passed
    0.0  fixture-stopping fixture=0
    0.0    → close the channel
    0.0  fixture-stopped fixture=0
    0.0  suite-finished
    ");
    let attempt = &world.record.tests[0].attempts[0];
    let texts: Vec<_> = attempt.messages.iter().map(|message| message.text.as_str()).collect();
    assert_eq!(texts, ["kept 3.5 MB"]);
    assert_eq!((attempt.attachments.len(), attempt.measurements.len()), (1, 1));
    assert!(world.record.is_green());
}

#[test]
fn a_fixture_that_asked_for_nothing_is_told_nothing() {
    let plan = suite(1, 1);
    let mut world = World::started(&plan);
    for _ in ["set-up", "check"] {
        world.answer(RECORDER, "passed");
    }
    world.pass(0);
    world.tear_down(0);
    world.finish();
    let tells =
        |request: &Request| matches!(request, Request::TestStarted(_) | Request::TestFinished(_));
    assert!(!world.sent.iter().any(|(_, _, request)| tells(request)), "{:?}", world.sent);
    assert!(!world.story().contains("notice"), "{}", world.story());
}

#[test]
fn the_verdict_stands_when_a_fixture_hangs_while_it_is_told() {
    let plan = suite(1, 1);
    let mut world = begun(&plan);
    world.pass(0);
    assert_eq!(world.next_deadline(), Deadline::Fixture(0, FixtureTimer::Notice));
    assert_eq!(world.record.tests[0].verdict(), Some(Verdict::Passed));
    world.tear_down(0);
    world.finish();
    let why = &world.record.fixtures[0].collapses[0].1;
    assert_eq!(why, "testFinished did not end within 2s");
    assert!(!world.record.is_green());
}

#[test]
fn an_error_at_the_end_of_a_test_is_the_fixtures() {
    let plan = suite(1, 1);
    let mut world = begun(&plan);
    world.pass(0);
    report(&mut world, MessageKind::Error, "the disk is full");
    world.answer(RECORDER, "error");
    world.tear_down(0);
    world.finish();
    assert!(world.record.tests[0].attempts[0].messages.is_empty());
    let fixture = &world.record.fixtures[0];
    assert_eq!(fixture.messages[0].text, "the disk is full");
    assert_eq!(fixture.collapses[0].1, "testFinished failed: says error");
}

#[test]
fn a_test_does_not_begin_before_a_fixture_has_borne_the_news() {
    let plan = suite(1, 1);
    let mut world = World::started(&plan);
    world.set_up_to_hear(0);
    world.answer(RECORDER, "passed");
    world.answer(RECORDER, "failed");
    assert_eq!(world.record.fixtures[0].collapses[0].1, "testStarted failed: says failed");
    world.tear_down(0);
    world.set_up_to_hear(0);
    world.answer(RECORDER, "passed");
    assert_eq!(told(&world), "test0 1.1 starts");
    world.answer(RECORDER, "passed");
    world.pass(0);
    world.answer(RECORDER, "passed");
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.tests[0].attempts.len(), 1);
    assert_eq!(world.record.tests[0].verdict(), Some(Verdict::Passed));
}

#[test]
fn fixtures_are_told_of_a_test_that_another_ones_collapse_ended() {
    let mut plan = suite(2, 1);
    plan.fixtures[1].depends.clear();
    let mut world = World::new(&plan);
    let robot = Source::Fixture(FixtureId(1));
    world.start();
    world.set_up_to_hear(0);
    for _ in ["set-up", "check"] {
        world.answer(robot, "passed");
    }
    world.answer(RECORDER, "passed");
    world.answer(RECORDER, "passed");
    world.collapse(robot, "it fell");
    world.end(TEST, "interrupted");
    assert_eq!(told(&world), "test0 collapsed: fixture `fixture1` collapsed: it fell");
    attach(&mut world);
    world.answer(RECORDER, "passed");
    world.tear_down(0);
    world.tear_down(1);
    world.finish();
    assert_eq!(world.record.tests[0].attempts[0].attachments.len(), 1);
}

/// The recorder takes its time; the robot is parked meanwhile, and the next test
/// waits for both.
#[test]
fn a_robot_is_parked_while_a_recorder_is_told_how_the_test_ended() {
    let mut plan = suite(1, 2);
    plan.hooks = vec![hook(0, &[Trigger::Failure])];
    let parking = Source::Hook(HookId(0));
    for recorder_is_first in [false, true] {
        let mut world = begun(&plan);
        world.phase(TEST, rtf_model::Phase::Run);
        world.failure(TEST, "the arm is stuck", false);
        world.end(TEST, "failed");
        world.next_deadline();
        assert_eq!(told(&world), "test0 failed: the arm is stuck");
        world.host_of(parking);
        if recorder_is_first {
            attach(&mut world);
            world.answer(RECORDER, "passed");
            assert_eq!(world.record.tests[0].verdict(), Some(Verdict::Failed));
            world.exit(parking, rtf_model::ExitStatus::Code(0));
        } else {
            world.exit(parking, rtf_model::ExitStatus::Code(0));
            assert_eq!(world.record.tests[0].verdict(), None);
            attach(&mut world);
            world.answer(RECORDER, "passed");
        }
        let runs = &world.record.hooks[0].runs;
        assert_eq!((runs.len(), runs[0].problem()), (1, None));
        assert_eq!(runs[0].reason, "`test0` is failed: the arm is stuck");
        assert_eq!(world.record.tests[0].attempts[0].attachments.len(), 1);
        world.answer(RECORDER, "passed");
        world.answer(RECORDER, "passed");
        world.pass(1);
        world.answer(RECORDER, "passed");
        world.tear_down(0);
        world.finish();
    }
}

/// Not even one that hangs keeps the hooks waiting that end a run.
#[test]
fn a_run_that_is_stopped_parks_the_robot_before_a_recorder_has_heard_of_it() {
    let mut plan = suite(1, 1);
    plan.hooks = vec![hook(0, &[Trigger::Interrupt]), hook(1, &[Trigger::End])];
    let mut world = begun(&plan);
    world.stop(StopLevel::TearDown);
    world.end(TEST, "interrupted");
    for hook in 0..2 {
        world.exit(Source::Hook(HookId(hook)), rtf_model::ExitStatus::Code(0));
    }
    assert_eq!(world.now, std::time::Duration::ZERO);
    assert!(world.record.tests[0].is_running(), "the recorder has not answered");
    assert_eq!(world.next_deadline(), Deadline::Fixture(0, FixtureTimer::Notice));
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.tests[0].verdict(), Some(Verdict::Interrupted));
    assert!(world.record.hooks.iter().all(|hook| hook.runs.len() == 1));
}

#[test]
fn a_run_that_is_killed_waits_for_nobody() {
    let plan = suite(1, 2);
    let mut world = begun(&plan);
    world.pass(0);
    world.stop(StopLevel::TearDown);
    world.stop(StopLevel::Kill);
    assert_eq!(world.record.tests[0].verdict(), Some(Verdict::Passed));
    world.exit(RECORDER, rtf_model::ExitStatus::Signal(9));
    world.finish();
}

#[test]
fn what_is_kept_when_no_test_ends_is_an_error_of_the_fixture() {
    let plan = suite(1, 1);
    let mut world = begun(&plan);
    attach(&mut world);
    world.pass(0);
    world.answer(RECORDER, "passed");
    world.tear_down(0);
    world.finish();
    let said = &world.record.fixtures[0].messages[0].text;
    assert_eq!(said, "the file `run.mcap` is not kept: there is no test that it belongs to");
}

#[test]
fn tests_that_run_at_once_are_told_one_by_one() {
    let mut plan = suite(1, 2);
    plan.parallel = 2;
    let mut world = World::started(&plan);
    world.set_up_to_hear(0);
    world.answer(RECORDER, "passed");
    let starts: Vec<u64> = requests(&world, |r| matches!(r, Request::TestStarted(_)));
    assert_eq!(starts.len(), 2);
    answer(&mut world, starts[0]);
    assert!(world.story().contains("test-started attempt=1 repetition=1 test=0"));
    assert!(!world.story().contains("repetition=1 test=1"), "{}", world.story());
    answer(&mut world, starts[1]);
    world.pass(1);
    world.pass(0);
    let ends = |world: &World<'_>| requests(world, |r| matches!(r, Request::TestFinished(_)));
    // The host is still with the end of the second test, and can say later only
    // whether it was well at the end of the first.
    attach(&mut world);
    let first = ends(&world)[0];
    answer(&mut world, first);
    assert_eq!(world.record.tests[1].verdict(), Some(Verdict::Passed));
    assert_eq!(ends(&world).len(), 1);
    world.examined(0);
    assert_eq!(world.record.tests[0].verdict(), None);
    attach(&mut world);
    attach(&mut world);
    let second = ends(&world)[1];
    answer(&mut world, second);
    world.tear_down(0);
    world.finish();
    let kept = |test: usize| world.record.tests[test].attempts[0].attachments.len();
    assert_eq!((kept(0), kept(1)), (2, 1));
}

/// The numbers of the requests of a kind.
fn requests(world: &World<'_>, kind: impl Fn(&Request) -> bool) -> Vec<u64> {
    world.sent.iter().filter(|(_, _, request)| kind(request)).filter_map(|sent| sent.1).collect()
}

fn answer(world: &mut World<'_>, request: u64) {
    let passed = serde_json::json!({ "outcome": "passed" });
    world.input(RECORDER, HostInput::Answered(request, Reply::Result(passed)));
}
