//! Patterns in lines that have no end yet, such as prompts.

use std::sync::Arc;

use regex::Regex;
use rtf_model::{ExitStatus, Stream, TestId, Verdict};

use super::world::{FIXTURE, SECOND, TEST, World, suite};
use crate::run::machine::{Deadline, FixtureTimer, ProcessEvent};
use rtf_plan::plan::{FixtureBody, Probe, ProbeKind, ProbePlans, ProcessPlan, SuitePlan};

const TRIED: Deadline = Deadline::Fixture(0, FixtureTimer::UnfinishedLine);

fn plan(ready: &str, bad: &str) -> SuitePlan {
    let log = |pattern: &str| Probe {
        kind: ProbeKind::Log(Regex::new(pattern).expect("a pattern")),
        every: SECOND,
        timeout: SECOND,
    };
    let probes = ProbePlans { ready: vec![log(ready)], alive: vec![log(bad)], values: Vec::new() };
    let mut plan = suite(1, 1);
    plan.fixtures[0].body = FixtureBody::Process(Arc::new(ProcessPlan {
        command: vec!["sim".to_owned()],
        probes,
        stop_signal: 15,
        stop_grace: SECOND,
        stop_codes: Vec::new(),
        remote: None,
    }));
    plan.fixtures[0].restarts = 0;
    plan
}

fn print(world: &mut World<'_>, text: &str) {
    world.input(FIXTURE, ProcessEvent::Printed(Stream::Stdout, text.as_bytes().to_vec()));
}

fn starts(world: &World<'_>) -> usize {
    world.transcript().matches("test-started").count()
}

#[test]
fn a_prompt_makes_a_fixture_ready_once_nothing_follows() {
    let plan = plan("^pxh> $", "never");
    let mut world = World::started(&plan);
    world.input(FIXTURE, ProcessEvent::ProbesPassed);
    print(&mut world, "boot\npx");
    print(&mut world, "h> ");
    assert_eq!((world.next_deadline(), starts(&world)), (TRIED, 0));
    assert_eq!((world.next_deadline(), starts(&world)), (TRIED, 1));
    // The rest of the line is not searched for what is awaited, and no timer is left.
    print(&mut world, "\n");
    world.answer(TEST, "passed");
    world.exit(TEST, ExitStatus::Code(0));
    world.input(FIXTURE, ProcessEvent::Alive);
    world.exit(FIXTURE, ExitStatus::Code(0));
    world.finish();
}

#[test]
fn a_bad_line_without_an_end_is_one_collapse() {
    let plan = plan("up", "FATAL");
    let mut world = World::started(&plan);
    world.input(FIXTURE, ProcessEvent::ProbesPassed);
    print(&mut world, "up\nFATAL");
    assert_eq!(world.next_deadline(), TRIED);
    print(&mut world, ": motor");
    assert_eq!(world.next_deadline(), TRIED);
    print(&mut world, " 3\nFATAL\n");
    world.exit(TEST, ExitStatus::Code(0));
    world.exit(FIXTURE, ExitStatus::Signal(15));
    world.finish();
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Collapsed));
    let collapses = &world.record.fixtures[0].collapses;
    assert_eq!(collapses.len(), 1);
    assert_eq!(collapses[0].1, "it printed `FATAL: motor`");
}
