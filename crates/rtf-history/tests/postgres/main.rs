//! The history in PostgreSQL: a real server, which the test starts and ends.

#![expect(clippy::expect_used, reason = "a helper that cannot continue fails its test")]

#[path = "../history/campaigns.rs"]
mod campaigns;
mod server;
#[path = "../history/world.rs"]
mod world;

use std::time::{Duration, Instant};

use rtf_history::store::{Keep, Location};
use rtf_history::{ImportOutcome, RunSelection, Store, StoreError};
use rtf_model::Verdict::{Failed, Passed};

use server::Server;
use world::{Run, Test, World, all_runs, all_tests, dump};

/// What the tests have in common: they need the same server.
#[test]
#[ignore = "needs PostgreSQL: tests/test_rust.py runs it"]
fn a_history_in_postgresql() {
    let server = Server::start();
    answers_are_those_of_sqlite(&server);
    concurrent_writers_lose_nothing(&server);
    a_newer_version_is_refused(&server);
    an_earlier_version_keeps_its_results(&server);
    connections_are_encrypted(&server);
    a_password_is_never_printed(&server);
    let address = server.address("postgres", "sslmode=disable");
    drop(server);
    a_server_that_is_down_is_reported_at_once(&address);
}

/// Runs with flaky tests, changes, two robots, a renamed test and odd names.
fn runs() -> Vec<Run> {
    let run = |day: u32| {
        let late = day > 24;
        let noise = f64::from(day * 7919 % 101) / 100.0;
        let flaky = if day % 7 == 3 { Failed } else { Passed };
        let mut moves = Test::new(if late { "Moves" } else { "Turns" }, flaky);
        moves.was = late.then_some("Turns");
        let lag = 10.0 + noise + if late { 5.0 } else { 0.0 };
        moves.measured = vec![("lag", Some(lag), "ms"), ("lag", None, "s")];
        let mut retried = Test::new("é \"quoted\"; DROP TABLE run; --\n\u{202e}", Passed);
        if day.is_multiple_of(4) {
            retried.verdicts = vec![Failed, Passed];
        }
        retried.millis = u64::from(day);
        moves.sources = [None, Some("1f"), Some("ffffffffffffffff")][(day % 3) as usize];
        let commit = ["aaaa", "bbbb", "cccc"][(day / 4 % 3) as usize];
        let robot = ["robot:icub", "robot:ergocub gpu"][(day % 2) as usize];
        Run {
            robot,
            ..Run::new(
                day,
                commit,
                vec![moves, retried, Test::new("a", Passed), Test::new("B", Passed)],
            )
        }
    };
    (1..=48).map(run).collect()
}

/// The answers to all questions, as JSON.
fn answers(store: &Store) -> Vec<String> {
    let robot = RunSelection { robot: Some("gpu".to_owned()), ..all_runs() };
    let newest = RunSelection { last: Some(5), ..all_runs() };
    let mut all = dump(store);
    for runs in [&all_runs(), &robot, &newest] {
        let json = |answer: Result<String, serde_json::Error>| answer.expect("JSON");
        all.push(json(serde_json::to_string(&store.runs(runs).expect("runs"))));
        all.push(json(serde_json::to_string(&store.flaky(runs, &all_tests).expect("flaky"))));
        all.push(json(serde_json::to_string(&store.slow(runs, &all_tests).expect("slow"))));
        all.push(json(serde_json::to_string(&store.changes(runs, &all_tests).expect("changes"))));
        let trend = store.trend("lag", None, runs, &all_tests).expect("trend");
        all.push(json(serde_json::to_string(&trend)));
        let histories = store.test_histories(runs, &all_tests).expect("histories");
        all.push(json(serde_json::to_string(&histories)));
        let comparison = store.compare((&newest, runs), &all_tests).expect("a comparison");
        all.push(json(serde_json::to_string(&comparison)));
    }
    all.push(format!("{:?}", store.counts().expect("counts")));
    all.push(format!("{:?}", store.series_names().expect("names")));
    let mut names = store.run_names().expect("names");
    names.sort();
    all.push(names.join(" "));
    all.extend(campaigns::dump(store));
    all
}

