//! Imports: repeated, replaced, in any order, concurrent.

use std::cell::RefCell;

use rtf_history::{ImportOutcome, Store, StoreError, TestAttributes};
use rtf_model::EventKind;
use rtf_model::Verdict::{Failed, Passed};

use crate::world::{Run, Test, World, all_runs, all_tests, dump, record};

fn runs(number: u32) -> Vec<Run> {
    let run = |day| {
        let verdict = if day % 3 == 0 { Failed } else { Passed };
        let mut moves = Test::new("Moves", verdict);
        moves.measured = vec![("lag", Some(f64::from(day)), "ms"), ("lag", None, "s")];
        Run::new(day, "aaaa", vec![moves, Test::new("Stops", Passed)])
    };
    (1..=number).map(run).collect()
}

#[test]
fn a_run_is_imported_once() {
    let runs = runs(3);
    let mut world = World::with(&runs);
    let before = world.dump();
    for run in &runs {
        assert_eq!(world.import(run), ImportOutcome::Known);
    }
    assert_eq!(world.dump(), before);
    assert_eq!(world.store.counts().expect("counts").runs, 3);
}

#[test]
fn the_order_of_imports_does_not_matter() {
    let mut runs = runs(5);
    runs[3].tests[0].was = Some("Turns");
    runs[1].tests[0].name = "Turns";
    let forward = World::with(&runs).dump();
    runs.reverse();
    assert_eq!(World::with(&runs).dump(), forward);
}

/// The newest run with a test has its tags, also if others with the same tags came later.
#[test]
fn the_tags_of_a_test_are_those_of_its_newest_run() {
    let tagged = |day: u32, tag: &str| {
        let mut events = Run::new(day, "aaaa", vec![Test::new("Moves", Passed)]).events();
        for event in &mut events {
            if let EventKind::TestPlanned(planned) = &mut event.kind {
                planned.tags = vec![tag.to_owned()];
            }
        }
        record(&events)
    };
    let tags = |world: &World| {
        let found = RefCell::new(Vec::new());
        let remember = |test: &TestAttributes| {
            found.borrow_mut().clone_from(&test.tags);
            true
        };
        let results = world.store.for_each_result::<StoreError>(&all_runs(), &remember, |_| Ok(()));
        results.expect("results");
        found.into_inner().join(" ")
    };
    let mut world = World::new();
    for (day, tag, expected) in [
        (1, "old", "old"),
        (5, "old", "old"),
        (3, "other", "old"),
        (7, "new", "new"),
        (6, "old", "new"),
    ] {
        world.store.import(&tagged(day, tag)).expect("an import");
        assert_eq!(tags(&world), expected, "day {day}");
    }
}

#[test]
fn a_run_with_more_events_replaces_the_same_run() {
    let run = &runs(1)[0];
    let events = run.events();
    let mut world = World::new();
    let import = |world: &mut World, events: &[_]| world.store.import(&record(events));
    let torn = import(&mut world, &events[..6]).expect("an import");
    assert_eq!(torn, ImportOutcome::Imported);
    assert_eq!(world.import(run), ImportOutcome::Replaced);
    assert_eq!(import(&mut world, &events[..6]).expect("no import"), ImportOutcome::Known);
    assert_eq!(world.dump(), World::with(std::slice::from_ref(run)).dump());
}

#[test]
fn two_runs_of_one_id_are_refused() {
    let mut runs = runs(1);
    let mut world = World::with(&runs);
    let before = world.dump();
    runs[0].commit = "bbbb";
    let error = world.store.import(&runs[0].record()).expect_err("a conflict");
    assert!(matches!(&error, StoreError::Conflict { id } if id == "id-001"), "{error}");
    assert_eq!(world.dump(), before);
}

#[test]
fn concurrent_writers_lose_nothing() {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("new/history.db");
    let all = runs(40);
    std::thread::scope(|scope| {
        for part in all.chunks(10) {
            let path = &path;
            // Each of them may be the one that creates the database.
            scope.spawn(move || {
                let mut store = Store::open(path).expect("a store");
                for run in part {
                    store.import(&run.record()).expect("an import");
                }
            });
        }
    });
    let store = Store::open(&path).expect("a store");
    assert_eq!(dump(&store), World::with(&all).dump());
}

