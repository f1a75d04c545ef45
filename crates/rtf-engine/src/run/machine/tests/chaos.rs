//! Random hosts: the events are always in order, each test has exactly one final result,
//! and no test that overlaps a collapse is green.

use std::time::Duration;

use proptest::prelude::*;
use rtf_model::protocol::{Notification, Reply};
use rtf_model::{
    AnswerChannel, CaseId, CaseStart, Episode, EventKind, ExitStatus, FaultInjected, FaultKind,
    Finding, FindingSeverity, Message, MessageKind, Phase, Question, Respondent, Source, TestId,
    Trigger, Verdict,
};

use super::world::{SECOND, World, hook, suite};
use crate::run::machine::{HostId, Input, ProcessEvent, QuestionReply, StopLevel};
use rtf_plan::plan::{AfterCollapse, HookBody, ResetPlan, Retries, SuitePlan};
use rtf_process::codec::INITIALIZE;

/// Lets an idle shared host begin a test or exit; false if another host acts.
fn act_idle(world: &mut World<'_>, choice: u8) -> bool {
    let is_chosen = !choice.is_multiple_of(3);
    let Some(idle) = world.idle.first().copied().filter(|_| is_chosen) else { return false };
    if choice % 3 == 1 || !world.begin_assigned(idle) {
        world.exit_idle(idle, ExitStatus::Signal(11));
    }
    true
}

fn phase(step: u8) -> Phase {
    match step {
        5 => Phase::Setup,
        8 => Phase::TearDown,
        _ => Phase::Run,
    }
}

/// A failure, a value, or a plan, the start or the end of a case.
fn report(choice: u8) -> Notification {
    let number = u32::from(choice);
    match choice / 16 % 4 {
        1 => {
            let case = CaseId(1 + number / 64);
            let parent = (choice > 128).then_some(CaseId(1));
            let name = if parent.is_some() { "pose".to_owned() } else { format!("pose {case}") };
            Notification::CaseStarted(CaseStart { parent, ..CaseStart::new(case, name) })
        }
        2 if choice > 200 => {
            let names = (1..=3).map(|case| format!("pose {case}")).collect();
            Notification::CasesPlanned { names }
        }
        2 if choice & 1 == 0 => about_test(number),
        2 => {
            let name = if choice > 128 { "port" } else { "pid" }.to_owned();
            Notification::Provided { name, value: number.into() }
        }
        3 => {
            let case = CaseId(1 + number / 128);
            let (outcome, reason, duration_us, rerun) = (None, None, None, choice & 1 == 1);
            Notification::CaseFinished { case, outcome, reason, duration_us, rerun }
        }
        _ => {
            let (kind, text, critical) = (MessageKind::Failure, "no".to_owned(), choice > 240);
            let (location, comparison) = (None, None);
            Notification::Message(Message {
                kind,
                text,
                location,
                comparison,
                critical,
                case: None,
                interval: None,
            })
        }
    }
}

/// A finding about a test, a fault, or samples that a fixture took.
fn about_test(number: u32) -> Notification {
    let test = TestId(number / 4 % 4);
    if number & 32 != 0 {
        let (name, effect) = ("drop".to_owned(), "stopped it".to_owned());
        let (_, kind) = FaultKind::ALL[number as usize / 16 % FaultKind::ALL.len()];
        return match number & 1 {
            0 => Notification::FaultInjected(FaultInjected { test, name, kind, effect }),
            _ => Notification::FaultRemoved { test, name },
        };
    }
    if number & 2 == 0 {
        let samples = serde_json::json!({ "name": "q", "points": [[0.5, 1.5]], "case": 1 });
        return Notification::Observed { test, samples: serde_json::from_value(samples).unwrap() };
    }
    let (_, severity) = FindingSeverity::ALL[number as usize / 64];
    let (text, location) = ("`q` is 2".to_owned(), None);
    Notification::Finding(Finding { test, severity, text, location, interval: None })
}

/// A question, with a default answer or without.
fn question(which: usize) -> Notification {
    let question = u32::try_from(which).unwrap_or_default();
    let (text, timeout_ms) = ("Is it closed?".to_owned(), 2000);
    let choices = vec!["yes".to_owned(), "no".to_owned()];
    let default = which.is_multiple_of(2).then(|| "no".to_owned());
    let asked = Question { question, text, timeout_ms, choices, default, ..Question::default() };
    Notification::QuestionAsked(asked)
}

/// An operator answers a question, or declines.
fn reply(which: usize, choice: u8) -> Input {
    let number = u32::try_from(which).unwrap_or_default();
    let answer = (choice > 62).then(|| "yes".to_owned());
    let by = Respondent { via: AnswerChannel::Api, who: None };
    Input::Answer(TestId(number), QuestionReply { question: number + 1, answer, by })
}

