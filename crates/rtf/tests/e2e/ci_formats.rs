//! Output for other programs: the event stream, TAP, GitHub, GitLab.

use std::process::{Command, Output, Stdio};

use insta::assert_snapshot;
use rtf_model::{Event, EventKind, Phase};

use crate::support::{Finished, Folder, nothing_left};

const PASSES: &str = "TestCase = {}\nfunction TestCase.run() rtf.check(true, 'fine') end\n";
const FAILS: &str = "TestCase = {}\nfunction TestCase.run()\n  print('7 A')\n  rtf.fail('100%: the brake, it is open')\nend\n";
const PATIENT: &str =
    "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        self.sleep(1000)\n";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("tests/Encoder.lua", PASSES).file("tests/Brake.lua", FAILS);
    folder.file(
        "tests/arm.xml",
        "<suite name=\"arm\">\n  <!-- was: --robot icub -->\n  <test>Encoder</test>\n  \
         <test critical=\"true\" type=\"lua\">Brake</test>\n  <test name=\"after\">Encoder.lua</test>\n</suite>\n"
            .replace(">Encoder<", ">Encoder.lua<")
            .as_str(),
    );
    folder
}

fn with_variables(folder: &Folder, args: &[&str], variables: &[(&str, &str)]) -> Finished {
    let output = folder.command(args).envs(variables.iter().copied()).output().expect("rtf runs");
    Finished {
        code: output.status.code(),
        stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
        stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

#[test]
fn the_event_stream_on_standard_output_is_the_journal() {
    let folder = folder();
    let finished = folder.rtf(&["run", "tests/arm.xml", "--format", "json"]);
    assert_eq!((finished.code, finished.stderr.as_str()), (Some(1), ""));
    let journal = std::fs::read_to_string(folder.path().join("rtf-results/latest/events.jsonl"));
    assert_eq!(finished.stdout, journal.expect("a journal"));
    let later = folder.rtf(&["report", "--format", "json"]);
    assert_eq!((later.code, later.stdout), (Some(0), finished.stdout.clone()));
    folder.rtf(&["report", "--format", "json", "-o", "copy.jsonl"]);
    let copy = std::fs::read_to_string(folder.path().join("copy.jsonl")).expect("a report");
    assert_eq!(copy, finished.stdout);
}

/// Bad input is told as always: standard output stays data.
#[test]
fn with_a_format_for_programs_standard_output_has_nothing_else() {
    let folder = folder();
    for format in ["json", "tap"] {
        let finished = folder.rtf(&["run", "tests/nothing.xml", "--format", format]);
        assert_eq!((finished.code, finished.stdout.as_str()), (Some(2), ""));
        assert!(finished.stderr.contains("there is no file or directory"), "{}", finished.stderr);
    }
}

#[test]
fn tap_as_it_is_told() {
    let folder = folder();
    let finished =
        folder.rtf(&["run", "tests/arm.xml", "--format", "tap", "--report", "tap=r.tap"]);
    let report = std::fs::read_to_string(folder.path().join("r.tap")).expect("a report");
    assert_eq!(finished.stdout, report);
    assert_eq!(folder.rtf(&["report", "--format", "tap"]).stdout, report);
    let time = regex::Regex::new(r"duration_ms: [0-9.]+").expect("a pattern");
    assert_snapshot!(time.replace_all(&folder.shown(&finished), "duration_ms: [TIME]"), @r#"
    exit code 1
    ----- stdout
    TAP version 14
    1..1
    # Subtest: arm
        1..3
        ok 1 - Encoder
          ---
          duration_ms: [TIME]
          ...
        not ok 2 - Brake
          ---
          duration_ms: [TIME]
          verdict: "failed"
          severity: "fail"
          message: "100%: the brake, it is open"
          at:
            file: "[FOLDER]/tests/Brake.lua"
            line: 4
          details: |
            failure: 100%: the brake, it is open
              at [FOLDER]/tests/Brake.lua:4
          output: |
            7 A
          ...
        ok 3 - after # SKIP the critical test `Brake` did not pass: it is failed
    not ok 1 - arm
      ---
      duration_ms: [TIME]
      message: "1 of 3 tests passed"
      ...
    ----- stderr
    "#);
}

/// Perl's `prove` is the harness that everything which reads TAP is measured by.
/// The one of Debian knows version 13 only, of which 14 is an extension.
#[test]
fn prove_understands_it() {
    let folder = folder();
    folder.file("good.xml", "<suite name='good #1 \\o/'><test>tests/Encoder.lua</test></suite>");
    folder.rtf(&["run", "good.xml", "--report", "tap=good.tap"]);
    folder.rtf(&["run", "tests/arm.xml", "good.xml", "--report", "tap=bad.tap"]);
    let prove = |file: &str| {
        let path = folder.path().join(file);
        let text = std::fs::read_to_string(&path).expect("a report");
        folder.file(file, &text.replacen("TAP version 14", "TAP version 13", 1));
        let mut prove = Command::new("prove");
        let output = prove.args(["--verbose", "--exec", "cat", file]).current_dir(folder.path());
        let output = output.output().expect("prove is installed");
        (output.status.success(), String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let (well, said) = prove("good.tap");
    assert!(well && said.contains("Files=1, Tests=1,"), "{said}");
    assert!(!said.contains("Parse errors"), "{said}");
    let (well, said) = prove("bad.tap");
    assert!(!well && said.contains("Failed 1/2 subtests"), "{said}");
    assert!(!said.contains("Parse errors"), "{said}");
}

#[test]
fn annotations_when_github_runs_it() {
    let folder = folder();
    let root = folder.path().canonicalize().expect("a path");
    let github = [("GITHUB_ACTIONS", "true"), ("GITHUB_WORKSPACE", root.to_str().expect("a path"))];
    let finished = with_variables(&folder, &["run", "tests/arm.xml"], &github);
    assert_snapshot!(folder.redact(&finished.stderr), @"
    ::error file=tests/Brake.lua,line=4,title=arm/Brake failed::failure: 100%25: the brake, it is open%0A  at [FOLDER]/tests/Brake.lua:4
    ::warning file=tests/arm.xml,line=2,col=13,title=`--` in a comment is not legal XML; accepted::`--` in a comment is not legal XML; accepted%0Ahint: remove the dashes: other programs refuse the file
    ");
    let finished =
        with_variables(&folder, &["run", "tests/arm.xml", "--annotations", "none"], &github);
    assert_eq!(finished.stderr, "");
    let later = with_variables(&folder, &["report", "--format", "github"], &github);
    let finished = with_variables(&folder, &["run", "tests/arm.xml", "--format", "tap"], &github);
    assert_eq!(later.stdout, finished.stderr, "data and annotations do not meet");
}

#[test]
fn gitlab_gets_sections() {
    let folder = folder();
    let output = in_gitlab(&folder);
    let stdout = String::from_utf8_lossy(&output.stdout).into_owned();
    let stdout = stdout.replace('\x1b', "<ESC>").replace('\r', "<CR>");
    let times = regex::Regex::new(r":1\d{9}:").expect("a pattern");
    assert_snapshot!(times.replace_all(&folder.redact(&stdout), ":[TIME]:"), @"
        warning  arm.xml:2:13: `--` in a comment is not legal XML; accepted
                 hint: remove the dashes: other programs refuse the file
    <ESC>[0Ksection_start:[TIME]:rtf_suite_0[collapsed=true]<CR><ESC>[0Ksuite arm
    suite arm  3 tests  arm.xml
         passed     [TIME]  arm/Encoder
         failed     [TIME]  arm/Brake
                 failure: 100%: the brake, it is open
                   at [FOLDER]/tests/Brake.lua:4
                 it printed:
                 | 7 A
        skipped              arm/after: the critical test `Brake` did not pass: it is failed
    <ESC>[0Ksection_end:[TIME]:rtf_suite_0<CR><ESC>[0K

    tests that did not pass:
      arm/Brake  failed
        reason  100%: the brake, it is open
        at      [FOLDER]/tests/Brake.lua:4
        log     rtf-results/[RUN]/logs/arm.Brake.log
        rerun   rtf run arm.xml::Brake

    skipped tests:
      1 test: the critical test `Brake` did not pass: it is failed
        arm/after

    results: rtf-results/[RUN]
    FAILED  3 tests in 1 suite, [TIME]: 1 passed, 1 failed, 1 skipped
    ");
}

fn in_gitlab(folder: &Folder) -> Output {
    let args = ["run", "arm.xml", "--report", "code-quality=out/quality.json"];
    let mut command = folder.command(&args);
    command.current_dir(folder.path().join("tests")).env("GITLAB_CI", "true");
    command.output().expect("rtf runs")
}

#[test]
fn gitlab_gets_a_code_quality_report() {
    let folder = folder();
    // A repository of its own: files are named from its root.
    folder.file(".git/HEAD", "");
    in_gitlab(&folder);
    let report = std::fs::read_to_string(folder.path().join("tests/out/quality.json"));
    assert_snapshot!(folder.redact(&report.expect("a report")), @r#"
    [
      {
        "description": "arm/Brake failed: failure: 100%: the brake, it is open\n  at [FOLDER]/tests/Brake.lua:4",
        "check_name": "rtf-failed",
        "fingerprint": "7f3ad9715f9e98690decda4cb502fd29",
        "severity": "major",
        "location": {
          "path": "tests/Brake.lua",
          "lines": {
            "begin": 4
          }
        }
      },
      {
        "description": "`--` in a comment is not legal XML; accepted\nhint: remove the dashes: other programs refuse the file",
        "check_name": "rtf-comment-dashes",
        "fingerprint": "de08e7e5cf7d1344907ebe93efb4542e",
        "severity": "minor",
        "location": {
          "path": "tests/arm.xml",
          "lines": {
            "begin": 2
          }
        }
      }
    ]
    "#);
}

#[test]
fn when_the_runner_dies_its_guard_ends_what_is_told() {
    for (format, last) in [("json", "{\"seq\":"), ("tap", "Bail out! signal 9 (SIGKILL)")] {
        let folder = Folder::new();
        folder.file("T.py", PATIENT);
        let mut command = folder.command(&["run", "T.py", "--format", format]);
        command.env("GITHUB_ACTIONS", "true").stdout(Stdio::piped()).stderr(Stdio::piped());
        let running = folder.watch(command.spawn().expect("rtf starts"));
        running.wait_for(|kind| matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. }));
        running.kill_runner();
        let finished = running.finish();
        assert_eq!(finished.code, Some(5), "{}", finished.stderr);
        let line = finished.stdout.lines().last().expect("a line");
        assert!(line.starts_with(last), "{}", finished.stdout);
        if format == "json" {
            let event: Event = serde_json::from_str(line).expect("an event");
            assert!(matches!(event.kind, EventKind::RunnerDied { .. }), "{line}");
        }
        let annotation = "::error title=the runner died%3A signal 9 (SIGKILL)::";
        assert!(finished.stderr.contains(annotation), "{}", finished.stderr);
        assert!(nothing_left(&folder));
    }
}

#[test]
fn a_summary_for_the_page_of_a_job() {
    let folder = folder();
    folder.rtf(&["run", "tests/arm.xml", "--report", "markdown=summary.md"]);
    let written = std::fs::read_to_string(folder.path().join("summary.md")).expect("a report");
    let later = folder.rtf(&["report", "--format", "markdown"]);
    assert_eq!((later.code, &later.stdout), (Some(0), &written));
    let linked = folder.rtf(&["report", "--format", "markdown", "--link", "https://ci.example/7"]);
    assert_snapshot!(folder.redact(&linked.stdout), @"
    ## ❌ FAILED

    3 tests in 1 suite, [TIME]: 1 passed, 1 failed, 1 skipped

    run <code>[RUN]</code> · [results](<https://ci.example/7>) · directory <code>rtf-results/[RUN]</code>

    ### Tests that did not pass

    <details>
    <summary><code>arm/Brake</code> <b>failed</b>: <code>100%: the brake, it is open</code></summary>

    - at <code>tests/Brake.lua:4</code>
    - log <code>rtf-results/[RUN]/logs/arm.Brake.log</code>
    - rerun <code>rtf run tests/arm.xml::Brake</code>

    ```text
    failure: 100%: the brake, it is open
      at [FOLDER]/tests/Brake.lua:4
    ```

    1 line of output:

    ```text
    7 A
    ```

    </details>

    ### Skipped tests

    - 1 test: <code>the critical test &#96;Brake&#96; did not pass: it is failed</code>: <code>arm/after</code>

    ### Warnings

    - <code>tests/arm.xml:2: &#96;--&#96; in a comment is not legal XML; accepted</code>
    ");
}
