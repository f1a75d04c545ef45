//! Runs are imported when they end, and `rtf history` answers questions about them.

use insta::assert_snapshot;
use serde_json::Value;

use crate::support::{Folder, wait_until};

const PASSES: &str =
    "TestCase = {}\nfunction TestCase.run() rtf.measure('lag', 12.5, 'ms', nil, 20) end\n";
const FAILS: &str =
    "TestCase = {}\nfunction TestCase.run() rtf.measure('lag', 25, 'ms', nil, 20) end\n";

pub fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("Moves.lua", PASSES);
    folder.file("Stops.lua", "TestCase = {}\nfunction TestCase.run() end\n");
    folder.file(
        "arm.xml",
        "<suite name=\"arm\" requires=\"robot:icub\">\n  <test tags=\"smoke\">Moves.lua</test>\n  \
         <test>Stops.lua</test>\n</suite>\n",
    );
    // A commit is enough for `rtf`.
    folder.file(".git/HEAD", "ref: refs/heads/main\n");
    folder.file(".git/refs/heads/main", "0123456789abcdef0123456789abcdef01234567\n");
    folder
}

pub fn rtf(folder: &Folder, args: &[&str]) -> crate::support::Finished {
    let mut command = folder.command(args);
    // The locks of this machine are those of other tests, too.
    command.env("RTF_LOCKS", folder.path().join("locks")).env("TZ", "UTC");
    crate::support::Finished::of(command.output().expect("rtf runs"))
}

pub fn json(folder: &Folder, args: &[&str]) -> Value {
    let finished = rtf(folder, &[&["history"], args, &["--format", "json"]].concat());
    assert_eq!(finished.code, Some(0), "{}", finished.stderr);
    let value: Value = serde_json::from_str(&finished.stdout).expect("JSON");
    assert_eq!(value["version"], 1);
    value
}

pub fn shown(folder: &Folder, args: &[&str]) -> String {
    let finished = rtf(folder, &[&["history"], args].concat());
    let text = folder.shown(&finished);
    let host = rustix::system::uname().nodename().to_string_lossy().into_owned();
    let text = text.replace(&format!(", {host}\n"), ", [HOST]\n");
    let time = regex::Regex::new(r"\d{4}-\d\d-\d\d \d\d:\d\d").expect("a pattern");
    let bars = regex::Regex::new("duration   [▁-█]+").expect("a pattern");
    bars.replace_all(&time.replace_all(&text, "[START]"), "duration   [BARS]").into_owned()
}

