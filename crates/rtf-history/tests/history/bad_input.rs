//! Databases that cannot be used.

use std::fs;
use std::path::Path;

use rtf_history::{Store, StoreError};
use rtf_model::Verdict::{Failed, Passed};
use rusqlite::Connection;

use crate::world::{Run, Test, World, all_runs, all_tests, dump};

fn run() -> Run {
    Run::new(1, "aaaa", vec![Test::new("Moves", Passed)])
}

fn open_both(path: &Path) -> [StoreError; 2] {
    [Store::open(path), Store::open_existing(path)].map(|opened| opened.expect_err("refused"))
}

#[test]
fn a_file_that_is_no_database_is_refused_and_unchanged() {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("history.db");
    fs::write(&path, "my notes\n".repeat(1000)).expect("a file");
    for error in open_both(&path) {
        assert!(matches!(error, StoreError::Corrupt { .. }), "{error}");
        assert!(error.hint().is_some_and(|hint| hint.contains("rtf history import")));
    }
    assert_eq!(fs::read_to_string(&path).expect("a file"), "my notes\n".repeat(1000));
}

#[test]
fn a_damaged_database_is_reported() {
    let runs: Vec<_> = (1..40).map(|day| Run { day, ..run() }).collect();
    let world = World::with(&runs);
    let path = world.path();
    let dir = world.dir;
    drop(world.store);
    let mut bytes = fs::read(&path).expect("a file");
    // Keep the first page, with the header and the tables.
    bytes[4096..].fill(0x5a);
    fs::write(&path, bytes).expect("a file");
    let found = Store::open(&path).and_then(|store| {
        store.runs(&all_runs())?;
        store.check()
    });
    match found {
        Ok(problems) => assert!(!problems.is_empty()),
        Err(error) => assert!(matches!(error, StoreError::Corrupt { .. }), "{error}"),
    }
    drop(dir);
}

#[test]
fn a_newer_version_is_refused_and_unchanged() {
    let world = World::with(&[run()]);
    let connection = Connection::open(world.path()).expect("a database");
    connection.pragma_update(None, "user_version", 99).expect("a version");
    drop(connection);
    for error in open_both(&world.path()) {
        assert!(matches!(error, StoreError::Newer { found: 99, known: 3, .. }), "{error}");
    }
    let connection = Connection::open(world.path()).expect("a database");
    let version = connection.query_row("PRAGMA user_version", [], |row| row.get::<_, i64>(0));
    assert_eq!(version, Ok(99));
}

#[test]
fn a_database_of_version_2_keeps_its_results() {
    let day = |day, verdict| Run::new(day, "aaaa", vec![Test::new("Moves", verdict)]);
    let world = World::with(&[day(1, Passed), day(2, Failed)]);
    let before = world.dump();
    let path = world.path();
    let dir = world.dir;
    drop(world.store);
    let connection = Connection::open(&path).expect("a database");
    let earlier = "ALTER TABLE result DROP COLUMN source_hash;
                   ALTER TABLE run_columns DROP COLUMN sources;
                   PRAGMA user_version = 2;";
    connection.execute_batch(earlier).expect("version 2");
    drop(connection);
    let mut store = Store::open_existing(&path).expect("a store");
    assert_eq!(dump(&store), before);
    let mut next = day(3, Passed);
    next.tests[0].sources = Some("1f");
    store.import(&next.record()).expect("an import");
    let flaky = store.flaky(&all_runs(), &all_tests).expect("flaky tests");
    assert_eq!((flaky.tests[0].flips.flips, flaky.tests[0].flips.pairs), (2, 2));
    drop(dir);
}

#[test]
fn a_database_of_another_program_is_refused() {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("other.db");
    let connection = Connection::open(&path).expect("a database");
    connection.execute_batch("CREATE TABLE note (text TEXT)").expect("a table");
    for error in open_both(&path) {
        assert!(matches!(error, StoreError::Foreign { .. }), "{error}");
    }
}

#[test]
fn a_question_does_not_create_a_database() {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("history.db");
    let error = Store::open_existing(&path).expect_err("nothing is there");
    assert!(matches!(error, StoreError::Missing { .. }), "{error}");
    assert!(!path.exists());
}

#[test]
fn a_directory_is_no_database() {
    let dir = tempfile::tempdir().expect("a directory");
    let error = Store::open(dir.path()).expect_err("a directory");
    assert!(matches!(error, StoreError::Io { .. }), "{error}");
}

#[test]
fn a_locked_database_is_reported_and_unchanged() {
    let mut world = World::with(&[run()]);
    let before = world.dump();
    let mut other = Connection::open(world.path()).expect("a database");
    let lock = other.transaction_with_behavior(rusqlite::TransactionBehavior::Immediate);
    let error = world.store.import(&Run { day: 2, ..run() }.record()).expect_err("locked");
    assert!(matches!(error, StoreError::Locked { .. }), "{error}");
    drop(lock);
    assert_eq!(world.dump(), before);
    world.store.import(&Run { day: 2, ..run() }.record()).expect("free");
}

#[test]
fn names_of_every_kind_are_stored_as_they_are() {
    let name = "a'b\"c;--\n\u{1b}[31m\u{202e}%_\\";
    let mut run = run();
    run.tests[0].name = Box::leak(name.to_owned().into_boxed_str());
    let world = World::with(&[run]);
    let reopened = Store::open_existing(world.path()).expect("a store");
    assert_eq!(reopened.identities().expect("names")[0].test, name);
    assert_eq!(dump(&reopened), world.dump());
}

#[test]
fn a_damaged_record_is_refused() {
    let mut world = World::new();
    let mut record = run().record();
    record.add_damage(rtf_model::Damage { line: 3, problem: "cut".to_owned() });
    let error = world.store.import(&record).expect_err("damaged");
    assert!(error.to_string().contains("damaged"), "{error}");
    assert_eq!(world.store.counts().expect("counts").runs, 0);
}