fn answers_are_those_of_sqlite(server: &Server) {
    let runs = runs();
    let world = World::new();
    let path = world.path();
    let World { dir, store: mut sqlite } = world;
    let mut postgres = Store::open(server.database("answers")).expect("a store");
    for store in [&mut sqlite, &mut postgres] {
        // In another order; a torn one first.
        let torn = &runs[0].events()[..8];
        assert_eq!(store.import(&world::record(torn)).expect("an import"), ImportOutcome::Imported);
        assert_eq!(store.import(&runs[0].record()).expect("an import"), ImportOutcome::Replaced);
        for run in runs[1..].iter().rev() {
            assert_eq!(store.import(&run.record()).expect("an import"), ImportOutcome::Imported);
        }
        assert_eq!(store.import(&runs[5].record()).expect("an import"), ImportOutcome::Known);
        for campaign in campaigns::campaigns().iter().rev() {
            let outcome = store.import_campaign(campaign).expect("an import");
            assert_eq!(outcome, ImportOutcome::Imported);
            let outcome = store.import_campaign(campaign).expect("an import");
            assert_eq!(outcome, ImportOutcome::Known);
        }
        let conflict = Run { branch: "other", ..runs[5].clone() }.record();
        let error = store.import(&conflict).expect_err("a conflict");
        assert!(matches!(error, StoreError::Conflict { .. }), "{error}");
    }
    assert_eq!(answers(&postgres), answers(&sqlite));
    assert!(!postgres.changes(&all_runs(), &all_tests).expect("changes").is_empty());
    assert_eq!(postgres.campaign_changes(&all_runs()).expect("changes").len(), 1);
    assert!(!postgres.flaky(&all_runs(), &all_tests).expect("flaky tests").tests.is_empty());
    let removed = [&mut sqlite, &mut postgres].map(|store| {
        let removed = store.prune(Keep::Newest(10)).expect("a removal");
        assert_eq!(store.import(&runs[0].record()).expect("no import"), ImportOutcome::Pruned);
        assert_eq!(store.restore(&runs[2].record()).expect("an import"), ImportOutcome::Imported);
        removed
    });
    assert_eq!(removed[0], removed[1]);
    let removed = [&mut sqlite, &mut postgres]
        .map(|store| store.prune_campaigns(Keep::Newest(2)).expect("a removal"));
    assert_eq!((removed[0].len(), &removed[0]), (6, &removed[1]));
    assert_eq!(answers(&postgres), answers(&sqlite));
    assert_eq!(postgres.check().expect("a check"), Vec::<String>::new());
    drop(sqlite);
    let reopened = [Location::from(path), server.database("answers")]
        .map(|location| answers(&Store::open_existing(location).expect("a store")));
    assert_eq!(reopened[0], reopened[1]);
    drop(dir);
}

fn concurrent_writers_lose_nothing(server: &Server) {
    let location = server.database("writers");
    let missing = Store::open_existing(&location).expect_err("no tables");
    assert!(matches!(missing, StoreError::Missing { .. }), "{missing}");
    let runs = runs();
    std::thread::scope(|scope| {
        for part in runs.chunks(12) {
            let location = &location;
            // Each of them may be the one that creates the tables.
            scope.spawn(move || {
                let mut store = Store::open(location).expect("a store");
                for run in part {
                    store.import(&run.record()).expect("an import");
                }
            });
        }
    });
    let store = Store::open(&location).expect("a store");
    assert_eq!(dump(&store), World::with(&runs).dump());
}

fn a_newer_version_is_refused(server: &Server) {
    let location = server.database("newer");
    drop(Store::open(&location).expect("a store"));
    server.execute("newer", "INSERT INTO rtf_history.migration (version) VALUES (99)");
    for error in [Store::open(&location), Store::open_existing(&location)] {
        let error = error.expect_err("refused");
        assert!(matches!(error, StoreError::Newer { found: 99, .. }), "{error}");
    }
}

fn an_earlier_version_keeps_its_results(server: &Server) {
    let location = server.database("earlier");
    let mut store = Store::open(&location).expect("a store");
    let runs = runs();
    store.import(&runs[0].record()).expect("an import");
    let before = dump(&store);
    drop(store);
    let earlier = "ALTER TABLE rtf_history.result DROP COLUMN source_hash;
                   ALTER TABLE rtf_history.run_columns DROP COLUMN sources;
                   DELETE FROM rtf_history.migration WHERE version = 3";
    server.execute("earlier", earlier);
    let mut store = Store::open_existing(&location).expect("a store");
    // A run without sources is stored as before.
    assert_eq!(dump(&store).len(), before.len());
    store.import(&runs[1].record()).expect("an import");
    assert_eq!(store.runs(&all_runs()).expect("runs").len(), 2);
}

fn connections_are_encrypted(server: &Server) {
    let root = format!("sslmode=verify-full&sslrootcert={}", server.certificate().display());
    let encrypted = ["sslmode=require", "sslmode=prefer", "", &root];
    let options = encrypted.map(|options| (options, true)).into_iter();
    for ((options, is_encrypted), number) in options.chain([("sslmode=disable", false)]).zip(0..) {
        let database = format!("tls{number}");
        server.create(&database);
        let address = server.address(&database, options);
        let store = Store::open(Location::postgres(&address).expect("an address"));
        let store = store.expect(options);
        assert_eq!(server.is_encrypted(&database), is_encrypted, "{options}");
        drop(store);
    }
    // The system does not know the authority.
    let address = server.address("tls0", "sslmode=verify-full");
    let error = Store::open(Location::postgres(&address).expect("an address"));
    let error = error.expect_err("an unknown certificate");
    assert!(matches!(error, StoreError::Io { .. }), "{error}");
}

fn a_password_is_never_printed(server: &Server) {
    let address = server.address("postgres", "").replace(server::PASSWORD, "s3cret");
    let error = Store::open(Location::postgres(&address).expect("an address"));
    let error = error.expect_err("a wrong password");
    let mut text = format!("{error} {error:?} {:?}", error.hint());
    let mut source: Option<&dyn std::error::Error> = std::error::Error::source(&error);
    while let Some(cause) = source {
        text += &format!(" {cause} {cause:?}");
        source = cause.source();
    }
    assert!(text.contains("password authentication failed"), "{text}");
    assert!(!text.contains("s3cret"), "{text}");
}

fn a_server_that_is_down_is_reported_at_once(address: &str) {
    let started = Instant::now();
    let error = Store::open(Location::postgres(address).expect("an address"));
    assert!(matches!(error.expect_err("down"), StoreError::Io { .. }));
    assert!(started.elapsed() < Duration::from_secs(5));
}
