//! Limits that are learned from planted results.

use rtf_history::answers::learned::{LearnQuery, Learned};
use rtf_history::{RunSelection, TestIdentity};
use rtf_model::Verdict::{self, Failed, Passed};

use crate::world::{Run, Test, World};

fn query() -> LearnQuery {
    let (suite_file, suite) = ("arm.xml".to_owned(), "arm".to_owned());
    LearnQuery {
        test: TestIdentity { suite_file, suite, test: "Moves".to_owned(), case: String::new() },
        former: None,
        robot: String::new(),
        measurement: "lag".to_owned(),
        min_runs: 3,
        sigma: 4.0,
        since: None,
    }
}

fn run(day: u32, verdict: Verdict, lag: f64, unit: &'static str) -> Run {
    let test = Test { measured: vec![("lag", Some(lag), unit)], ..Test::new("Moves", verdict) };
    Run::new(day, "aaaa", vec![test])
}

fn learned(runs: &[Run], query: &LearnQuery) -> Learned {
    let world = World::with(runs);
    let mut found =
        world.store.learn(&RunSelection::default(), std::slice::from_ref(query)).expect("limits");
    found.remove(0)
}

#[test]
fn only_green_runs_on_the_same_robot_count() {
    let mut runs: Vec<_> = (1..=4).map(|day| run(day, Passed, f64::from(day), "ms")).collect();
    runs.push(run(5, Failed, 99.0, "ms"));
    runs.push(Run { robot: "robot:icub", ..run(6, Passed, 99.0, "ms") });
    let found = learned(&runs, &query());
    assert_eq!((found.runs, found.unit.as_str(), &found.changed), (4, "ms", &None));
    let (low, high) = found.limits.expect("limits");
    assert!((low + high - 5.0).abs() < 1e-9, "around the median: {low} … {high}");
    let few = learned(&runs, &LearnQuery { min_runs: 5, ..query() });
    assert_eq!((few.runs, few.limits), (4, None));
    let robot = learned(&runs, &LearnQuery { robot: "robot:icub".to_owned(), ..query() });
    assert_eq!(robot.runs, 1);
    let none = learned(&runs, &LearnQuery { measurement: "leg".to_owned(), ..query() });
    assert_eq!(none, Learned::default());
}

#[test]
fn limits_are_frozen_at_a_change_until_it_is_accepted() {
    let noise = |day: u32| f64::from(day % 3) / 10.0;
    let mut runs: Vec<_> = (0..20).map(|day| run(day, Passed, 10.0 + noise(day), "ms")).collect();
    runs.extend((20..40).map(|day| run(day, Passed, 20.0 + noise(day), "ms")));
    let found = learned(&runs, &query());
    let changed = found.changed.clone().expect("a change");
    assert_eq!((found.runs, changed.run.as_str()), (20, "run-020"));
    assert!(found.limits.is_some_and(|(_, high)| high < 15.0), "{found:?}");
    let accepted = learned(&runs, &LearnQuery { since: Some(changed.started), ..query() });
    assert_eq!((accepted.runs, accepted.changed), (20, None));
    assert!(accepted.limits.is_some_and(|(low, _)| low > 15.0), "{:?}", accepted.limits);
}

#[test]
fn the_unit_of_the_newest_value_counts() {
    let mut runs: Vec<_> = (0..9).map(|day| run(day, Passed, 10.0, "ms")).collect();
    runs.push(run(9, Passed, 0.01, "s"));
    let found = learned(&runs, &query());
    assert_eq!((found.unit.as_str(), found.runs, found.limits), ("s", 1, None));
}

#[test]
fn a_former_name_teaches_until_the_new_one_has_run() {
    let runs: Vec<_> = (0..9).map(|day| run(day, Passed, 10.0, "ms")).collect();
    let mut renamed = query();
    renamed.former = Some(renamed.test.clone());
    renamed.test.test = "Lifts".to_owned();
    assert_eq!(learned(&runs, &renamed).runs, 9);
}
