//! Answers from the packed columns of runs equal those computed from the rows.

use std::collections::BTreeMap;

use rtf_history::answers::{PointLine, ResultLine};
use rtf_history::statistics::change_points::Options;
use rtf_history::statistics::find_change_points;
use rtf_history::statistics::robust::median;
use rtf_history::{RunSelection, StoreError};
use rtf_model::Verdict::{Failed, Passed};

use crate::world::{Run, Test, World, all_runs, all_tests};

const ROBOTS: [&str; 2] = ["robot:icub", "robot:ergocub gpu"];

/// Two robots alternate; a number and a duration of `Moves` change, differently on each; its
/// name changes, too.
fn world() -> World {
    let run = |day: u32| {
        let late = day > 30;
        let noise = f64::from(day * 7919 % 101) / 100.0;
        let robot = (day % 2) as usize;
        let mut moves = Test::new(if late { "Moves" } else { "Turns" }, Passed);
        moves.was = (day == 33).then_some("Turns");
        let lag = 10.0 + noise + if late && robot == 0 { 5.0 } else { 0.0 };
        moves.measured =
            vec![("lag", Some(lag).filter(|_| !day.is_multiple_of(9)), "ms"), ("lag", None, "s")];
        moves.millis = 100 + u64::from(day * 31 % 7) + if late && robot == 1 { 50 } else { 0 };
        let verdict = if day.is_multiple_of(5) { Failed } else { Passed };
        let stops = Test { millis: u64::from(day), ..Test::new("Stops", verdict) };
        Run { robot: ROBOTS[robot], ..Run::new(day, "aaaa", vec![moves, stops]) }
    };
    let mut runs: Vec<_> = (1..=60).map(run).collect();
    // Not in the order of time.
    runs.sort_by_key(|run| run.day * 37 % 61);
    World::with(&runs)
}

fn results(world: &World, runs: &RunSelection) -> Vec<ResultLine> {
    let mut lines = Vec::new();
    let visit = |line| {
        lines.push(line);
        Ok::<_, StoreError>(())
    };
    world.store.for_each_result(runs, &all_tests, visit).expect("results");
    lines
}

fn points(world: &World, runs: &RunSelection) -> Vec<PointLine> {
    let mut lines = Vec::new();
    let visit = |line| {
        lines.push(line);
        Ok::<_, StoreError>(())
    };
    world.store.for_each_point(runs, &all_tests, visit).expect("points");
    lines
}

fn selections() -> [RunSelection; 3] {
    let robot = |name: &str| RunSelection { robot: Some(name.to_owned()), ..all_runs() };
    [all_runs(), robot("robot:icub"), RunSelection { last: Some(25), ..robot("gpu") }]
}

#[test]
fn durations() {
    let world = world();
    for runs in selections() {
        let mut expected = BTreeMap::<_, Vec<f64>>::new();
        for line in results(&world, &runs) {
            expected.entry(line.identity).or_default().extend(line.result.duration);
        }
        let slow = world.store.slow(&runs, &all_tests).expect("durations");
        assert_eq!(slow.len(), expected.len());
        for test in slow {
            let seconds = &expected[&test.identity];
            let found = (test.runs, Some(test.median), Some(&test.last));
            assert_eq!(found, (seconds.len(), median(seconds), seconds.last()));
        }
    }
}

#[test]
fn changes() {
    let world = world();
    for (runs, are_expected) in selections().into_iter().zip([true, true, false]) {
        let mut robots = BTreeMap::new();
        let mut expected = BTreeMap::<_, Vec<(String, f64)>>::new();
        for ResultLine { identity, result } in results(&world, &runs) {
            if result.verdict == Passed {
                let key = (identity, None, result.robot.clone());
                expected
                    .entry(key)
                    .or_default()
                    .extend(result.duration.map(|it| (result.run.clone(), it)));
            }
            robots.insert(result.run, result.robot);
        }
        for PointLine { identity, series, point } in points(&world, &runs) {
            let key = (identity, Some(series), robots[&point.run].clone());
            expected.entry(key).or_default().extend(point.value.map(|it| (point.run, it)));
        }
        let mut all = Vec::new();
        for ((identity, series, robot), numbers) in expected {
            let values: Vec<f64> = numbers.iter().map(|(_, value)| *value).collect();
            for change in find_change_points(&values, &Options::default()).points {
                let run = numbers[change.index].0.clone();
                all.push((identity.clone(), series.clone(), robot.clone(), run, change));
            }
        }
        let found = world.store.changes(&runs, &all_tests).expect("changes");
        let mut found: Vec<_> = found
            .into_iter()
            .map(|it| (it.identity, it.series, it.robot, it.run, it.change))
            .collect();
        let key = |it: &(_, _, String, String, _)| (it.2.clone(), it.3.clone());
        all.sort_by_key(key);
        found.sort_by_key(key);
        assert_eq!(!all.is_empty(), are_expected);
        assert_eq!(found, all);
    }
}

#[test]
fn comparisons() {
    let world = world();
    let [all, icub, gpu] = selections();
    let found = world.store.compare((&all, &gpu), &all_tests).expect("a comparison");
    let moves = &found.tests[0];
    assert_eq!(moves.identity.test, "Moves");
    for (runs, number, counts) in
        [(&all, moves.numbers[0].a, moves.verdicts_a), (&gpu, moves.numbers[0].b, moves.verdicts_b)]
    {
        let lines =
            points(&world, runs).into_iter().filter(|it| it.series == moves.numbers[0].series);
        assert_eq!(number, median(&lines.filter_map(|it| it.point.value).collect::<Vec<_>>()));
        let lines = results(&world, runs).into_iter().filter(|it| it.identity == moves.identity);
        assert_eq!(counts.total() as usize, lines.count());
    }
    assert_eq!(world.store.compare((&icub, &icub), &all_tests).expect("a comparison").only_a, []);
}

#[test]
fn a_removed_run_has_no_columns() {
    let mut world = world();
    let keep = rtf_history::store::Keep::Newest(5);
    let removed = world.store.prune(keep).expect("a removal");
    let left = world.store.runs(&all_runs()).expect("runs").len();
    assert_eq!((removed.len() + left, left < 10), (60, true));
    let slow = world.store.slow(&all_runs(), &all_tests).expect("durations");
    assert!(slow.iter().all(|test| test.runs == left), "{slow:?}");
    assert_eq!(world.store.check().expect("a check"), Vec::<String>::new());
}
