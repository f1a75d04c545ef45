//! Problems of running tests that a fixture finds, and samples that it takes.

use insta::assert_snapshot;
use rtf_model::protocol::{MonitorDeclaration, Notification, Reply, Request, TestReport};
use rtf_model::{
    ExitStatus, Finding, FindingSeverity, FixtureId, HookId, Measurement, Micros, Phase, Source,
    TestId, Trigger, Verdict,
};

use super::world::{SECOND, TEST, World, hook, suite};
use crate::run::machine::{Deadline, FixtureTimer, ProcessEvent, StopLevel, TestTimer};
use rtf_plan::plan::SuitePlan;

const WATCHER: Source = Source::Fixture(FixtureId(0));

/// A suite whose fixture watches its first test, which runs.
pub(super) fn watched(plan: &SuitePlan) -> World<'_> {
    let mut world = notified(plan);
    answer_notifications(&mut world);
    world.phase(TEST, Phase::Setup);
    world.phase(TEST, Phase::Run);
    world.restart_transcript();
    world
}

/// A suite whose fixture is being notified that its first test is about to start.
pub(super) fn notified(plan: &SuitePlan) -> World<'_> {
    let mut world = World::started(plan);
    let topics = ["test-started", "test-ended", "test-reported"];
    let value = serde_json::json!({ "outcome": "passed", "subscriptions": topics });
    world.input(WATCHER, ProcessEvent::Replied(2, Reply::Result(value)));
    world.answer(WATCHER, "passed");
    world
}

/// Answers that it was notified.
pub(super) fn answer_notifications(world: &mut World<'_>) {
    let is_start = |request: &Request| matches!(request, Request::TestStarted(_));
    let starts = world.sent.iter().filter(|(_, _, request)| is_start(request));
    let starts: Vec<u64> = starts.filter_map(|(_, id, _)| *id).collect();
    for start in starts {
        let passed = serde_json::json!({ "outcome": "passed" });
        world.input(WATCHER, ProcessEvent::Replied(start, Reply::Result(passed)));
    }
}

fn find(world: &mut World<'_>, test: u32, severity: FindingSeverity) {
    let text = "`q` is 1.3 rad at 0.42 s".to_owned();
    let finding = Finding { test: TestId(test), severity, text, location: None, interval: None };
    world.input(WATCHER, ProcessEvent::Notified(Notification::Finding(finding)));
}

fn observe(world: &mut World<'_>, test: u32) {
    let samples = r#"{"name":"q","unit":"rad","points":[[0.4,1.1],[0.41,1.2]],"case":7}"#;
    let samples = serde_json::from_str(samples).unwrap();
    let observed = Notification::Observed { test: TestId(test), samples };
    world.input(WATCHER, ProcessEvent::Notified(observed));
}

fn measure(world: &mut World<'_>) {
    let measurement = r#"{"name":"monitor/no overshoot","value":-0.3,"unit":"rad"}"#;
    let measurement: Measurement = serde_json::from_str(measurement).unwrap();
    world.input(WATCHER, ProcessEvent::Notified(Notification::Measured(measurement)));
}

fn last_ended(world: &World<'_>) -> Option<(TestId, bool)> {
    world.sent.iter().rev().find_map(|(_, _, request)| match request {
        Request::TestEnded(ended) => Some((ended.test.id, ended.stopped)),
        _ => None,
    })
}

/// The watcher has nothing more to report about a test that failed, which waits for a collapse.
fn answer_ended(world: &mut World<'_>) {
    world.answer(WATCHER, "passed");
    let test = Deadline::Test(TestId(0), TestTimer::Limit);
    if world.record.tests[0].is_running() {
        assert_eq!(world.next_deadline(), test);
    }
}

fn tear_down(world: &mut World<'_>) {
    world.tear_down(0);
    world.finish();
}

