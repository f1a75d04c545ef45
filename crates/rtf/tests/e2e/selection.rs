//! The selection of tests, and their order.

use std::collections::BTreeSet;

use insta::assert_snapshot;

use crate::support::{Folder, wait_until};

const PASSES: &str = "TestCase = {}\nfunction TestCase.run() end\n";
const FAILS: &str = "TestCase = {}\nfunction TestCase.run() rtf.fail('stuck at ' .. joint) end\n\
                     function TestCase.setup(args) joint = table.concat(args, ' ') end\n";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("P.lua", PASSES).file("F.lua", FAILS);
    folder.file(
        "arm.xml",
        "<suite name=\"arm\">\n  <test name=\"Limits\" tags=\"slow\">P.lua</test>\n  \
         <test name=\"Speed\" param=\"joint 3\">F.lua</test>\n  <test name=\"Rate\">P.lua</test>\n</suite>\n",
    );
    folder
}

/// The tests that the newest run has run, in order.
fn ran(folder: &Folder) -> Vec<String> {
    let record = folder.journal().record;
    record.tests.iter().map(|test| test.plan.name.clone()).collect()
}

#[test]
fn a_filter_chooses_and_the_run_says_so() {
    let folder = folder();
    let finished = folder.rtf(&["run", "-E", "tag(slow) | name(Rate)", "arm.xml"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 0
    ----- stdout
       selected  from 3 tests
    suite arm  2 tests  arm.xml
         passed     [TIME]  arm/Limits
         passed     [TIME]  arm/Rate

    results: rtf-results/[RUN]
    PASSED  2 tests in 1 suite, [TIME]: 2 passed
    ----- stderr
    ");
    assert_eq!(ran(&folder), ["Limits", "Rate"]);
}

#[test]
fn mistakes_in_filters_are_all_shown_with_those_of_the_suite() {
    let folder = folder();
    folder.file("bad.xml", "<suite>\n  <test tpye=\"lua\">P.lua</test>\n</suite>\n");
    let finished = folder.rtf(&["run", "-E", "tag(slow", "-E", "nmae(x)", "bad.xml"]);
    assert_snapshot!(folder.shown(&finished), @r#"
    exit code 2
    ----- stdout
    ----- stderr
    error: unknown attribute `tpye`
     --> bad.xml:2:9
      |
    2 |   <test tpye="lua">P.lua</test>
      |         ^^^^ not known in `<test>`
      |
      = note: `<test>` can have the attributes `name`, `type`, `param`, `cases`, `repetition`, `tags`, `timeout`, `case-timeout`, `load-timeout`, `setup-timeout`, `teardown-timeout`, `slow`, `grace`, `after-collapse`, `leaks`, `retries`, `retry-delay`, `critical`, `exclusive`, `isolation`, `middleware`, `fork`, `slots`, `max-steps`, `max-time`, `expect`, `issue`, `until`, `was`
      = help: did you mean `type`?

    error: invalid filter
     --> --filter (1):1:9
      |
    1 | tag(slow
      |    -    ^ expected `)`
      |    |
      |    opened here

    error: invalid filter
     --> --filter (2):1:1
      |
    1 | nmae(x)
      | ^^^^ there is no condition `nmae`
      |
      = help: did you mean `name`?

    3 errors; nothing was started
    "#);
}

#[test]
fn nothing_chosen_is_red() {
    let folder = folder();
    let finished = folder.rtf(&["run", "-E", "tag(slwo)", "arm.xml"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: no test selected out of 3 tests
     |
     = help: `rtf list` without these options lists all tests

    warning: no test has the tag `slwo`
     --> --filter:1:5
      |
    1 | tag(slwo)
      |     ^^^^
      |
      = help: did you mean `slow`?

    1 error and 1 warning; nothing was started
    ");
}

#[test]
fn the_list_for_programs() {
    let folder = folder();
    let finished = folder.rtf(&["list", "--format", "json", "arm.xml::Limits"]);
    assert_snapshot!(folder.shown(&finished), @r#"
    exit code 0
    ----- stdout
    {
      "tests": [
        {
          "suite": "arm",
          "name": "Limits",
          "select": "arm.xml::Limits",
          "file": "arm.xml",
          "line": 2,
          "type": "lua",
          "plugin": "[FOLDER]/P.lua",
          "tags": [
            "slow"
          ],
          "repetition": 1,
          "critical": false,
          "exclusive": false,
          "parallel": 1
        }
      ]
    }
    ----- stderr
    "#);
    let dry = folder.rtf(&["run", "--dry-run", "arm.xml::Limits"]);
    assert_eq!((dry.code, dry.stdout.as_str()), (Some(0), "arm/Limits  (#slow)\n"));
    assert!(!folder.path().join("rtf-results").exists());
}

#[test]
fn what_failed_is_run_again_with_what_it_had() {
    let folder = folder();
    let first = folder.rtf(&["run", "--shuffle=5", "arm.xml", "F.lua", "--param", "joint 9"]);
    assert_eq!(first.code, Some(1));
    let again = folder.rtf(&["run", "--rerun", "failed"]);
    assert_snapshot!(folder.shown(&again), @"
    exit code 1
    ----- stdout
       selected  from 4 tests, --shuffle=5
    suite plug-ins  1 test
         failed     [TIME]  plug-ins/F
                 failure: stuck at joint 9
                   at [FOLDER]/F.lua:2
    suite arm  1 test  arm.xml
         failed     [TIME]  arm/Speed
                 failure: stuck at joint 3
                   at [FOLDER]/F.lua:2

    tests that did not pass:
      plug-ins/F  failed
        reason  stuck at joint 9
        at      [FOLDER]/F.lua:2
        rerun   rtf run [FOLDER]/F.lua --param 'joint 9'
      arm/Speed  failed
        reason  stuck at joint 3
        at      [FOLDER]/F.lua:2
        rerun   rtf run arm.xml::Speed

    results: rtf-results/[RUN]
    FAILED  2 tests in 2 suites, [TIME]: 2 failed
    ----- stderr
    ");
    let manifest = folder.journal().record.run.expect("a run").manifest;
    assert_eq!((manifest.shuffle, manifest.param.as_deref()), (Some(5), Some("joint 9")));
    // Again, and from another folder: the rerun itself can be run again.
    let inner = folder.path().join("inner");
    std::fs::create_dir(&inner).expect("a folder");
    let mut command = folder.command(&["run", "--results", "../rtf-results", "--rerun", "failed"]);
    let output = command.current_dir(inner).output().expect("rtf runs");
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    let mut names = ran(&folder);
    names.sort();
    assert_eq!(names, ["F", "Speed"]);
    let none = folder.rtf(&["run", "--rerun", "interrupted"]);
    assert_snapshot!(folder.shown(&none), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: no test of `latest` was interrupted or skipped: nothing to rerun
    ");
}

#[test]
fn what_was_interrupted_is_run_again() {
    let folder = folder();
    let waits =
        "TestCase = {}\nfunction TestCase.run() io.open('begun', 'w'):close() rtf.sleep(60) end\n";
    folder.file("W.lua", waits);
    folder.file("s.xml", "<suite>\n  <test>P.lua</test>\n  <test>W.lua</test>\n  <test name='late'>P.lua</test>\n</suite>\n");
    let running = folder.start(&["run", "s.xml"]);
    wait_until("the test", || folder.path().join("begun").exists().then_some(()));
    running.signal("INT");
    assert_eq!(running.finish().code, Some(130));
    folder.file("W.lua", PASSES);
    let again = folder.rtf(&["run", "--rerun", "interrupted"]);
    assert_eq!(again.code, Some(0), "{}{}", again.stdout, again.stderr);
    assert_eq!(ran(&folder), ["W", "late"]);
}

#[test]
fn a_shuffled_run_tells_its_seed_and_repeats_it() {
    let folder = folder();
    let shown = folder.rtf(&["run", "--shuffle", "arm.xml"]);
    let (first, seed) =
        (ran(&folder), folder.journal().record.run.expect("a run").manifest.shuffle);
    let option = format!("--shuffle={}", seed.expect("a seed"));
    assert!(shown.stdout.starts_with(&format!("   selected  {option}\n")), "{}", shown.stdout);
    folder.rtf(&["run", &option, "arm.xml"]);
    assert_eq!(ran(&folder), first);
    let orders: BTreeSet<_> = (1..=9)
        .map(|seed| {
            folder.rtf(&["run", &format!("--shuffle={seed}"), "arm.xml"]);
            ran(&folder)
        })
        .collect();
    assert!(orders.len() > 1, "nine seeds, one order: {orders:?}");
}

#[test]
fn shards_make_up_the_whole() {
    let folder = folder();
    let mut all = Vec::new();
    for by in ["hash", "count", "duration=latest"] {
        all.clear();
        if by == "duration=latest" {
            folder.rtf(&["run", "arm.xml"]);
        }
        for part in ["1/2", "2/2"] {
            let listed = folder.rtf(&["list", "arm.xml", "--shard", part, "--shard-by", by]);
            all.extend(listed.stdout.lines().map(|line| line.split(' ').next().map(str::to_owned)));
        }
        all.sort();
        let names = ["arm/Limits", "arm/Rate", "arm/Speed"].map(|name| Some(name.to_owned()));
        assert_eq!(all, names, "by {by}");
    }
    let bad = folder.rtf(&["list", "arm.xml", "--shard", "3/2"]);
    assert_snapshot!(folder.shown(&bad), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: invalid value '3/2' for '--shard <N/OF>': there is no part 3 of 2

    For more information, try '--help'.
    ");
}