#[test]
fn runs_and_the_history_of_a_test() {
    let folder = folder();
    assert_eq!(rtf(&folder, &["run", "arm.xml"]).code, Some(0));
    folder.file("Moves.lua", FAILS);
    assert_eq!(rtf(&folder, &["run", "arm.xml", "--set", "speed=2"]).code, Some(1));
    assert_snapshot!(shown(&folder, &["runs"]), @"
    exit code 0
    ----- stdout
    [START]  red    [RUN]  1 passed, 1 failed  [TIME]  main, 01234567, [HOST]
    [START]  green  [RUN]  2 passed  [TIME]  main, 01234567, [HOST]
    ----- stderr
    ");
    assert_snapshot!(shown(&folder, &["show", "arm/Moves"]), @"
    exit code 0
    ----- stdout
    arm/Moves  (arm.xml)
      results    1 passed, 1 failed
      verdicts   .F  (. passed, F failed; the newest last)
      duration   [BARS]  [TIME] … [TIME], last [TIME]
      lag        ▁█  [TIME] … [TIME], last [TIME], limit ≤ [TIME]
      last problem  [START]  failed: `lag` is [TIME], its limits are ≤ 20  ([RUN])
    ----- stderr
    ");
    assert_snapshot!(shown(&folder, &["flaky"]), @"
    exit code 0
    ----- stdout
    no flaky tests
    compared if the sources of a test are equal (suite, plug-ins, their modules), without a commit or with uncommitted changes: 2 runs
    ----- stderr
    ");
    assert_snapshot!(shown(&folder, &["trend", "lag"]), @"
    exit code 0
    ----- stdout
    arm/Moves  lag
      ▁█
      [TIME] … [TIME], last [TIME], limit ≤ [TIME], 2 runs since [START]
    ----- stderr
    ");
    assert_snapshot!(shown(&folder, &["changes"]), @"
    exit code 0
    ----- stdout
    no changes
    ----- stderr
    ");

    let runs = json(&folder, &["runs"]);
    let run = &runs["runs"][0];
    assert_eq!(run["commit"], "0123456789abcdef0123456789abcdef01234567");
    assert_eq!((&run["branch"], &run["green"]), (&"main".into(), &false.into()));
    assert_eq!(run["tests"], serde_json::json!({"passed": 1, "failed": 1}));
    assert_eq!(run["parameters"], serde_json::json!(["speed=2"]));
    assert!(run["cpus"].as_u64().is_some_and(|cpus| cpus > 0), "{run}");
    let tests = json(&folder, &["show", "arm/Moves", "--robot", "robot:icub"]);
    let results = tests["tests"][0]["results"].as_array().expect("results").clone();
    let hash = |index: usize| results[index]["plugin_hash"].as_str().expect("a hash").to_owned();
    assert_ne!(hash(0), hash(1), "the plug-in was changed");
}

#[test]
fn a_test_that_fails_in_some_repetitions_is_flaky() {
    let folder = Folder::new();
    folder.file(
        "Odd.lua",
        "TestCase = {}\nfunction TestCase.run()\n  local file = io.open('runs', 'a')\n  \
         file:write('x')\n  local count = file:seek('end')\n  file:close()\n  \
         rtf.check(count % 2 == 1, 'odd')\nend\n",
    );
    assert_eq!(rtf(&folder, &["run", "Odd.lua", "--repeat", "4"]).code, Some(1));
    assert_snapshot!(shown(&folder, &["flaky"]), @"
    exit code 0
    ----- stdout
    plug-ins/Odd
      1 flip in 1 pair of comparable results: 100 % (21 % … 100 %)
      1 passed, 1 failed
      last problem  [START]  failed: odd  ([RUN])
    compared if the sources of a test are equal (suite, plug-ins, their modules), without a commit or with uncommitted changes: 1 run
    ----- stderr
    ");
}

#[test]
fn no_history_is_made_where_it_is_not_wanted() {
    let folder = folder();
    assert_eq!(rtf(&folder, &["run", "arm.xml", "--no-history"]).code, Some(0));
    folder.file("rtf.toml", "[history]\nenabled = false\n");
    assert_eq!(rtf(&folder, &["run", "arm.xml"]).code, Some(0));
    assert!(!folder.path().join("rtf-results/history.db").exists());
    folder.file("rtf.toml", "[history]\nurl = \"there/team.db\"\n");
    assert_eq!(rtf(&folder, &["run", "arm.xml"]).code, Some(0));
    assert!(folder.path().join("there/team.db").exists());
    let runs = json(&folder, &["runs"])["runs"].as_array().map(Vec::len);
    assert_eq!(runs, Some(3), "earlier runs are imported, too");
    let other = rtf(&folder, &["history", "runs", "--history", "mysql://me:secret@host/db"]);
    assert_eq!(other.code, Some(2));
    assert!(!other.stderr.contains("secret"), "{}", other.stderr);
}

#[test]
fn a_history_that_cannot_be_written_changes_no_exit_code() {
    let folder = folder();
    folder.file("rtf-results/history.db", "no database, but somebody's notes");
    let finished = rtf(&folder, &["run", "arm.xml"]);
    assert_eq!(finished.code, Some(0), "{}", finished.stderr);
    assert_snapshot!(folder.redact(&finished.stderr), @"warning: the run was not imported into the history: the history `rtf-results/history.db` is damaged: file is not a database (move it away; `rtf history import` creates it from the journals)");
    assert_snapshot!(shown(&folder, &["runs"]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: the history `rtf-results/history.db` is damaged
    caused by: file is not a database
    caused by: Error code 26: file is not a database
    hint: move it away; `rtf history import` creates it from the journals
    ");
    std::fs::remove_file(folder.path().join("rtf-results/history.db")).expect("a file");
    let finished = rtf(&folder, &["run", "arm.xml"]);
    assert_eq!((finished.code, finished.stderr.as_str()), (Some(0), ""));
    assert_eq!(json(&folder, &["runs"])["runs"].as_array().map(Vec::len), Some(2));
}

#[test]
fn a_question_without_a_history() {
    let folder = folder();
    assert_snapshot!(shown(&folder, &["runs"]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: there is no history `rtf-results/history.db`
    hint: `rtf run` creates it; `rtf history import` creates it from past runs
    ");
    assert_snapshot!(shown(&folder, &["import"]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: there are no runs and no campaigns in `rtf-results`
    hint: name a results directory, a directory of a run or campaign, or a journal
    ");
}

#[test]
fn questions_about_nothing() {
    let folder = folder();
    rtf(&folder, &["run", "arm.xml"]);
    assert_snapshot!(shown(&folder, &["show", "arm/Mves"]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: the history has no test `arm/Mves`
    hint: tests of the history: arm/Moves, arm/Stops
    ");
    assert_snapshot!(shown(&folder, &["trend", "lagg"]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: no selected test has a measurement or signal `lagg`
    hint: measurements and signals of the history: lag
    ");
    assert_snapshot!(shown(&folder, &["compare", "latest", "branch:none"]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: no run of the history matches `branch:none`
    hint: `rtf history runs` lists the runs
    ");
    assert_snapshot!(shown(&folder, &["slow", "-E", "case(a)"]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: the history cannot be filtered by `case(…)`
    hint: name the case: `SUITE/TEST::CASE`
    ");
    assert_snapshot!(shown(&folder, &["slow", "-E", "tag("]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: invalid filter
     --> --filter:1:5
      |
    1 | tag(
      |     ^ expected a tag

    ");
    assert_snapshot!(shown(&folder, &["runs", "--since", "soon"]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: `soon` is neither a date nor a time span
    hint: write `2026-11-01`, `30d` or `12h`
    ");
}

#[test]
fn the_history_is_made_again_from_the_journals() {
    let folder = folder();
    for _ in 0..3 {
        rtf(&folder, &["run", "arm.xml"]);
    }
    let export = || rtf(&folder, &["history", "export", "--format", "json"]).stdout;
    let before = export();
    for name in ["history.db", "history.db-wal", "history.db-shm"] {
        drop(std::fs::remove_file(folder.path().join("rtf-results").join(name)));
    }
    assert_snapshot!(shown(&folder, &["import"]), @"
    exit code 0
    ----- stdout
    3 runs imported
    ----- stderr
    ");
    assert_snapshot!(shown(&folder, &["import", "rtf-results"]), @"
    exit code 0
    ----- stdout
    0 runs imported, 3 already there
    ----- stderr
    ");
    assert_eq!(export(), before);
    assert_snapshot!(shown(&folder, &["prune", "--keep", "2", "--dry-run"]), @"
    exit code 0
    ----- stdout
    [START]  green  [RUN]  2 passed  [TIME]  main, 01234567, [HOST]
    1 run would be removed
    ----- stderr
    ");
    assert_eq!(
        json(&folder, &["prune", "--keep", "1"])["removed"].as_array().map(Vec::len),
        Some(2)
    );
    let doctor = json(&folder, &["doctor"]);
    let checks = &doctor["checks"];
    assert_eq!((&checks["runs"], &checks["pruned"]), (&1.into(), &2.into()));
    assert_eq!(
        (&checks["problems"], &checks["missing"]),
        (&Value::Array(vec![]), &Value::Array(vec![]))
    );
}

#[test]
fn a_run_whose_runner_was_killed_is_imported() {
    let folder = folder();
    folder.file(
        "Waits.py",
        "import rtf\nclass Waits(rtf.TestCase):\n    def run(self):\n        self.sleep(60)\n",
    );
    folder.file("waits.xml", "<suite name='waits'><test type='python'>Waits</test></suite>");
    let running = folder.start(&["run", "waits.xml"]);
    running.wait_for(|event| matches!(event, rtf_model::EventKind::TestPhase { .. }));
    running.kill_runner();
    assert_eq!(running.finish().code, Some(5));
    let runs = json(&folder, &["runs"]);
    assert_eq!(runs["runs"][0]["end"], "died");
    assert_eq!(runs["runs"][0]["tests"], serde_json::json!({"interrupted": 1}));
}

#[test]
fn an_active_run_is_not_imported() {
    let folder = folder();
    folder.file(
        "Waits.py",
        "import rtf\nclass Waits(rtf.TestCase):\n    def run(self):\n        self.sleep(60)\n",
    );
    folder.file("waits.xml", "<suite name='waits'><test type='python'>Waits</test></suite>");
    let running = folder.start(&["run", "waits.xml"]);
    running.wait_for(|event| matches!(event, rtf_model::EventKind::TestPhase { .. }));
    let imported = json(&folder, &["import"]);
    assert_eq!(imported["imported"]["active"].as_array().map(Vec::len), Some(1));
    running.signal("INT");
    assert_eq!(running.finish().code, Some(130));
    wait_until("the run", || {
        (json(&folder, &["runs"])["runs"].as_array().map(Vec::len) == Some(1)).then_some(())
    });
    assert_eq!(json(&folder, &["runs"])["runs"][0]["end"], "interrupted");
}

#[test]
fn a_renamed_test_continues_its_history() {
    let folder = folder();
    rtf(&folder, &["run", "arm.xml"]);
    folder.file(
        "arm.xml",
        "<suite name=\"arm\"><test name=\"Lifts\" was=\"Moves\">Moves.lua</test></suite>\n",
    );
    rtf(&folder, &["run", "arm.xml"]);
    let found = json(&folder, &["show", "arm/Lifts"]);
    assert_eq!(found["tests"][0]["results"].as_array().map(Vec::len), Some(2));
    assert_eq!(found["tests"][0]["former_names"], serde_json::json!(["Moves"]));
}
