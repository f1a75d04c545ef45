//! Notifications of fixtures about tests, and fixtures that fail on them.

use rtf_model::protocol::{Notification, Reply, Request};
use rtf_model::{
    Attachment, EventKind, FixtureId, HookId, Measurement, Message, MessageKind, Source, Trigger,
    Verdict,
};

use super::world::{TEST, World, hook, suite};
use crate::run::machine::{Deadline, FixtureTimer, Input, ProcessEvent, StopLevel};

const RECORDER: Source = Source::Fixture(FixtureId(0));

fn last_notification(world: &World<'_>) -> String {
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

/// A suite whose fixture was notified of its first test, which runs.
fn notified<'p>(plan: &'p rtf_plan::plan::SuitePlan) -> World<'p> {
    let mut world = World::started(plan);
    world.set_up_subscribed(0);
    world.answer(RECORDER, "passed");
    assert_eq!(last_notification(&world), "test0 1.1 starts");
    assert!(!world.transcript().contains("test-started"), "{}", world.transcript());
    world.answer(RECORDER, "passed");
    world
}

fn report(world: &mut World<'_>, kind: MessageKind, text: &str) {
    let (location, comparison) = (None, None);
    let message = Message {
        kind,
        text: text.to_owned(),
        location,
        comparison,
        critical: false,
        case: None,
        interval: None,
    };
    world.input(RECORDER, ProcessEvent::Notified(Notification::Message(message)));
}

fn attach(world: &mut World<'_>) {
    let attachment = Attachment {
        name: "run.mcap".to_owned(),
        path: "attachments/fixture-0/1/1-run.mcap".to_owned(),
        media_type: String::new(),
        case: None,
        picture: None,
        omitted: false,
    };
    world.input(RECORDER, ProcessEvent::Attached(Ok(attachment)));
}

