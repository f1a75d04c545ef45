//! Errors in `rtf.toml`, with file, line and column.

use insta::assert_snapshot;

use crate::profiles::{SUITE, TOLD, folder, run};
use crate::support::Folder;

#[test]
fn every_mistake_is_told_at_its_place() {
    let folder = folder();
    folder.file(
        "rtf.toml",
        "default-profile = \"reel\"\nenviroment = \"--robot icub\"\nreports = [\"pdf=x\"]\n\
         shutdown-timeout = \"soon\"\nfork = \"sometimes\"\n\n[profile.real]\n",
    );
    folder.file("tests/arm.xml", &SUITE.replace("${param:n=3}", "${param:n}"));
    assert_snapshot!(folder.shown(&run(&folder, &["tests"], &[])), @r#"
    exit code 2
    ----- stdout
    ----- stderr
    error: the parameter `tolerance` has no value
     --> tests/arm.xml:4:45
      |
    4 |   <test param="--within ${param:tolerance}">Told.py</test>
      |                                             ^^^^^^^ needed here
      |
      = help: write it under `[param]` in `rtf.toml`, give `--set tolerance=VALUE`, or a default: `${param:tolerance=VALUE}`

    error: the parameter `n` has no value
     --> tests/arm.xml:5:55
      |
    5 |   <test name="special" param="$${param:x} ${param:n}">Told.py
      |                                                       ^^^^^^^ needed here
      |
      = help: write it under `[param]` in `rtf.toml`, give `--set n=VALUE`, or a default: `${param:n=VALUE}`

    error: there is no profile `reel`
     --> rtf.toml:1:19
      |
    1 | default-profile = "reel"
      |                   ^^^^^^
      |
      = help: did you mean `real`?

    error: unknown key `enviroment`
     --> rtf.toml:2:1
      |
    2 | enviroment = "--robot icub"
      | ^^^^^^^^^^
      |
      = note: the keys are `environment`, `env`, `param`, `timeouts`, `parallel`, `results`, `reports`, `filter`, `annotations`, `fork`, `shutdown-timeout`, `jobs`, `lock-timeout`, `retries`, `flaky-result`, `max-fail`, `order`, `history`, `quarantine`, `profile`, `default-profile`
      = help: did you mean `environment`?

    error: `reports` has to be `"FORMAT=PATH"`, where FORMAT is one of `junit`, `text`, `tap`, `code-quality`, `github`, `markdown`, `html`, `otlp`
     --> rtf.toml:3:12
      |
    3 | reports = ["pdf=x"]
      |            ^^^^^^^

    error: `shutdown-timeout` has to be a duration like `"[TIME]"`, `"2min"` or `90` (seconds)
     --> rtf.toml:4:20
      |
    4 | shutdown-timeout = "soon"
      |                    ^^^^^^

    error: `fork` has to be `"auto"` or `"always"` or `"never"`
     --> rtf.toml:5:8
      |
    5 | fork = "sometimes"
      |        ^^^^^^^^^^^

    7 errors; nothing was started
    "#);
}

#[test]
fn every_mistake_in_a_table_is_told_at_its_place() {
    let folder = folder();
    folder.file(
        "rtf.toml",
        "[env]\nRTF_CHANNEL = \"3\"\nROBOT = [1]\n\n[param]\n\"1st\" = 1\ntolerance = 1\n\n\
         [timeouts]\nscale = 0\nrnu = 3\n\n[profile.real]\nenv = 3\n",
    );
    assert_snapshot!(folder.shown(&run(&folder, &["tests"], &[])), @r#"
    exit code 2
    ----- stdout
    ----- stderr
    error: `RTF_CHANNEL` in `env` is a variable that rtf sets itself
     --> rtf.toml:2:1
      |
    2 | RTF_CHANNEL = "3"
      | ^^^^^^^^^^^

    error: `env.ROBOT` has to be a text, a number, `true` or `false`
     --> rtf.toml:3:9
      |
    3 | ROBOT = [1]
      |         ^^^

    error: `1st` in `param` is not the name of a parameter: letters, digits, `-` and `_`, a letter first
     --> rtf.toml:6:1
      |
    6 | "1st" = 1
      | ^^^^^

    error: `timeouts.scale` has to be a number above 0, up to 1000
      --> rtf.toml:10:9
       |
    10 | scale = 0
       |         ^

    error: unknown key `timeouts.rnu`
      --> rtf.toml:11:1
       |
    11 | rnu = 3
       | ^^^
       |
       = note: the keys are `load`, `setup`, `run`, `teardown`, `slow`, `grace`, `fixture-setup`, `fixture-check`, `fixture-teardown`, `hook`, `suite`, `scale`
       = help: did you mean `timeouts.run`?

    error: `env` has to be a table
      --> rtf.toml:14:7
       |
    14 | env = 3
       |       ^

    6 errors; nothing was started
    "#);
}

#[test]
fn what_is_no_toml_is_told() {
    let folder = folder();
    folder.file("rtf.toml", "environment = \"open\nx =\n");
    assert_snapshot!(folder.shown(&folder.rtf(&["check", "tests"])), @r#"
    exit code 2
    ----- stdout
    ----- stderr
    error: not TOML: invalid basic string, expected `"`
     --> rtf.toml:1:20
      |
    1 | environment = "open
      |                    ^

    error: unknown key `x`
     --> rtf.toml:2:1
      |
    2 | x =
      | ^
      |
      = note: the keys are `environment`, `env`, `param`, `timeouts`, `parallel`, `results`, `reports`, `filter`, `annotations`, `fork`, `shutdown-timeout`, `jobs`, `lock-timeout`, `retries`, `flaky-result`, `max-fail`, `order`, `history`, `quarantine`, `profile`, `default-profile`

    error: not TOML: string values must be quoted, expected literal string
     --> rtf.toml:2:4
      |
    2 | x =
      |    ^

    3 errors; nothing was started
    "#);
    assert_snapshot!(folder.shown(&folder.rtf(&["show"])), @r#"
    exit code 2
    ----- stdout
    ----- stderr
    error: not TOML: invalid basic string, expected `"`
     --> rtf.toml:1:20
      |
    1 | environment = "open
      |                    ^

    error: not TOML: string values must be quoted, expected literal string
     --> rtf.toml:2:4
      |
    2 | x =
      |    ^

    error: unknown key `x`
     --> rtf.toml:2:1
      |
    2 | x =
      | ^
      |
      = note: the keys are `environment`, `env`, `param`, `timeouts`, `parallel`, `results`, `reports`, `filter`, `annotations`, `fork`, `shutdown-timeout`, `jobs`, `lock-timeout`, `retries`, `flaky-result`, `max-fail`, `order`, `history`, `quarantine`, `profile`, `default-profile`

    3 errors; nothing was started
    "#);
}

#[test]
fn a_profile_that_there_is_not() {
    let folder = folder();
    assert_snapshot!(folder.shown(&run(&folder, &["tests", "--profile", "reel"], &[])), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: there is no profile `reel`
     |
     = note: searched rtf.toml
     = help: did you mean `real`?

    1 error; nothing was started
    ");
    assert_snapshot!(folder.shown(&run(&folder, &["tests", "--profile", "lab"], &[])), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: there is no profile `lab`
     |
     = note: searched rtf.toml
     = help: the profiles are `real`, `sim`

    1 error; nothing was started
    ");
    let other = Folder::new();
    other.file("T.lua", "TestCase = {}\nfunction TestCase.run() end\n");
    assert_snapshot!(other.shown(&run(&other, &["T.lua", "--profile", "real"], &[])), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: there is no profile `real`
     |
     = help: define profiles in an `rtf.toml` next to the suites, or above them

    1 error; nothing was started
    ");
}

/// `${param:…}` in a suite that no `rtf.toml` goes with.
#[test]
fn a_parameter_that_nobody_sets() {
    let folder = folder();
    std::fs::remove_file(folder.path().join("rtf.toml")).expect("a file");
    assert_snapshot!(folder.shown(&folder.rtf(&["check", "tests"])), @r#"
    exit code 2
    ----- stdout
    ----- stderr
    error: the parameter `tolerance` has no value
     --> tests/arm.xml:4:45
      |
    4 |   <test param="--within ${param:tolerance}">Told.py</test>
      |                                             ^^^^^^^ needed here
      |
      = help: write it under `[param]` in `rtf.toml`, give `--set tolerance=VALUE`, or a default: `${param:tolerance=VALUE}`

    1 error; nothing was started
    "#);
    assert_eq!(folder.rtf(&["check", "tests", "--set", "tolerance=1"]).code, Some(0));
    assert_snapshot!(folder.shown(&folder.rtf(&["check", "tests", "--set", "1=1"])), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: invalid value '1=1' for '--set <NAME=VALUE>': `1` is not the name of a parameter

    For more information, try '--help'.
    ");
}

#[test]
fn two_files_cannot_both_decide_over_one_run() {
    let folder = folder();
    folder.file("a/rtf.toml", "results = \"runs\"\n").file("b/rtf.toml", "\nresults = \"runs\"\n");
    for name in ["a", "b"] {
        folder.file(&format!("{name}/Told.py"), TOLD);
    }
    assert_snapshot!(folder.shown(&run(&folder, &["a/Told.py", "b/Told.py"], &[])), @r#"
    exit code 2
    ----- stdout
    ----- stderr
    error: `results` applies to the whole run, and two files set it
     --> a/rtf.toml:1:1
      |
    1 | results = "runs"
      | ^^^^^^^
      |
     ::: b/rtf.toml:2:1
      |
    2 | results = "runs"
      | -------
      |
      = help: run the suites one after the other, or set it in one file above both

    1 error; nothing was started
    "#);
}