#[test]
fn numbers_that_are_not_finite_are_counted() {
    let world = World::with(&runs(2));
    let series = world.store.trend("lag", None, &all_runs(), &all_tests).expect("series");
    let [ms, s] = series.as_slice() else { panic!("{series:?}") };
    assert_eq!((ms.series.unit.as_str(), ms.other_units.as_slice()), ("ms", &["s".to_owned()][..]));
    let values: Vec<_> = ms.points.iter().map(|point| point.value).collect();
    assert_eq!(values, [Some(1.0), Some(2.0)]);
    let not_finite: Vec<_> =
        s.points.iter().map(|point| (point.value, point.count, point.not_finite)).collect();
    assert_eq!(not_finite, [(None, 1, 1), (None, 1, 1)]);
}

#[test]
fn a_renamed_test_keeps_its_history() {
    let mut runs = runs(4);
    for run in &mut runs[..2] {
        run.tests[1].name = "Halts";
    }
    runs[2].tests[1].was = Some("Halts");
    let world = World::with(&runs);
    let is_meant = |test: &rtf_history::TestAttributes| test.identity.test == "Stops";
    let found = world.store.test_histories(&all_runs(), &is_meant).expect("histories");
    let [stops] = found.as_slice() else { panic!("{found:?}") };
    assert_eq!(
        (stops.results.len(), stops.former_names.as_slice()),
        (4, &["Halts".to_owned()][..])
    );
    let names = world.store.identities().expect("names");
    assert!(names.iter().all(|identity| identity.test != "Halts"), "{names:?}");
}

#[test]
fn a_merged_run_is_left_out() {
    let runs = runs(3);
    let mut world = World::with(&runs);
    let before = world.store.runs(&all_runs()).expect("runs");
    let mut record = Run { day: 9, ..runs[2].clone() }.record();
    let started = record.run.as_mut().expect("a start");
    started.manifest.origin = None;
    started.manifest.parts = vec![runs[0].id(), runs[1].id()];
    for _ in 0..2 {
        assert_eq!(world.store.import(&record).expect("no import"), ImportOutcome::Merged);
        assert_eq!(world.store.restore(&record).expect("no import"), ImportOutcome::Merged);
    }
    assert_eq!(world.store.runs(&all_runs()).expect("runs"), before);
    let names = world.store.run_names().expect("names");
    assert!(names.contains(&"run-009".to_owned()), "its journal is not read again: {names:?}");
}

#[test]
fn a_log_that_stays_is_read_by_the_next_process() {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("history.db");
    let all = runs(30);
    for run in &all {
        let mut store = Store::open(&path).expect("a store");
        store.keep_log().expect("an option");
        store.import(&run.record()).expect("an import");
    }
    let log = dir.path().join("history.db-wal");
    assert!(log.metadata().is_ok_and(|log| log.len() > 0), "closing copies nothing");
    let store = Store::open_existing(&path).expect("a store");
    assert_eq!(dump(&store), World::with(&all).dump());
    drop(store);
    assert!(!log.exists(), "a question copies it");
}

#[test]
fn a_log_that_stays_does_not_grow_with_each_run() {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("history.db");
    let all = runs(200);
    let (mut previous, mut largest, mut copied) = (0, 0, 0);
    for run in &all {
        let mut store = Store::open(&path).expect("a store");
        store.keep_log().expect("an option");
        store.import(&run.record()).expect("an import");
        drop(store);
        let log = dir.path().join("history.db-wal").metadata().map_or(0, |log| log.len());
        copied += u64::from(log < previous);
        largest = largest.max(log);
        previous = log;
    }
    assert!(largest < 3 << 20, "{largest} bytes");
    assert!((1..all.len() as u64 / 4).contains(&copied), "copied {copied} times");
    let store = Store::open_existing(&path).expect("a store");
    assert_eq!(dump(&store), World::with(&all).dump());
}
