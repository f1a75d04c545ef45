//! Tests whose host runs cases in programs: their requests and stack dumps.

use std::time::Duration;

use rtf_model::protocol::{Notification, Plugin, Request};
use rtf_plan::plan::{CasesInPrograms, SuitePlan};

use super::world::{SECOND, TEST, World, suite};
use crate::run::machine::ProcessEvent;

fn in_programs(programs: CasesInPrograms) -> SuitePlan {
    let mut plan = suite(0, 1);
    plan.tests[0].cases_in_programs = Some(Box::new(programs));
    plan
}

fn request(plan: &SuitePlan) -> Plugin {
    let world = World::started(plan);
    let sent = world.sent.iter().find_map(|(_, _, request)| match request {
        Request::RunTest(plugin) => Some(plugin.clone()),
        _ => None,
    });
    sent.expect("a request")
}

#[test]
fn the_host_gets_the_limit_and_the_isolation_of_cases() {
    let limits = [(1500, 1500), (0, 1)];
    for (limit, sent) in limits.map(|(limit, sent)| (Duration::from_millis(limit), sent)) {
        let plan = in_programs(CasesInPrograms {
            case_timeout: Some(limit),
            separate: true,
            fork_at_main: true,
            ..CasesInPrograms::default()
        });
        let plugin = request(&plan);
        assert_eq!(plugin.case_timeout_ms, Some(sent));
        assert!(plugin.separate_cases && plugin.fork_at_main);
    }
    for plan in [in_programs(CasesInPrograms::default()), suite(0, 1)] {
        let plugin = request(&plan);
        assert_eq!(plugin.case_timeout_ms, None);
        assert!(!plugin.separate_cases && !plugin.fork_at_main);
    }
}

fn stack(text: &str) -> ProcessEvent {
    ProcessEvent::Notified(Notification::Stack { text: text.to_owned() })
}

fn stacks<'a>(world: &'a World<'_>) -> Vec<&'a str> {
    world.record.tests[0].attempts[0].stacks.iter().map(String::as_str).collect()
}

#[test]
fn stacks_of_hung_cases_are_reported_up_to_a_limit() {
    let plan = in_programs(CasesInPrograms::default());
    let mut world = World::running(&plan);
    (0..20).for_each(|_| world.input(TEST, stack("of a case")));
    assert_eq!(stacks(&world).len(), 16);
    // The test hangs: the reply to the runner's request is not one too many.
    while !world.record.tests[0].attempts[0].stopped {
        world.next_deadline();
    }
    world.input(TEST, stack("of the test"));
    world.input(TEST, stack("too late"));
    world.input(TEST, ProcessEvent::StackDumped("of the host".to_owned()));
    assert_eq!(stacks(&world)[16..], ["of the test"]);
    world.end(TEST, "interrupted");
    world.finish();
}

/// The host has a debugger dump its program, which takes longer than a dump of itself.
#[test]
fn the_host_has_time_for_a_debugger() {
    let programs = in_programs(CasesInPrograms::default());
    for (plan, seconds) in [(&programs, 10), (&suite(0, 1), 1)] {
        let mut world = World::running(plan);
        while !world.record.tests[0].attempts[0].stopped {
            world.next_deadline();
        }
        assert_eq!(world.dump_waits, [seconds * SECOND]);
        let asked = |world: &World<'_>| {
            world.sent.iter().any(|(.., request)| matches!(request, Request::Interrupt { .. }))
        };
        // Even if no dump arrives at all, the test is asked to stop.
        let start = world.now;
        while !asked(&world) {
            world.next_deadline();
        }
        assert!(world.now - start > (seconds + 10) * SECOND, "a debugger has its time");
        world.end(TEST, "interrupted");
        world.finish();
    }
}