#[test]
fn a_test_with_a_failure_continues_and_fails() {
    let plan = suite(1, 1);
    let mut world = watched(&plan);
    observe(&mut world, 0);
    find(&mut world, 0, FindingSeverity::Fail);
    world.phase(TEST, Phase::TearDown);
    world.end(TEST, "passed");
    assert_eq!(last_ended(&world), Some((TestId(0), false)));
    measure(&mut world);
    answer_ended(&mut world);
    tear_down(&mut world);
    assert_snapshot!(world.transcript(), @"
    0.0  sampled samples={name:q,points:[[0.4,1.1],[0.41,1.2]],since:0,unit:rad} test=0
    0.0  message source={test:0}
    0.0  test-phase phase=tear-down test=0
    0.0    → close the channel
    0.0  measured fixture=0 measurement={name:monitor/no overshoot,unit:rad,value:-0.3} test=0
    0.2  test-finished exit={code:0} phase=run reason=`q` is 1.3 rad at 0.42 s test=0 verdict=failed
    0.2  fixture-stopping fixture=0
    0.2    → close the channel
    0.2  fixture-stopped fixture=0
    0.2  suite-finished
    ");
    let attempt = &world.record.tests[0].attempts[0];
    assert_eq!(attempt.series[0].count, 2);
    assert_eq!(attempt.measurements[0].name, "monitor/no overshoot");
    assert_eq!(attempt.messages[0].text, "`q` is 1.3 rad at 0.42 s");
}

/// Not from the start of the test, which waits for all fixtures, or from its set-up.
#[test]
fn times_of_a_watcher_count_from_the_announcement() {
    let plan = suite(1, 1);
    let mut world = World::started(&plan);
    let value = serde_json::json!({ "outcome": "passed", "subscriptions": ["test-started"] });
    world.input(WATCHER, ProcessEvent::Replied(2, Reply::Result(value)));
    world.now = SECOND;
    world.answer(WATCHER, "passed");
    world.now = 2 * SECOND;
    answer_notifications(&mut world);
    world.now = 3 * SECOND;
    world.phase(TEST, Phase::Setup);
    observe(&mut world, 0);
    let finding = r#"{"test":0,"severity":"fail","text":"high","interval":{"start":1.9,"end":2,"signals":["q"]}}"#;
    let finding = Notification::Finding(serde_json::from_str(finding).unwrap());
    world.input(WATCHER, ProcessEvent::Notified(finding));
    let times: Vec<_> = world.events.iter_mut().filter_map(|event| event.since_mut()).collect();
    assert_eq!(times, [&Micros::from(SECOND), &Micros::from(SECOND)]);
}

/// The verdict is that of the severity in every phase.
#[test]
fn the_first_finding_decides() {
    use FindingSeverity::{Error, Fail};
    for (first, second, verdict) in [(Fail, Error, Verdict::Failed), (Error, Fail, Verdict::Error)]
    {
        let plan = suite(1, 1);
        let mut world = watched(&plan);
        world.phase(TEST, Phase::TearDown);
        find(&mut world, 0, first);
        find(&mut world, 0, second);
        world.end(TEST, "passed");
        answer_ended(&mut world);
        tear_down(&mut world);
        assert_eq!(world.record.tests[0].verdict(), Some(verdict));
    }
}

/// What only the end of the test shows, such as an event that never came.
#[test]
fn the_verdict_waits_for_findings_at_the_end() {
    let plan = suite(1, 1);
    let mut world = watched(&plan);
    world.phase(TEST, Phase::TearDown);
    world.end(TEST, "passed");
    assert!(world.record.tests[0].is_running());
    find(&mut world, 0, FindingSeverity::Stop);
    assert!(!world.transcript().contains("test-stopping"), "{}", world.transcript());
    world.answer(WATCHER, "passed");
    assert_eq!(world.record.tests[0].verdict(), Some(Verdict::Failed));
    tear_down(&mut world);
}

#[test]
fn a_stop_ends_the_test_at_once_and_triggers_hooks() {
    let mut plan = suite(1, 2);
    plan.hooks = vec![hook(0, &[Trigger::Failure])];
    let mut world = watched(&plan);
    find(&mut world, 0, FindingSeverity::Stop);
    let is_asked = |sent: &(_, _, Request)| matches!(sent.2, Request::Interrupt { .. });
    assert!(world.sent.last().is_some_and(is_asked));
    world.end(TEST, "interrupted");
    assert_eq!(last_ended(&world), Some((TestId(0), true)));
    // The hook parks the robot before the watcher has answered.
    world.exit(Source::Hook(HookId(0)), ExitStatus::Code(0));
    measure(&mut world);
    world.answer(WATCHER, "passed");
    assert_eq!(world.record.tests[0].verdict(), Some(Verdict::Failed));
    world.answer(WATCHER, "passed");
    world.answer(WATCHER, "passed");
    world.pass(1);
    world.answer(WATCHER, "passed");
    tear_down(&mut world);
    assert_snapshot!(world.transcript(), @"
    0.0  message source={test:0}
    0.0  test-stopping cause=finding reason=`q` is 1.3 rad at 0.42 s test=0
    0.0    → close the channel
    0.0  test-phase phase=notify test=0
    0.0  hook-started hook=0 reason=`test0` is failed: `q` is 1.3 rad at 0.42 s test=0 trigger=failure
    0.0  hook-finished hook=0
    0.0  measured fixture=0 measurement={name:monitor/no overshoot,unit:rad,value:-0.3} test=0
    0.0  test-finished exit={code:0} phase=run reason=`q` is 1.3 rad at 0.42 s test=0 verdict=failed
    0.0  test-started attempt=1 repetition=1 test=1
    0.0  test-phase phase=setup test=1
    0.0  test-phase phase=run test=1
    0.0  test-phase phase=tear-down test=1
    0.0    → close the channel
    0.0  test-finished exit={code:0} phase=exit test=1 verdict=passed
    0.0  fixture-stopping fixture=0
    0.0    → close the channel
    0.0  fixture-stopped fixture=0
    0.0  suite-finished
    ");
}

#[test]
fn a_test_that_does_not_stop_is_killed_after_its_grace() {
    let plan = suite(1, 1);
    let mut world = watched(&plan);
    find(&mut world, 0, FindingSeverity::Stop);
    assert_eq!(world.next_deadline(), Deadline::Test(TestId(0), TestTimer::Limit));
    assert_eq!(world.now, SECOND);
    world.exit(TEST, ExitStatus::Signal(15));
    world.answer(WATCHER, "passed");
    tear_down(&mut world);
    let reason = world.record.tests[0].reason();
    assert_eq!(reason, Some("`q` is 1.3 rad at 0.42 s"));
    assert_eq!(world.record.tests[0].verdict(), Some(Verdict::Failed));
}

#[test]
fn a_critical_finding_skips_the_rest_of_the_suite() {
    let mut plan = suite(1, 2);
    plan.tests[0].settings.retries.count = 2;
    let mut world = watched(&plan);
    find(&mut world, 0, FindingSeverity::Critical);
    world.end(TEST, "interrupted");
    world.answer(WATCHER, "passed");
    tear_down(&mut world);
    let tests = &world.record.tests;
    assert_eq!((tests[0].attempts.len(), tests[1].attempts.len()), (1, 0));
    assert_eq!(tests[0].verdict(), Some(Verdict::Failed));
    assert!(tests[1].skipped.as_deref().unwrap().contains("1.3 rad"));
}

#[test]
fn each_parallel_test_has_its_findings() {
    let mut plan = suite(1, 2);
    plan.settings.parallel = 2;
    let mut world = watched(&plan);
    find(&mut world, 1, FindingSeverity::Stop);
    let other = Source::Test(TestId(1));
    world.end(other, "interrupted");
    assert_eq!(last_ended(&world), Some((TestId(1), true)));
    world.answer(WATCHER, "passed");
    world.phase(TEST, Phase::TearDown);
    world.end(TEST, "passed");
    world.answer(WATCHER, "passed");
    assert_eq!(world.record.tests[0].verdict(), Some(Verdict::Passed));
    assert_eq!(world.record.tests[1].verdict(), Some(Verdict::Failed));
    tear_down(&mut world);
}

#[test]
fn a_report_about_a_test_that_does_not_run_is_an_error_of_the_fixture() {
    let plan = suite(1, 2);
    let mut world = watched(&plan);
    find(&mut world, 1, FindingSeverity::Stop);
    observe(&mut world, 9);
    world.stop(StopLevel::TearDown);
    world.end(TEST, "interrupted");
    world.answer(WATCHER, "passed");
    tear_down(&mut world);
    let texts: Vec<_> =
        world.record.fixtures[0].messages.iter().map(|message| &*message.text).collect();
    assert_snapshot!(texts.join("\n"), @"
    it reported about `test1`, which does not run: a finding: `q` is 1.3 rad at 0.42 s
    it reported about a test 9, which does not run: samples of `q`
    ");
    assert_eq!(world.record.tests[0].verdict(), Some(Verdict::Interrupted));
}

#[test]
fn a_watcher_that_hangs_at_the_end_of_a_test_collapses() {
    let plan = suite(1, 1);
    let mut world = watched(&plan);
    world.phase(TEST, Phase::TearDown);
    world.end(TEST, "passed");
    assert_eq!(world.next_deadline(), Deadline::Fixture(0, FixtureTimer::Notification));
    assert_eq!(world.record.fixtures[0].collapses[0].1, "testEnded did not end within 2s");
    assert_eq!(world.record.tests[0].verdict(), Some(Verdict::Collapsed));
    tear_down(&mut world);
}

#[test]
fn a_test_cannot_report_as_a_fixture() {
    let plan = suite(1, 1);
    let mut world = watched(&plan);
    let samples = serde_json::from_str(r#"{"name":"q","points":[]}"#).unwrap();
    let observed = Notification::Observed { test: TestId(0), samples };
    world.input(TEST, ProcessEvent::Notified(observed));
    world.end(TEST, "interrupted");
    world.answer(WATCHER, "passed");
    tear_down(&mut world);
    let reason = world.record.tests[0].reason();
    assert_eq!(reason, Some("the host broke the protocol: sent `observed`, which is for fixtures"));
}

fn monitor() -> MonitorDeclaration {
    let (name, formula) = ("low".to_owned(), "always(q < 1)".to_owned());
    MonitorDeclaration { name, formula, severity: FindingSeverity::Fail, location: None }
}

#[test]
fn subscribers_get_what_a_test_reports_in_its_order() {
    let plan = suite(1, 1);
    let mut world = watched(&plan);
    let samples: rtf_model::Samples =
        serde_json::from_str(r#"{"name":"q","points":[[0.1,1.0]]}"#).unwrap();
    let measurement: Measurement = serde_json::from_str(r#"{"name":"lag","value":1}"#).unwrap();
    for notification in [
        Notification::Monitor(monitor()),
        Notification::Sampled(samples.clone()),
        Notification::Measured(measurement.clone()),
    ] {
        world.input(TEST, ProcessEvent::Notified(notification));
    }
    // What a fixture reports is not passed on.
    observe(&mut world, 0);
    let reports: Vec<_> = world
        .sent
        .iter()
        .filter_map(|(_, id, request)| match request {
            Request::TestReported(reported) => Some((*id, reported.test, &reported.report)),
            _ => None,
        })
        .collect();
    let reported = [
        TestReport::SetupStarted {},
        TestReport::Monitor(monitor()),
        TestReport::Sampled(samples),
        TestReport::Measured(measurement),
    ];
    let expected: Vec<_> = reported.iter().map(|report| (None, TestId(0), report)).collect();
    assert_eq!(reports, expected);
    world.phase(TEST, Phase::TearDown);
    world.end(TEST, "passed");
    answer_ended(&mut world);
    tear_down(&mut world);
    assert_eq!(world.record.tests[0].verdict(), Some(Verdict::Passed));
}

#[test]
fn a_monitor_without_signals_is_an_error_of_the_test() {
    let plan = suite(0, 1);
    let mut world = World::started(&plan);
    world.phase(TEST, Phase::Setup);
    world.phase(TEST, Phase::Run);
    world.input(TEST, ProcessEvent::Notified(Notification::Monitor(monitor())));
    world.phase(TEST, Phase::TearDown);
    world.end(TEST, "passed");
    world.finish();
    let reason = "the monitor `low` is not evaluated: there are no signals: declare one with \
                  `<signal>` in the suite";
    assert_eq!(world.record.tests[0].reason(), Some(reason));
    assert_eq!(world.record.tests[0].verdict(), Some(Verdict::Error));
}
