//! Reports of past runs, made from their journals.

use std::io::Read;
use std::process::Stdio;

use insta::assert_snapshot;

use crate::support::Folder;

const PASSES: &str = "TestCase = {}\nfunction TestCase.run() rtf.check(true, 'fine') end\n";

/// Something of everything that a test can leave behind.
const LEAVES: &str = "import rtf\n\n\nclass Rate(rtf.TestCase):\n    def run(self):\n        \
    open('data.csv', 'w').write('1;2')\n        self.attach('data.csv')\n        \
    self.measure('rate', 99, 'Hz', 95, 105)\n        \
    self.measure('rate', 87.5, 'Hz', 95, 105)\n        \
    self.check(False, 'joint 3 does not move')\n        print('motor current 7 A')\n";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("Encoder.lua", PASSES).file("rate.py", LEAVES);
    folder.file(
        "arm.xml",
        "<suite name=\"arm\">\n  <!-- was: --robot icub -->\n  <test>Encoder.lua</test>\n  \
         <test tags=\"slow\">rate.py</test>\n</suite>\n",
    );
    folder
}

/// A reason that is a measurement's is told once, with its place.
#[test]
fn a_run_as_it_is_told() {
    let folder = folder();
    folder.file("rate.py", &LEAVES.replace("self.check(False,", "self.check(True,"));
    let finished = folder.rtf(&["run", "arm.xml"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 1
    ----- stdout
        warning  arm.xml:2:13: `--` in a comment is not legal XML; accepted
                 hint: remove the dashes: other programs refuse the file
    suite arm  2 tests  arm.xml
         passed     [TIME]  arm/Encoder
         failed     [TIME]  arm/rate
                 measured rate = 87.5 Hz, outside 95 … 105 at [FOLDER]/rate.py:9
                 it printed:
                 | motor current 7 A

    tests that did not pass:
      arm/rate  failed
        reason  `rate` is 87.5 Hz, its limits are 95 … 105
        at      [FOLDER]/rate.py:9
        log     rtf-results/[RUN]/logs/arm.rate.log
        rerun   rtf run arm.xml::rate

    results: rtf-results/[RUN]
    FAILED  2 tests in 1 suite, [TIME]: 1 passed, 1 failed
    ----- stderr
    ");
}

#[test]
fn show_tells_what_the_run_told() {
    let folder = folder();
    let run = folder.rtf(&["run", "arm.xml"]);
    let shown = folder.rtf(&["show", "latest"]);
    assert_eq!(shown.code, Some(1), "{}", shown.stderr);
    assert_eq!((shown.stdout, shown.stderr), (run.stdout, run.stderr));
    let run = folder.rtf(&["run", "-v", "Encoder.lua"]);
    let shown = folder.rtf(&["show", "-v"]);
    assert_eq!((shown.code, &shown.stdout), (Some(0), &run.stdout));
    assert!(shown.stdout.contains("plug-ins/Encoder: check: fine"), "{}", shown.stdout);
}

#[test]
fn a_report_made_later_has_the_same_bytes() {
    let folder = folder();
    let finished = folder.rtf(&[
        "run",
        "arm.xml",
        "--report",
        "junit=out/junit.xml",
        "--report",
        "text=out/report.txt",
    ]);
    assert_eq!(finished.code, Some(1), "{}", finished.stderr);
    for (format, file) in [("junit", "out/junit.xml"), ("text", "out/report.txt")] {
        let written = std::fs::read_to_string(folder.path().join(file)).expect("a report");
        assert!(written.contains("joint 3 does not move"), "{written}");
        let later = folder.rtf(&["report", "latest", "--format", format]);
        assert_eq!((later.code, later.stderr.as_str()), (Some(0), ""));
        assert_eq!(later.stdout, written);
        folder.rtf(&["report", "--format", format, "-o", "again"]);
        assert_eq!(
            std::fs::read_to_string(folder.path().join("again")).expect("a report"),
            written
        );
    }
    let junit = std::fs::read_to_string(folder.path().join("out/junit.xml")).expect("a report");
    let (_, rest) = junit.split_once("[[ATTACHMENT|").expect("the attachment");
    let (attached, _) = rest.split_once("]]").expect("its end");
    assert_eq!(std::fs::read_to_string(folder.path().join(attached)).expect("a file"), "1;2");
}

#[test]
fn a_run_that_there_is_not_is_answered_with_those_that_there_are() {
    let folder = folder();
    assert_snapshot!(folder.shown(&folder.rtf(&["show"])), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: there are no runs in `rtf-results`
    hint: run something first, or name a run's directory
    ");
    folder.rtf(&["run", "Encoder.lua"]);
    let finished = folder.rtf(&["show", "2026"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: there is no run `2026`
    hint: the only run is [RUN]
    ");
    folder.rtf(&["run", "Encoder.lua"]);
    let finished = folder.rtf(&["report", "yesterday", "--format", "text"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: there is no run `yesterday`
    hint: the newest runs are [RUN], [RUN]
    ");
    folder.file("notes.txt", "no journal\n");
    let finished = folder.rtf(&["show", "notes.txt"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: `notes.txt` is not a journal: line 1: this is not an event: expected ident at line 1 column 2
    ");
}

#[test]
fn runs_of_one_second_have_their_own_folders_and_latest_is_the_newest() {
    let folder = folder();
    let names: Vec<_> = (0..3)
        .map(|_| {
            assert_eq!(folder.rtf(&["run", "Encoder.lua"]).code, Some(0));
            let latest = std::fs::read_link(folder.path().join("rtf-results/latest"));
            latest.expect("a link").into_os_string()
        })
        .collect();
    let mut found: Vec<_> = std::fs::read_dir(folder.path().join("rtf-results"))
        .expect("the results")
        .map(|entry| entry.expect("an entry").file_name())
        .filter(|name| name != "latest" && !name.to_string_lossy().starts_with("history.db"))
        .collect();
    found.sort();
    let mut wanted = names.clone();
    wanted.sort();
    wanted.dedup();
    assert_eq!((found.len(), found), (3, wanted));
    for name in &names {
        let shown = folder.rtf(&["show", name.to_str().expect("a name")]);
        assert_eq!(shown.code, Some(0), "{}", shown.stderr);
    }
}

/// Runs a command, reads ten bytes of what it prints, and goes away.
fn read_a_little(folder: &Folder, args: &[&str]) -> (Option<i32>, String) {
    let mut command = folder.command(args);
    let mut child =
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("rtf starts");
    let mut beginning = [0; 10];
    let mut stdout = child.stdout.take().expect("its output");
    stdout.read_exact(&mut beginning).expect("ten bytes");
    drop(stdout);
    let output = child.wait_with_output().expect("rtf ends");
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    let folder = Folder::new();
    // More than a pipe holds.
    folder.file("Talks.lua", "TestCase = {}\nfunction TestCase.run()\n  for i = 1, 20000 do rtf.report('step ' .. i) end\nend\n");
    assert_eq!(folder.rtf(&["run", "Talks.lua"]).code, Some(0));
    for args in
        [["report", "--format", "text"].as_slice(), &["show", "-v"], &["run", "-v", "Talks.lua"]]
    {
        assert_eq!(read_a_little(&folder, args), (Some(0), String::new()), "{args:?}");
    }
    assert!(folder.journal().record.is_green(), "the run went on");
}

#[test]
fn what_a_terminal_would_obey_is_shown_as_text() {
    let folder = Folder::new();
    folder.file("Nasty.lua", "TestCase = {}\nfunction TestCase.run()\n  print('\\27[2Jcleared')\n  rtf.fail('\\27]0;title\\7 red')\nend\n");
    for args in [["run", "-v", "Nasty.lua"].as_slice(), &["run", "Nasty.lua"], &["show"]] {
        let finished = folder.rtf(args);
        let text = &finished.stdout;
        assert_eq!(finished.code, Some(1));
        assert!(!text.contains(['\u{1b}', '\u{7}']), "{text:?}");
        assert!(
            text.contains(r"\x1b[2Jcleared") && text.contains(r"\x1b]0;title\x07 red"),
            "{text}"
        );
    }
}
