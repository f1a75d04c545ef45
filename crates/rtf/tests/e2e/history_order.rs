//! Tests are ordered, and assigned to shards, by their results in the history.

use insta::assert_snapshot;
use serde_json::{Value, json};

use crate::support::{Finished, Folder};

const PASSES: &str = "TestCase = {}\nfunction TestCase.run() end\n";
const FAILS: &str = "TestCase = {}\nfunction TestCase.run() rtf.fail('stuck') end\n";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("cell/P.lua", PASSES).file("cell/Q.lua", PASSES);
    let tests = "<test name='a'>P.lua</test><test name='b'>Q.lua</test><test name='c'>P.lua</test>";
    folder.file("cell/arm.xml", &format!("<suite name='arm'>{tests}</suite>"));
    folder.file(".git/HEAD", "ref: refs/heads/main\n");
    folder.file(".git/refs/heads/main", "0123456789abcdef0123456789abcdef01234567\n");
    folder
}

fn listed(folder: &Folder, args: &[&str]) -> String {
    let finished = folder.rtf(&[&["list", "cell/arm.xml"], args].concat());
    assert_eq!(finished.code, Some(0), "{}", finished.stderr);
    finished.stdout.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn ran(folder: &Folder) -> String {
    let record = folder.journal().record;
    let names: Vec<_> = record.tests.iter().map(|test| test.plan.name.clone()).collect();
    names.join(" ")
}

#[test]
fn tests_that_failed_last_run_first() {
    let folder = folder();
    folder.file("cell/Q.lua", FAILS);
    folder.rtf(&["run", "cell/arm.xml"]);
    folder.file("cell/Q.lua", PASSES);
    assert_eq!(listed(&folder, &[]), "arm/a arm/b arm/c");
    assert_eq!(listed(&folder, &["--order", "failed-first"]), "arm/b arm/a arm/c");
    let other = listed(
        &folder,
        &["--order", "failed-first", "--results", "other", "--history", "rtf-results/history.db"],
    );
    assert_eq!(other, "arm/b arm/a arm/c");

    // From another directory, through `rtf.toml`.
    folder.file("cell/rtf.toml", "order = \"failed-first\"\n");
    let mut command = folder.command(&["run", "arm.xml", "--results", "../rtf-results"]);
    command.current_dir(folder.path().join("cell"));
    assert_eq!(Finished::of(command.output().expect("rtf runs")).code, Some(0));
    assert_eq!(ran(&folder), "b a c");
    let manifest = folder.journal().record.run.expect("a start").manifest;
    assert_eq!(manifest.order.as_deref(), Some("failed-first"));

    // Now it has passed, and another one has failed.
    assert_eq!(listed(&folder, &["--order", "failed-first"]), "arm/a arm/b arm/c");
    folder.rtf(&["run", "cell/arm.xml", "--shuffle=7", "--filter", "name(=c)"]);
    assert_eq!(folder.journal().record.run.expect("a start").manifest.order, None);
}

#[test]
fn a_profile_has_its_own_results() {
    let folder = folder();
    folder.file("cell/rtf.toml", "[profile.real]\n[profile.sim]\n");
    folder.file("cell/Q.lua", FAILS);
    folder.rtf(&["run", "cell/arm.xml", "--profile", "real"]);
    let order = |profile| listed(&folder, &["--order", "failed-first", "--profile", profile]);
    assert_eq!(order("real"), "arm/b arm/a arm/c");
    assert_eq!(order("sim"), "arm/a arm/b arm/c");
}

#[test]
fn slow_tests_run_first() {
    let folder = folder();
    folder.rtf(&["run", "cell/arm.xml"]);
    let slow = folder.rtf(&["history", "slow", "--format", "json"]).stdout;
    let slow: Value = serde_json::from_str(&slow).expect("JSON");
    let tests = slow["tests"].as_array().expect("tests").iter();
    let names: Vec<_> =
        tests.map(|test| format!("arm/{}", test["test"].as_str().unwrap())).collect();
    assert_eq!(listed(&folder, &["--order", "slowest-first"]), names.join(" "));
}

#[test]
fn without_a_history_the_order_is_that_of_the_file() {
    let folder = folder();
    let finished = folder.rtf(&["run", "cell/arm.xml", "--order", "failed-first", "--no-history"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 0
    ----- stdout
        warning  there is no history `rtf-results/history.db`: the tests run in the order of their files
                 hint: `rtf run` creates it; `rtf history import` creates it from past runs
    suite arm  3 tests  cell/arm.xml
         passed     [TIME]  arm/a
         passed     [TIME]  arm/b
         passed     [TIME]  arm/c

    results: rtf-results/[RUN]
    PASSED  3 tests in 1 suite, [TIME]: 3 passed
    ----- stderr
    ");
    folder.file("rtf-results/history.db", "no database, but somebody's notes");
    let finished = folder.rtf(&["list", "cell/arm.xml", "--order", "slowest-first"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 0
    ----- stdout
    arm/a
    arm/b
    arm/c
    ----- stderr
    warning: the history `rtf-results/history.db` is damaged: the tests run in the order of their files
     |
     = help: move it away; `rtf history import` creates it from the journals
    ");
    let finished = folder.rtf(&["list", "cell/arm.xml", "--order", "slowest-first", "--shuffle"]);
    assert_eq!(finished.code, Some(2));
    let finished = folder.rtf(&["list", "cell/arm.xml", "--order", "slow"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: invalid value 'slow' for '--order <ORDER>'
      [possible values: file, failed-first, slowest-first]

      tip: a similar value exists: 'slowest-first'

    For more information, try '--help'.
    ");
}

/// Durations as `rtf history slow --format json` writes them.
fn durations(seconds: [f64; 3]) -> String {
    let test = |(name, median)| {
        json!({"suite_file": "cell/arm.xml", "suite": "arm", "test": name,
        "runs": 3, "median": median, "max": 9.0, "last": 1.0})
    };
    let tests: Vec<_> = ["a", "b", "c"].into_iter().zip(seconds).map(test).collect();
    json!({"version": 1, "tests": tests}).to_string()
}

#[test]
fn shards_are_balanced_by_durations_and_merge_only_if_they_are_equal() {
    let folder = folder();
    folder
        .file("one.json", &durations([5.0, 3.0, 1.0]))
        .file("two.json", &durations([1.0, 3.0, 5.0]));
    let shard = |part, file: &str| {
        let by = format!("duration={file}");
        let args = ["run", "cell/arm.xml", "--shard", part, "--shard-by", &by, "--no-history"];
        assert_eq!(folder.rtf(&args).code, Some(0));
        let run = folder.journal().record.run.expect("a start").run;
        (ran(&folder), format!("rtf-results/{run}"))
    };
    let (first, second) = (shard("1/2", "one.json"), shard("2/2", "one.json"));
    assert_eq!((first.0.as_str(), second.0.as_str()), ("a", "b c"));
    assert_eq!(folder.rtf(&["merge", &first.1, &second.1]).code, Some(0));
    let other = shard("1/2", "two.json");
    assert_eq!(other.0, "c");
    let merged = folder.rtf(&["merge", &other.1, &second.1]);
    assert_eq!(merged.code, Some(2), "{}", merged.stdout);
    assert!(merged.stderr.contains("not all of 2 parts are there"), "{}", merged.stderr);
}

#[test]
fn shards_of_one_history_have_each_test_once() {
    let folder = folder();
    folder.rtf(&["run", "cell/arm.xml"]);
    let part = |part| listed(&folder, &["--shard", part, "--shard-by", "duration=history"]);
    let mut tests: Vec<_> =
        [part("1/2"), part("2/2")].join(" ").split(' ').map(str::to_owned).collect();
    tests.sort();
    assert_eq!(tests, ["arm/a", "arm/b", "arm/c"]);
}

#[test]
fn durations_that_cannot_be_read() {
    let folder = folder();
    folder.file("empty.json", "{}");
    let shard = |by| {
        folder.shown(&folder.rtf(&["list", "cell/arm.xml", "--shard", "1/2", "--shard-by", by]))
    };
    assert_snapshot!(shard("duration=history"), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: there is no history `rtf-results/history.db`
    hint: `--shard-by hash` needs no history; all shards must use the same method
    ");
    assert_snapshot!(shard("duration=none.json"), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: cannot read durations from `none.json`: No such file or directory (os error 2)
    hint: `rtf history slow --format json > FILE.json` writes such a file
    ");
    assert_snapshot!(shard("duration=empty.json"), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: cannot read durations from `empty.json`: missing field `tests` at line 1 column 2
    hint: `rtf history slow --format json > FILE.json` writes such a file
    ");
    assert_snapshot!(shard("speed"), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: `--shard-by speed`: expected `hash`, `count`, `duration=history`, `duration=RUN` or `duration=FILE.json`
    ");
}
