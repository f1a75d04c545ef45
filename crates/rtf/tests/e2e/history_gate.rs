//! `rtf history gate`: is a run worse than those of the default branch?

use insta::assert_snapshot;
use serde_json::Value;

use crate::support::{Finished, Folder};

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file(".git/HEAD", "ref: refs/heads/main\n");
    folder.file(".git/refs/heads/main", "0123456789abcdef0123456789abcdef01234567\n");
    folder.file(".git/refs/heads/arm", "1123456789abcdef0123456789abcdef01234567\n");
    folder.file(
        "arm.xml",
        "<suite name='arm'><test name='a|*b*'>M.lua</test><test name='Stops'>S.lua</test></suite>",
    );
    folder.file("S.lua", "TestCase = {}\nfunction TestCase.run() end\n");
    folder
}

/// Runs on a branch with a value of `lag`; the other test fails with `stops`.
fn run(folder: &Folder, branch: &str, lag: f64, stops: Option<&str>) {
    folder.file(".git/HEAD", &format!("ref: refs/heads/{branch}\n"));
    folder.file(
        "M.lua",
        &format!("TestCase = {{}}\nfunction TestCase.run() rtf.measure('lag', {lag}, 'ms', nil, 50) end\n"),
    );
    let body = stops.map_or(String::new(), |reason| format!("rtf.fail('{reason}')"));
    folder.file("S.lua", &format!("TestCase = {{}}\nfunction TestCase.run() {body} end\n"));
    folder.rtf(&["run", "arm.xml"]);
}

fn gate(folder: &Folder, args: &[&str]) -> Finished {
    folder.rtf(&[&["history", "gate"], args].concat())
}

