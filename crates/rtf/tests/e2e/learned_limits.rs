//! Limits of measurements that are learned from the history.

use insta::assert_snapshot;

use crate::support::Folder;

fn folder(learn: &str) -> Folder {
    let folder = Folder::new();
    folder.file(".git/HEAD", "ref: refs/heads/main\n");
    folder.file(".git/refs/heads/main", "0123456789abcdef0123456789abcdef01234567\n");
    folder.file(".git/refs/heads/arm", "1123456789abcdef0123456789abcdef01234567\n");
    let test = format!("  <test>M.lua {learn}</test>\n");
    folder.file("arm.xml", &format!("<suite name='arm' middleware='shared'>\n{test}</suite>\n"));
    folder
}

/// Runs with these values of `lag`.
fn run(folder: &Folder, values: &[f64]) -> crate::support::Finished {
    let measure = |value| format!("rtf.measure('lag', {value}, 'ms')");
    let body: Vec<_> = values.iter().map(measure).collect();
    let text = format!("TestCase = {{}}\nfunction TestCase.run() {} end\n", body.join(" "));
    folder.file("M.lua", &text);
    folder.rtf(&["run", "arm.xml", "--report", "junit=out/junit.xml", "--verbose"])
}

#[test]
fn limits_are_learned_and_judge_the_next_run() {
    let folder = folder("<learn measurement='lag' min-runs='3' limits='high'/>");
    let reasons = ["there is no history", "has 1 green run", "has 2 green runs"];
    for (value, reason) in [10.0, 11.0, 12.0].into_iter().zip(reasons) {
        let finished = run(&folder, &[value]);
        assert_eq!(finished.code, Some(0), "{}", finished.stdout);
        assert!(finished.stdout.contains(reason), "{}", finished.stdout);
        assert!(!finished.stdout.contains("within learned"), "{}", finished.stdout);
    }
    // Median 11, MAD 1: 11 + 4 · 1.4826 = 16.93.
    let finished = run(&folder, &[16.9]);
    assert_eq!(finished.code, Some(0), "{}", finished.stdout);
    assert!(finished.stdout.contains("within learned ≤ 16.9304"), "{}", finished.stdout);
    let finished = run(&folder, &[-99.0, 17.5]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 1
    ----- stdout
    suite arm  1 test  arm.xml
          start  arm/M
         set-up  arm/M
            run  arm/M
                 arm/M: measured lag = -[TIME], within learned ≤ 17.4304 at [FOLDER]/M.lua:2
                 arm/M: measured lag = [TIME], outside learned ≤ 17.430408874022408 at [FOLDER]/M.lua:2
      tear-down  arm/M
         failed     [TIME]  arm/M
                 measured lag = [TIME], outside learned ≤ 17.430408874022408 at [FOLDER]/M.lua:2

    tests that did not pass:
      arm/M  failed
        reason  `lag` is [TIME], its learned limits are ≤ 17.430408874022408
        at      [FOLDER]/M.lua:2
        rerun   rtf run arm.xml::M

    results: rtf-results/[RUN]
    FAILED  1 test in 1 suite, [TIME]: 1 failed
    ----- stderr
    ");
    let junit = std::fs::read_to_string(folder.path().join("out/junit.xml")).expect("a report");
    assert!(junit.contains("17.5 ms (learned: ≤ 17.4304"), "{junit}");

    // The journal alone explains the verdict.
    let record = folder.journal().record;
    let learned = &record.tests[0].plan.learned[0];
    assert_eq!((learned.runs, learned.low, learned.unit.as_str()), (4, None, "ms"));
    let measured = &record.tests[0].attempts[0].measurements;
    assert!(measured.iter().all(|it| it.learned && it.high == learned.high), "{measured:?}");
    let shown = folder.rtf(&["show"]);
    assert_eq!(shown.code, Some(1));
    assert!(shown.stdout.contains("its learned limits are"), "{}", shown.stdout);
}

#[test]
fn runs_of_another_branch_teach_nothing() {
    let folder = folder("<learn measurement='lag' min-runs='3'/>");
    folder.file(".git/HEAD", "ref: refs/heads/arm\n");
    for value in [10.0, 10.0, 10.0, 99.0] {
        assert_eq!(run(&folder, &[value]).code, Some(0));
    }
}

#[test]
fn values_that_did_not_vary_may_not_change() {
    let folder = folder("<learn measurement='lag' min-runs='3'/>");
    for value in [10.0, 10.0, 10.0, 10.000_000_001] {
        let finished = run(&folder, &[value]);
        assert_eq!(finished.code, Some(0), "{}", finished.stdout);
    }
    assert_eq!(run(&folder, &[10.1]).code, Some(1));
}

#[test]
fn a_history_that_cannot_be_read_judges_nothing() {
    let folder = folder("<learn measurement='lag' min-runs='3'/>");
    for value in [10.0, 10.0, 10.0] {
        run(&folder, &[value]);
    }
    folder.file("rtf-results/history.db", "no database");
    let finished = run(&folder, &[99.0]);
    assert_eq!(finished.code, Some(0), "{}", finished.stdout);
    assert!(
        finished.stdout.contains("is damaged: measurements with learned limits are not judged"),
        "{}",
        finished.stdout
    );
}

#[test]
fn limits_are_frozen_at_a_change_until_it_is_accepted() {
    let folder = folder("<learn measurement='lag' min-runs='3'/>");
    folder.file("arm.xml", &format!("\u{feff}{}", folder.read("arm.xml")));
    for value in [10.0, 10.1, 9.9, 10.0, 10.1] {
        assert_eq!(run(&folder, &[value]).code, Some(0));
    }
    for value in [15.0, 15.1, 14.9] {
        assert_eq!(run(&folder, &[value]).code, Some(1), "outside of the learned limits");
    }
    let finished = run(&folder, &[15.0]);
    assert_eq!(finished.code, Some(1));
    assert_snapshot!(warnings(&folder, &finished), @"
    exit code 1
    ----- stdout
        warning  `lag` of `arm/M` has changed in the run [RUN]: its limits are learned from the 5 runs before it
                 hint: if the change is intended: `rtf history accept arm.xml`
    ");

    let accept = |args: &[&str]| {
        let args = [&["history", "accept", "arm.xml"], args].concat();
        folder.shown(&folder.rtf(&args))
    };
    assert_snapshot!(accept(&["--measurement", "leg"]), @r#"
    exit code 2
    ----- stdout
    ----- stderr
    error: no selected test has `<learn measurement="leg"/>`
    hint: `rtf history accept --dry-run` lists the changes
    "#);
    let suite = folder.read("arm.xml");
    assert_snapshot!(accept(&["--dry-run"]), @"
    exit code 0
    ----- stdout
    arm.xml: arm/M: `lag` since [RUN]
    1 change would be accepted
    ----- stderr
    ");
    assert_eq!(folder.read("arm.xml"), suite);
    assert_snapshot!(accept(&["--measurement", "lag"]), @"
    exit code 0
    ----- stdout
    arm.xml: arm/M: `lag` since [RUN]
    1 change accepted
    ----- stderr
    ");
    let suite = folder.read("arm.xml");
    assert!(suite.contains("<learn measurement='lag' min-runs='3' since=\"20"), "{suite}");

    for value in [15.0, 15.1, 14.9] {
        let finished = run(&folder, &[value]);
        assert_eq!(finished.code, Some(0), "not judged: {}", finished.stdout);
    }
    assert_eq!(run(&folder, &[10.0]).code, Some(1), "now the old value is outside");
    assert_eq!(run(&folder, &[15.0]).code, Some(0));
    assert_snapshot!(accept(&[]), @"
    exit code 0
    ----- stdout
    0 changes accepted
    ----- stderr
    ");
}

/// The warnings of a run, without the rest of the console.
fn warnings(folder: &Folder, finished: &crate::support::Finished) -> String {
    let shown = folder.shown(finished);
    let end = shown.find("suite arm").expect("a suite");
    shown[..end].to_owned()
}

#[test]
fn mistakes_in_learn() {
    let folder = folder(
        "\n<learn/><learn measurement='lag' min-runs='2' sigma='-1' limits='up' since='today'/>\n\
         <learn measurement='lag'/>",
    );
    folder.file("M.lua", "TestCase = {}\nfunction TestCase.run() end\n");
    assert_snapshot!(folder.shown(&folder.rtf(&["check", "arm.xml"])), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: `<learn>` needs the attribute `measurement`
     --> arm.xml:3:1
      |
    3 | <learn/><learn measurement='lag' min-runs='2' sigma='-1' limits='up' since='today'/>
      | ^^^^^^

    error: `min-runs` is not a whole number from 3 to 1000000: `2`
     --> arm.xml:3:44
      |
    3 | <learn/><learn measurement='lag' min-runs='2' sigma='-1' limits='up' since='today'/>
      |                                            ^

    error: `sigma` is not a number of deviations: `-1`
     --> arm.xml:3:54
      |
    3 | <learn/><learn measurement='lag' min-runs='2' sigma='-1' limits='up' since='today'/>
      |                                                      ^^
      |
      = help: a number above 0, at most 1000

    error: `limits` has to be `low` or `high` or `both`: `up`
     --> arm.xml:3:66
      |
    3 | <learn/><learn measurement='lag' min-runs='2' sigma='-1' limits='up' since='today'/>
      |                                                                  ^^

    error: `since` is not a time: `today`
     --> arm.xml:3:77
      |
    3 | <learn/><learn measurement='lag' min-runs='2' sigma='-1' limits='up' since='today'/>
      |                                                                             ^^^^^
      |
      = help: write it like `2027-01-31` or `2027-01-31T12:00:00Z`

    error: a second `<learn>` for `lag`
     --> arm.xml:4:1
      |
    4 | <learn measurement='lag'/></test>
      | ^^^^^^

    6 errors; nothing was started
    ");
}