fn stop_test(which: usize) -> Input {
    Input::StopTest(TestId(u32::try_from(which).unwrap_or_default()), "a user".to_owned())
}

/// A question, an answer, or what a fixture reports about a test.
fn question_or_finding(host: HostId, which: usize, choice: u8) -> Input {
    let notification = match choice {
        0..48 => question(which),
        48..80 => return reply(which, choice),
        _ => {
            let number = u32::try_from(which).unwrap_or_default() * 67 + u32::from(choice);
            about_test(number % 256)
        }
    };
    Input::Host(host, ProcessEvent::Notified(notification))
}

pub(super) fn act(world: &mut World<'_>, choice: u8, which: usize, shared: bool) {
    let alive: Vec<_> = world.hosts.iter().map(|(host, source)| (*host, *source)).collect();
    if act_idle(world, choice) {
        return;
    }
    let Some((host, source)) = alive.get(which % alive.len().max(1)).copied() else {
        if !world.deadlines.is_empty() {
            world.next_deadline();
        }
        return;
    };
    let asked = |(to, id, _): &&(_, Option<u64>, _)| *to == host && id.is_some();
    let answerable = |world: &World<'_>| world.sent.iter().rev().find(asked)?.1;
    if world.answered.contains(&host) && choice.is_multiple_of(2) {
        return world.release(host);
    }
    let notify = |notification| Input::Host(host, ProcessEvent::Notified(notification));
    match choice % 16 {
        0..=4 => {
            if let Some(id) = answerable(world) {
                let outcome = if choice > 200 { "failed" } else { "passed" };
                let topics = ["test-started", "test-ended", "test-finished"];
                let continues = shared && outcome == "passed" && matches!(source, Source::Test(_));
                let value = serde_json::json!({
                    "outcome": outcome, "subscriptions": topics, "continues": continues
                });
                if continues {
                    world.answered.insert(host);
                }
                world.feed(Input::Host(host, ProcessEvent::Replied(id, Reply::Result(value))));
            }
        }
        5 if shared && choice > 100 => {
            let value = serde_json::json!({ "protocol": 1, "host": "h", "supports_shared": true });
            let answer = ProcessEvent::Replied(INITIALIZE, Reply::Result(value));
            world.feed(Input::Host(host, answer));
        }
        5 if choice > 200 => {
            let value = serde_json::json!({ "protocol": 1, "host": "h", "selects_cases": true });
            let answer = ProcessEvent::Replied(INITIALIZE, Reply::Result(value));
            world.feed(Input::Host(host, answer));
        }
        step @ 5..=8 => world.feed(notify(Notification::Phase { phase: phase(step) })),
        9 if choice > 128 => world.feed(Input::Host(host, ProcessEvent::Dying)),
        9 => world.feed(notify(Notification::Collapsed { reason: "gone".to_owned() })),
        10 => world.exit(source, ExitStatus::Signal(9)),
        12 if choice > 160 => {
            let ended = ProcessEvent::LeaderEnded(ExitStatus::Code(0), Vec::new());
            world.feed(Input::Host(host, ended));
        }
        11 | 12 => world.exit(source, ExitStatus::Code(0)),
        13 => world.feed(notify(report(choice))),
        14 if choice < 112 => world.feed(question_or_finding(host, which, choice)),
        14 => drop((!world.deadlines.is_empty()).then(|| world.next_deadline())),
        _ if stop_run(world, choice) => {}
        _ if choice == 223 => world.feed(Input::Skip("a user".to_owned())),
        _ if choice % 32 == 15 => world.feed(stop_test(which)),
        _ => {
            world.feed(Input::Host(host, ProcessEvent::ProtocolViolated("it wrote `x`".to_owned())))
        }
    }
}

/// Requests the end of the run for some choices.
fn stop_run(world: &mut World<'_>, choice: u8) -> bool {
    let level = match choice {
        255 => StopLevel::Kill,
        239 => StopLevel::TearDown,
        207 => StopLevel::KillHooks,
        _ => return false,
    };
    world.stop(level);
    true
}

fn end_all(world: &mut World<'_>) {
    for _ in 0..2000 {
        if world.done {
            return;
        }
        match (world.hosts.values().next().copied(), world.idle.first().copied()) {
            (Some(source), _) => world.exit(source, ExitStatus::Code(0)),
            (None, Some(idle)) => world.exit_idle(idle, ExitStatus::Code(0)),
            (None, None) => drop(world.next_deadline()),
        }
    }
}

fn episode(id: u64) -> Episode {
    Episode { id, seed: 1, parameters: Vec::new(), masked: Vec::new() }
}

