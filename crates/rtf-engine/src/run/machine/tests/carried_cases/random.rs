//! Random collapses while cases run.

use std::collections::BTreeSet;

use proptest::prelude::*;
use rtf_model::{Outcome, Verdict};

use super::super::world::{SECOND, World};
use super::rerun;

/// Runs the selected cases in order until a step says otherwise. Returns the failed cases
/// whose problem counts.
fn run_randomly(world: &mut World<'_>, steps: &[u8]) -> BTreeSet<String> {
    let all = ["a", "b", "c", "d", "e", "f"].map(str::to_owned);
    let mut failed = BTreeSet::new();
    let mut left = all.to_vec();
    let mut number = 0;
    world.plan_cases(&left.iter().map(String::as_str).collect::<Vec<_>>());
    for step in steps {
        let Some(name) = left.first().cloned() else { break };
        number += 1;
        world.case(number, &name, None);
        if step % 4 == 0 {
            world.case(number + 1, "inner", Some(number));
        }
        if step % 3 == 0 {
            world.now += SECOND;
            world.collapse_and_rerun();
            left = world.selected().into_iter().map(str::to_owned).collect();
            if left.is_empty() {
                left = all.to_vec();
            }
            world.plan_cases(&left.iter().map(String::as_str).collect::<Vec<_>>());
            number = 0;
            continue;
        }
        if step % 4 == 0 {
            world.case_ends(number + 1);
        }
        let fails = step % 5 == 0;
        world.case_ends_with(number, fails.then_some(Outcome::Failed), None);
        if fails {
            failed.insert(name);
        }
        number += u32::from(step % 4 == 0);
        left.remove(0);
    }
    for name in left {
        number += 1;
        world.passes(number, &name);
    }
    failed
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn the_last_attempt_has_each_case_once(steps in prop::collection::vec(any::<u8>(), 0..16)) {
        let plan = rerun();
        let mut world = World::running_cases(&plan);
        let failed = run_randomly(&mut world, &steps);
        world.end_suite("passed");
        let cases = world.last_attempt().cases.kept();
        let tops: Vec<_> = cases.iter().filter(|case| case.start.parent.is_none()).collect();
        let names: BTreeSet<_> = tops.iter().map(|case| &*case.path).collect();
        prop_assert_eq!(names, BTreeSet::from(["a", "b", "c", "d", "e", "f"]));
        prop_assert_eq!(tops.len(), 6);
        let problems = tops.iter().filter(|case| case.verdict() == Some(Verdict::Failed));
        let problems: BTreeSet<_> = problems.map(|case| case.path.clone()).collect();
        let expected = if problems.is_empty() { Verdict::Passed } else { Verdict::Failed };
        prop_assert_eq!(world.verdict().0, expected);
        prop_assert_eq!(problems, failed);
    }
}