#[test]
fn a_run_that_is_worse_fails_the_gates() {
    let folder = folder();
    for _ in 0..3 {
        run(&folder, "main", 10.0, None);
    }
    run(&folder, "arm", 10.5, None);
    let all = ["--max-new-failures", "0", "--max-flaky", "2%", "--no-regression", "lag>10%"];
    let shown = |args: &[&str]| folder.shown(&gate(&folder, &[&all, args].concat()));
    assert_snapshot!(shown(&[]), @"
    exit code 0
    ----- stdout
    run [RUN] with 2 tests, compared with 3 runs
    passed  0 new failures, at most 0 allowed
    passed  0 of 2 tests flaky: 0 %, at most 2 % allowed
    passed  lag: 0 regressions in 1 test, a change for the worse of 10 % allowed
    ----- stderr
    ");
    run(&folder, "arm", 30.0, Some("it | <b>slips</b>\\n@team"));
    assert_snapshot!(shown(&[]), @"
    exit code 1
    ----- stdout
    run [RUN] with 2 tests, compared with 3 runs
    FAILED  1 new failure, at most 0 allowed
      arm/Stops  failed: it | <b>slips</b> (passed in [RUN])
    passed  0 of 2 tests flaky: 0 %, at most 2 % allowed
    FAILED  lag: 1 regression in 1 test, a change for the worse of 10 % allowed
      arm/a|*b*  [TIME] → [TIME] (+200 %), median of 3 runs, higher is worse
    ----- stderr
    ");
    assert_snapshot!(shown(&["--format", "markdown"]), @"
    exit code 1
    ----- stdout
    ## Robot tests: gates failed

    run [RUN] with 2 tests, compared with 3 runs

    | gate | result |
    |---|---|
    | 1 new failure, at most 0 allowed | **failed** |
    | 0 of 2 tests flaky: 0 %, at most 2 % allowed | passed |
    | lag: 1 regression in 1 test, a change for the worse of 10 % allowed | **failed** |

    ### 1 new failure, at most 0 allowed

    - <code>arm/Stops</code>: failed: it &#124; &#60;b&#62;slips&#60;/b&#62; (passed in [RUN])

    ### lag: 1 regression in 1 test, a change for the worse of 10 % allowed

    - <code>arm/a&#124;&#42;b&#42;</code>: [TIME] → [TIME] (+200 %), median of 3 runs, higher is worse
    ----- stderr
    ");
    let json = gate(&folder, &[&all[..], &["--format", "json"]].concat());
    let json: Value = serde_json::from_str(&json.stdout).expect("JSON");
    assert_eq!((&json["version"], &json["gate"]["passed"]), (&1.into(), &false.into()));
    assert_eq!(json["gate"]["new_failures"]["tests"][0]["test"], "Stops");
    assert_eq!(json["gate"]["no_regression"][0]["series"][0]["change"], 2.0);
    each_gate(&folder, &all);
}

/// Each gate by itself, with other limits, and for the run before, which has passed.
fn each_gate(folder: &Folder, all: &[&str]) {
    for (args, code) in [
        (&["--max-new-failures", "0"], 1),
        (&["--max-new-failures", "1"], 0),
        (&["--no-regression", "lag>200%"], 0),
        (&["--no-regression", "lag>-10%"], 0),
        (&["--no-regression", "lag>199%"], 1),
    ] {
        assert_eq!(gate(folder, args).code, Some(code), "{args:?}");
    }
    let filtered = ["--max-new-failures", "0", "-E", "!name(Stops)"];
    assert_eq!(gate(folder, &filtered).code, Some(0));
    let runs = folder.rtf(&["history", "runs", "--format", "json"]).stdout;
    let runs: Value = serde_json::from_str(&runs).expect("JSON");
    let before = runs["runs"][1]["name"].as_str().expect("a name");
    assert_eq!(gate(folder, &[&[before], all].concat()).code, Some(0));
}

#[test]
fn a_short_baseline_is_not_judged() {
    let folder = folder();
    run(&folder, "main", 10.0, None);
    run(&folder, "arm", 30.0, None);
    assert_snapshot!(folder.shown(&gate(&folder, &["--no-regression", "lag>10%"])), @"
    exit code 0
    ----- stdout
    run [RUN] with 2 tests, compared with 1 run
    passed  lag: 0 regressions in 0 tests, a change for the worse of 10 % allowed
      not judged: arm/a|*b*: 1 green baseline run on the same robot, 3 are needed
    ----- stderr
    ");
}

#[test]
fn a_run_that_did_not_finish_fails() {
    let folder = folder();
    run(&folder, "main", 10.0, None);
    run(&folder, "arm", 10.0, None);
    let journal = folder.path().join("rtf-results/latest/events.jsonl");
    let text = std::fs::read_to_string(&journal).expect("a journal");
    let (before, _end) = text.trim_end().rsplit_once('\n').expect("many lines");
    std::fs::write(&journal, format!("{before}\n")).expect("it is shortened");
    std::fs::remove_file(folder.path().join("rtf-results/history.db")).expect("a history");
    folder.rtf(&["history", "import", "rtf-results"]);
    assert_snapshot!(folder.shown(&gate(&folder, &["--max-new-failures", "0"])), @"
    exit code 1
    ----- stdout
    run [RUN] with 2 tests, compared with 1 run
    FAILED  the run did not finish: its journal has no end
    passed  0 new failures, at most 0 allowed
    ----- stderr
    ");
}

#[test]
fn what_cannot_be_judged() {
    let folder = folder();
    let shown = |args: &[&str]| folder.shown(&gate(&folder, args));
    assert_snapshot!(shown(&["--max-new-failures", "0"]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: there is no history `rtf-results/history.db`
    hint: `rtf run` creates it; `rtf history import` creates it from past runs
    ");
    run(&folder, "arm", 10.0, None);
    assert_snapshot!(shown(&["--max-new-failures", "0"]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: the history has no run of the default branch
    hint: name the runs to compare with: `--baseline branch:NAME`
    ");
    let baseline = ["--max-new-failures", "0", "--baseline", "branch:devel"];
    assert_snapshot!(shown(&baseline), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: `branch:devel` has no run without a profile before `[RUN]`
    hint: run the tests there first, import their results (`rtf history import`), or name another `--baseline`
    ");
    let unknown = ["--no-regression", "leg>10%", "--baseline", "branch:arm"];
    run(&folder, "arm", 10.0, None);
    assert_snapshot!(shown(&unknown), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: the history has no measurement or signal `leg`
    hint: measurements and signals of the history: lag
    ");
}

#[test]
fn mistakes_in_gates() {
    let folder = folder();
    run(&folder, "arm", 10.0, None);
    let shown = |args: &[&str]| folder.shown(&gate(&folder, args));
    assert_snapshot!(shown(&["none", "--max-flaky", "2%"]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: no run of the history matches `none`
    hint: `rtf history runs` lists the runs
    ");
    assert_snapshot!(shown(&[]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: the following required arguments were not provided:
      <--max-new-failures <N>|--max-flaky <PERCENT>|--no-regression <MEASUREMENT>PERCENT>>

    Usage: rtf history gate <--max-new-failures <N>|--max-flaky <PERCENT>|--no-regression <MEASUREMENT>PERCENT>> [RUN]

    For more information, try '--help'.
    ");
    assert_snapshot!(shown(&["--max-flaky", "2"]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: invalid value '2' for '--max-flaky <PERCENT>': expected a share such as `2%`

    For more information, try '--help'.
    ");
    assert_snapshot!(shown(&["--no-regression", "lag<10%"]), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: invalid value 'lag<10%' for '--no-regression <MEASUREMENT>PERCENT>': expected a measurement and a change such as `lag>10%`, `lag>+10%` (only a rise) or `lag>-10%` (only a fall), got `lag<10%`

    For more information, try '--help'.
    ");
}