fn reset() -> ResetPlan {
    let body = HookBody::Command(vec!["reset".to_owned()]);
    ResetPlan { body, timeout: SECOND, restart_every: Some(2) }
}

proptest! {
    // For more cases: PROPTEST_CASES=20000.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn every_test_has_exactly_one_final_result(
        steps in prop::collection::vec((any::<u8>(), 0..4usize), 0..200),
        fixtures in 0..3usize,
        tests in 1..5usize,
        restarts in 0..4u32,
        independent in any::<bool>(),
        parallel in 1..4u32,
        alone in 0..8usize,
        shared in any::<bool>(),
        episodes in 0..4u64,
        awaits in any::<bool>(),
    ) {
        let mut plan = suite(fixtures, tests);
        plan.settings.parallel = if shared { 1 } else { parallel };
        plan.tests.iter_mut().for_each(|test| test.settings.shared = shared);
        if let Some(test) = plan.tests.get_mut(alone) {
            test.settings.exclusive = true;
        }
        if let Some(test) = plan.tests.get_mut(alone / 2) {
            test.settings.critical = alone % 2 == 1;
        }
        for fixture in &mut plan.fixtures {
            fixture.restarts = restarts;
            fixture.restart_delay = SECOND;
            if independent {
                fixture.depends.clear();
            }
        }
        plan.tests[0].settings.after_collapse = AfterCollapse::Rerun;
        plan.tests[0].cases_in_programs = independent.then(Box::default);
        plan.tests[tests - 1].settings.repetitions = 2;
        let delay = if independent { SECOND } else { Duration::ZERO };
        plan.tests[tests / 2].settings.retries = Retries { count: restarts, delay };
        plan.hooks = vec![hook(0, &Trigger::ALL), hook(1, &[Trigger::End])];
        plan.episodes = (1..=episodes).map(episode).collect();
        plan.awaits_episodes = awaits && episodes > 0;
        if let Some(fixture) = plan.fixtures.first_mut().filter(|_| independent) {
            fixture.reset = Some(reset());
        }
        let mut world = if episodes == 0 { World::new(&plan) } else { World::timed(&plan) };
        world.start();
        for (choice, which) in steps {
            if world.done {
                break;
            }
            if choice % 32 == 31 && plan.awaits_episodes {
                let next = episode(world.events.len() as u64 + 10);
                world.feed(Input::Episode(Some(next)));
            }
            act(&mut world, choice, which, shared);
        }
        if !world.done {
            world.feed(Input::Episode(None));
        }
        end_all(&mut world);
        world.finish();
        let totals = world.record.totals();
        prop_assert_eq!(totals.done() as usize, tests);
        check_overlaps(&world);
        if episodes == 0 {
            check_exclusive(&world, &plan);
        }
        prop_assert!(world.record.hooks.iter().all(|h| h.runs.iter().all(|r| r.finished.is_some())));
    }
}

/// Nothing runs in parallel with an exclusive test, no test starts before a critical one
/// above it has finished, no test overlaps itself, and tests start in the suite's order.
fn check_exclusive(world: &World<'_>, plan: &SuitePlan) {
    let mut begun: Vec<TestId> = Vec::new();
    let mut running: Vec<TestId> = Vec::new();
    for kind in &world.events {
        match kind {
            EventKind::TestStarted { test, .. } => {
                let of = |id: &TestId| &plan.tests[id.index()];
                assert!(!running.contains(test), "{:#?}", world.log);
                for other in &running {
                    assert!(
                        !of(test).settings.exclusive && !of(other).settings.exclusive,
                        "{:#?}",
                        world.log
                    );
                    assert!(!of(other).settings.critical || other > test, "{:#?}", world.log);
                }
                if !begun.contains(test) {
                    assert!(begun.last().is_none_or(|last| last < test), "{:#?}", world.log);
                    begun.push(*test);
                }
                running.push(*test);
            }
            EventKind::TestFinished(finished) => running.retain(|test| *test != finished.test),
            _ => {}
        }
    }
}

/// No attempt during which a fixture collapsed is green.
fn check_overlaps(world: &World<'_>) {
    let collapses: Vec<_> =
        world.record.fixtures.iter().flat_map(|f| f.collapses.iter().map(|(at, _)| *at)).collect();
    for test in &world.record.tests {
        for attempt in &test.attempts {
            let Some((end, finished)) = &attempt.finished else {
                continue;
            };
            // The verdict is final before fixtures are notified.
            let noticed = attempt.phases.iter().find(|(phase, _)| *phase == Phase::Notify);
            let judged = noticed.map_or(end, |(_, at)| at);
            let overlaps = collapses.iter().any(|at| *at > attempt.started && at < judged);
            assert!(!(overlaps && finished.verdict == Verdict::Passed), "{:#?}", world.log);
        }
    }
}