#[test]
fn results_that_a_fixture_sends_at_a_tests_end_belong_to_the_test() {
    let plan = suite(1, 1);
    let mut world = notified(&plan);
    report(&mut world, MessageKind::Report, "the disk is slow");
    world.pass(0);
    assert_eq!(last_notification(&world), "test0 passed: no reason");
    attach(&mut world);
    let (value, low, high, location) = (Some(3.5), None, None, None);
    let (name, unit) = ("size".to_owned(), "MB".to_owned());
    let measurement =
        Measurement { learned: false, name, value, unit, low, high, location, case: None };
    world.input(RECORDER, ProcessEvent::Notified(Notification::Measured(measurement)));
    let samples = r#"{"name":"speed","points":[[0,1]]}"#;
    let samples = serde_json::from_str(samples).unwrap();
    world.input(RECORDER, ProcessEvent::Notified(Notification::Sampled(samples)));
    report(&mut world, MessageKind::Report, "kept 3.5 MB");
    assert!(!world.transcript().contains("test-finished"), "{}", world.transcript());
    world.answer(RECORDER, "passed");
    world.tear_down(0);
    world.finish();
    insta::assert_snapshot!(world.transcript(), @"
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
fn a_fixture_without_subscriptions_is_not_notified() {
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
    assert!(!world.transcript().contains("notice"), "{}", world.transcript());
}

#[test]
fn the_verdict_stands_if_a_fixture_hangs_in_its_notification() {
    let plan = suite(1, 1);
    let mut world = notified(&plan);
    world.pass(0);
    assert_eq!(world.next_deadline(), Deadline::Fixture(0, FixtureTimer::Notification));
    assert_eq!(world.record.tests[0].verdict(), Some(Verdict::Passed));
    world.tear_down(0);
    world.finish();
    let why = &world.record.fixtures[0].collapses[0].1;
    assert_eq!(why, "testFinished did not end within 2s");
    assert!(!world.record.is_green());
}

#[test]
fn an_error_in_a_notification_belongs_to_the_fixture() {
    let plan = suite(1, 1);
    let mut world = notified(&plan);
    world.pass(0);
    report(&mut world, MessageKind::Error, "the disk is full");
    world.answer(RECORDER, "error");
    world.tear_down(0);
    world.finish();
    assert!(world.record.tests[0].attempts[0].messages.is_empty());
    let fixture = &world.record.fixtures[0];
    assert_eq!(fixture.messages[0].text, "the disk is full");
    assert_eq!(fixture.collapses[0].1, "testFinished failed: the disk is full");
}

#[test]
fn a_test_does_not_start_before_its_notification_succeeds() {
    let plan = suite(1, 1);
    let mut world = World::started(&plan);
    world.set_up_subscribed(0);
    world.answer(RECORDER, "passed");
    world.answer(RECORDER, "failed");
    assert_eq!(world.record.fixtures[0].collapses[0].1, "testStarted failed: says failed");
    world.tear_down(0);
    world.set_up_subscribed(0);
    world.answer(RECORDER, "passed");
    assert_eq!(last_notification(&world), "test0 1.1 starts");
    world.answer(RECORDER, "passed");
    world.pass(0);
    world.answer(RECORDER, "passed");
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.tests[0].attempts.len(), 1);
    assert_eq!(world.record.tests[0].verdict(), Some(Verdict::Passed));
}

#[test]
fn fixtures_are_notified_of_a_test_that_another_collapse_ended() {
    let mut plan = suite(2, 1);
    plan.fixtures[1].depends.clear();
    let mut world = World::new(&plan);
    let robot = Source::Fixture(FixtureId(1));
    world.start();
    world.set_up_subscribed(0);
    for _ in ["set-up", "check"] {
        world.answer(robot, "passed");
    }
    world.answer(RECORDER, "passed");
    world.answer(RECORDER, "passed");
    world.collapse(robot, "it fell");
    world.end(TEST, "interrupted");
    assert_eq!(last_notification(&world), "test0 collapsed: fixture `fixture1` collapsed: it fell");
    attach(&mut world);
    world.answer(RECORDER, "passed");
    world.tear_down(0);
    world.tear_down(1);
    world.finish();
    assert_eq!(world.record.tests[0].attempts[0].attachments.len(), 1);
}

/// The next test waits for the hook and for the recorder.
#[test]
fn hooks_run_while_a_recorder_is_notified_of_the_verdict() {
    let mut plan = suite(1, 2);
    plan.hooks = vec![hook(0, &[Trigger::Failure])];
    let parking = Source::Hook(HookId(0));
    for recorder_is_first in [false, true] {
        let mut world = notified(&plan);
        world.phase(TEST, rtf_model::Phase::Run);
        world.failure(TEST, "the arm is stuck", false);
        world.end(TEST, "failed");
        world.next_deadline();
        assert_eq!(last_notification(&world), "test0 failed: the arm is stuck");
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

/// Even a hanging recorder does not delay them.
#[test]
fn hooks_of_a_stopped_run_do_not_wait_for_a_recorder() {
    let mut plan = suite(1, 1);
    plan.hooks = vec![hook(0, &[Trigger::Interrupt]), hook(1, &[Trigger::End])];
    let mut world = notified(&plan);
    world.stop(StopLevel::TearDown);
    world.end(TEST, "interrupted");
    for hook in 0..2 {
        world.exit(Source::Hook(HookId(hook)), rtf_model::ExitStatus::Code(0));
    }
    assert_eq!(world.now, std::time::Duration::ZERO);
    assert!(world.record.tests[0].is_running(), "the recorder has not answered");
    assert_eq!(world.next_deadline(), Deadline::Fixture(0, FixtureTimer::Notification));
    world.tear_down(0);
    world.finish();
    assert_eq!(world.record.tests[0].verdict(), Some(Verdict::Interrupted));
    assert!(world.record.hooks.iter().all(|hook| hook.runs.len() == 1));
}

#[test]
fn a_killed_run_waits_for_no_fixture() {
    let plan = suite(1, 2);
    let mut world = notified(&plan);
    world.pass(0);
    world.stop(StopLevel::TearDown);
    world.stop(StopLevel::Kill);
    assert_eq!(world.record.tests[0].verdict(), Some(Verdict::Passed));
    world.exit(RECORDER, rtf_model::ExitStatus::Signal(9));
    world.finish();
}

#[test]
fn an_attachment_without_a_test_is_an_error_of_the_fixture() {
    let plan = suite(1, 1);
    let mut world = notified(&plan);
    attach(&mut world);
    world.pass(0);
    world.answer(RECORDER, "passed");
    world.tear_down(0);
    world.finish();
    let text = &world.record.fixtures[0].messages[0].text;
    assert_eq!(text, "the file `run.mcap` is not kept: there is no test that it belongs to");
}

#[test]
fn notifications_of_parallel_tests_are_sent_one_by_one() {
    let mut plan = suite(1, 2);
    plan.settings.parallel = 2;
    let mut world = World::started(&plan);
    world.set_up_subscribed(0);
    world.answer(RECORDER, "passed");
    let starts: Vec<u64> = requests(&world, |r| matches!(r, Request::TestStarted(_)));
    assert_eq!(starts.len(), 2);
    answer(&mut world, starts[0]);
    assert!(world.transcript().contains("test-started attempt=1 repetition=1 test=0"));
    assert!(!world.transcript().contains("repetition=1 test=1"), "{}", world.transcript());
    answer(&mut world, starts[1]);
    world.pass(1);
    world.pass(0);
    let ends = |world: &World<'_>| requests(world, |r| matches!(r, Request::TestFinished(_)));
    // The host still handles the end of the second test; the examination after the first
    // one follows later.
    attach(&mut world);
    let first = ends(&world)[0];
    answer(&mut world, first);
    assert_eq!(world.record.tests[1].verdict(), Some(Verdict::Passed));
    assert_eq!(ends(&world).len(), 1);
    world.pass_examination(0);
    assert_eq!(world.record.tests[0].verdict(), None);
    attach(&mut world);
    attach(&mut world);
    let second = ends(&world)[1];
    answer(&mut world, second);
    world.tear_down(0);
    world.finish();
    let attachments = |test: usize| world.record.tests[test].attempts[0].attachments.len();
    assert_eq!((attachments(0), attachments(1)), (2, 1));
}

fn requests(world: &World<'_>, kind: impl Fn(&Request) -> bool) -> Vec<u64> {
    world.sent.iter().filter(|(_, _, request)| kind(request)).filter_map(|sent| sent.1).collect()
}

fn answer(world: &mut World<'_>, request: u64) {
    let passed = serde_json::json!({ "outcome": "passed" });
    world.input(RECORDER, ProcessEvent::Replied(request, Reply::Result(passed)));
}

#[test]
fn tests_start_in_order_even_if_a_fixture_replies_in_another_one() {
    let mut plan = suite(1, 2);
    plan.settings.parallel = 2;
    let mut world = World::started(&plan);
    world.set_up_subscribed(0);
    world.answer(RECORDER, "passed");
    let host = world.host_of(RECORDER);
    let is_notice = |request: &Request| matches!(request, Request::TestStarted(_));
    let sent = world.sent.iter().filter(|(_, _, request)| is_notice(request));
    let notices: Vec<u64> = sent.filter_map(|(_, id, _)| *id).collect();
    let reply = |world: &mut World<'_>, id| {
        let reply = Reply::Result(serde_json::json!({ "outcome": "passed" }));
        world.feed(Input::Host(host, ProcessEvent::Replied(id, reply)));
    };
    reply(&mut world, notices[1]);
    assert!(!world.transcript().contains("test-started"), "{}", world.transcript());
    reply(&mut world, notices[0]);
    let started = |kind: &EventKind| match kind {
        EventKind::TestStarted { test, .. } => Some(test.0),
        _ => None,
    };
    assert_eq!(world.events.iter().filter_map(started).collect::<Vec<_>>(), [0, 1]);
}
