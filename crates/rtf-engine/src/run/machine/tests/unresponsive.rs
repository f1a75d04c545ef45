//! When no process does anything any more, not even end when it is killed, deadlines
//! alone end the suite. `suite/deadline_invariant.rs` asserts that one is always pending;
//! these tests drive it through the states.

use std::sync::Arc;
use std::time::Duration;

use proptest::prelude::*;
use rtf_model::Trigger;

use super::chaos::act;
use super::world::{SECOND, World, hook, suite};
use crate::run::machine::ProcessEvent;
use rtf_plan::plan::{
    AfterCollapse, ClockPlan, FixtureBody, ProbePlans, ProcessPlan, Retries, SuitePlan,
};

/// The last fixture is a plug-in, a process, or attached.
fn body(kind: u8) -> Option<FixtureBody> {
    match kind {
        0 => None,
        1 => Some(FixtureBody::Process(Arc::new(ProcessPlan {
            command: vec!["sim".to_owned()],
            probes: ProbePlans::default(),
            stop_signal: 15,
            stop_grace: SECOND,
            stop_codes: Vec::new(),
            remote: None,
        }))),
        _ => Some(FixtureBody::Attached(Arc::default())),
    }
}

#[derive(Clone, Debug)]
struct Choices {
    fixtures: usize,
    tests: usize,
    parallel: u32,
    kind: u8,
    flags: u8,
}

fn plan(choices: &Choices) -> SuitePlan {
    let Choices { fixtures, tests, parallel, kind, flags } = *choices;
    let flag = |bit: u8| flags & (1 << bit) != 0;
    let mut plan = suite(fixtures, tests);
    let shared = flag(0);
    plan.settings.parallel = if shared { 1 } else { parallel };
    plan.tests.iter_mut().for_each(|test| test.settings.shared = shared);
    for fixture in &mut plan.fixtures {
        fixture.restart_delay = SECOND;
        fixture.restarts = 2;
        fixture.check_every = flag(1).then_some(SECOND);
        if flag(2) {
            fixture.depends.clear();
        }
    }
    if let (Some(fixture), Some(body)) = (plan.fixtures.last_mut(), body(kind)) {
        fixture.body = body;
    }
    plan.settings.timeout = flag(3).then_some(20 * SECOND);
    plan.clock = flag(4).then_some(ClockPlan { backstop: 10 });
    plan.tests[0].settings.after_collapse = AfterCollapse::Rerun;
    plan.tests[tests - 1].settings.repetitions = 2;
    plan.tests[tests / 2].settings.retries = Retries { count: 2, delay: SECOND };
    plan.hooks = vec![hook(0, &Trigger::ALL), hook(1, &[Trigger::End])];
    plan
}

fn choices() -> impl Strategy<Value = Choices> {
    (0..3usize, 1..5usize, 1..4u32, 0..3u8, any::<u8>()).prop_map(
        |(fixtures, tests, parallel, kind, flags)| Choices {
            fixtures,
            tests,
            parallel,
            kind,
            flags,
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn deadlines_alone_end_a_suite(
        choices in choices(),
        steps in prop::collection::vec((any::<u8>(), 0..4usize), 0..200),
        timed in any::<bool>(),
        unseen in any::<bool>(),
    ) {
        let plan = plan(&choices);
        let mut world = if timed { World::timed(&plan) } else { World::new(&plan) };
        if timed {
            world.machine = world.machine.until(Some(30 * SECOND));
        }
        world.hides_liveness = unseen;
        world.start();
        for (choice, which) in steps {
            if world.done {
                break;
            }
            let ready = world.hosts.iter().next().filter(|_| choice == 77).map(|(_, of)| *of);
            match ready {
                Some(source) => world.input(source, ProcessEvent::ProbesPassed),
                None => act(&mut world, choice, which, choices.flags & 1 != 0),
            }
        }
        // From here on, no process responds.
        world.hides_liveness = true;
        let begin = world.now;
        let mut passed = 0;
        while !world.done {
            world.next_deadline();
            passed += 1;
            prop_assert!(passed < 1000, "{:#?}", world.log);
        }
        prop_assert!(world.now - begin < Duration::from_secs(600), "{:#?}", world.log);
        world.finish();
        prop_assert_eq!(world.record.totals().done() as usize, choices.tests);
    }
}
