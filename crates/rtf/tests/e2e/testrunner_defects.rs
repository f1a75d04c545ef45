//! Defects of the predecessor's runner that its replacement does not have. The numbers are those
//! in `docs/how-to/migrating-rtf2.md`.

use insta::assert_snapshot;
use rtf_model::EventKind;

use crate::support::{Folder, nothing_left};

const GOOD: &str = "TestCase.run = function() end\n";

fn python(body: &str) -> String {
    format!("import os\nclass TestCase:\n    def run(self):\n        {body}\n")
}

/// Defects 1 and 7: what is missing or wrong is found before anything is started.
#[test]
fn whatever_is_missing_is_red_and_nothing_is_started() {
    let folder = Folder::new();
    folder.file("Good.lua", GOOD).file("empty/note.txt", "");
    folder.file("s.xml", "<suite name='s'><test type='lua'>Good</test><test>Gone</test></suite>");
    for args in [
        ["-t", "Gone.so"].as_slice(),
        &["-t", "Gone"],
        &["-s", "gone.xml"],
        &["-s", "s.xml"],
        &["-s", "Good.lua"],
        &["--tests", "empty"],
        &["--suites", "empty"],
        &["--suites", "gone"],
        &["-t", "Good.lua", "--output", "/proc/nowhere/x"],
        &["-t", "Good.lua", "--output-type", "xml"],
        &["-t", "Good.lua", "--repetition", "many"],
    ] {
        let finished = folder.testrunner(args);
        assert_eq!(finished.code, Some(1), "{args:?}");
        assert!(finished.stderr.contains("error"), "{args:?}: {}", finished.stderr);
        assert!(!folder.path().join("rtf-results").exists(), "{args:?}");
    }
}

/// Defect 3: a crash in the last test counted as passed and failed, `exit(0)` ended
/// the run with 0, and no file was left.
#[test]
fn a_crash_is_one_failure_of_its_own_test() {
    let folder = Folder::new();
    folder.file("1-Exits.py", &python("os._exit(0)")).file("2-Good.lua", GOOD);
    folder.file("3-Crashes.py", &python("os.kill(os.getpid(), 9)"));
    let finished = folder.testrunner(&["--tests", "."]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 1
    ----- stdout
    [ERROR] (1-Exits) crashed: the test's process ended in run with exit code 0 before the test was over
    [ERROR] (3-Crashes) crashed: the test's process ended in run with signal 9 (SIGKILL) before the test was over

    ---------- results -----------
    Total number of test cases   : 3
    Number of passed test cases  : 1
    Number of failed test cases  : 2
    ----- stderr
    ");
    let text = folder.read("result.txt");
    assert!(
        text.contains("Test case 2-Good passed!") && text.contains("Test case 3-Crashes failed!")
    );
}

const DRIVER: &str = "FixtureManager = {}
function FixtureManager.setup() return SETUP end
function FixtureManager.check() return not io.open('collapse') end
function FixtureManager.tearDown() io.open('torn-down-NAME', 'w'):close() end
";

fn driver(folder: &Folder, name: &str, setup: &str) {
    folder.file(&format!("{name}.lua"), &DRIVER.replace("NAME", name).replace("SETUP", setup));
}

/// Defect 4: a collapse during the last test was not reported.
#[test]
fn a_collapse_during_the_only_test_is_red() {
    let folder = Folder::new();
    driver(&folder, "Driver", "true");
    let wait = "TestCase.run = function()\n  io.open('collapse', 'w'):close()\n  \
                while true do os.remove('nothing') end\nend\n";
    folder.file("T.lua", wait);
    folder.file(
        "s.xml",
        "<suite name='s'><fixture type='lua' check-every='20ms' restarts='0'>Driver</fixture>\
         <test type='lua' grace='100ms'>T</test></suite>",
    );
    let finished = folder.testrunner(&["-s", "s.xml"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 1
    ----- stdout
    [ERROR] (s) Fixture collapsed: Driver: check failed: check returned false
    [ERROR] (s) Fixture collapsed: Driver: it will not be restarted: check failed: check returned false
    [ERROR] (T) collapsed: fixture `Driver` collapsed: check failed: check returned false

    ---------- results -----------
    Total number of test suites  : 1
    Number of passed test suites : 0
    Number of failed test suites : 1
    Total number of test cases   : 1
    Number of passed test cases  : 0
    Number of failed test cases  : 1
    ----- stderr
    ");
    assert!(nothing_left(&folder));
}

/// Defect 5: the first fixture was not torn down, and no test was counted.
#[test]
fn a_set_up_that_fails_fails_every_test() {
    let folder = Folder::new();
    driver(&folder, "First", "true");
    driver(&folder, "Second", "false");
    folder.file("T.lua", GOOD);
    folder.file(
        "s.xml",
        "<suite name='s'><fixture type='lua'>First</fixture><fixture type='lua'>Second</fixture>\
         <test type='lua'>T</test></suite>",
    );
    let finished = folder.testrunner(&["-s", "s.xml", "--no-output"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 1
    ----- stdout
    [ERROR] (s) setup() failed!: Second: set-up failed: setup returned false
    [ERROR] (T) skipped: fixture `Second` is broken: set-up failed: setup returned false

    ---------- results -----------
    Total number of test suites  : 1
    Number of passed test suites : 0
    Number of failed test suites : 1
    Total number of test cases   : 1
    Number of passed test cases  : 0
    Number of failed test cases  : 1
    ----- stderr
    ");
    assert!(folder.path().join("torn-down-First").exists());
}

/// Defect 6: Ctrl-C was "passed", exit code 0.
#[test]
fn a_signal_is_red_and_the_file_is_there() {
    let folder = Folder::new();
    folder.file(
        "Sleeps.py",
        "import time\nclass TestCase:\n    def run(self):\n        time.sleep(600)\n",
    );
    folder.file("s.xml", "<suite name='s'><test type='python'>Sleeps</test></suite>");
    folder.file("t.xml", "<suite name='t'><test type='python'>Sleeps</test></suite>");
    let mut command = folder.testrunner_command(&["--suites", "."]);
    command.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped());
    let running = folder.watch(command.spawn().expect("rtf starts"));
    running.wait_for(|kind| matches!(kind, EventKind::TestStarted { .. }));
    running.signal("INT");
    let finished = running.finish();
    assert_eq!(finished.code, Some(1), "{}", finished.stderr);
    let text = folder.read("result.txt");
    assert!(text.contains("the run was interrupted: SIGINT"), "{text}");
    assert!(text.ends_with("Total number of test cases   : 2\nNumber of passed test cases  : 0\nNumber of failed test cases  : 2\n"), "{text}");
    assert!(nothing_left(&folder));
}

/// Nothing is lost when the runner itself is killed: its guard writes the file.
#[test]
fn a_killed_runner_leaves_its_result_file() {
    for output in [["--output-type", "text"], ["--output-type", "junit"]] {
        let folder = Folder::new();
        folder.file("1-Good.lua", GOOD);
        folder.file(
            "2-Sleeps.py",
            "import time\nclass TestCase:\n    def run(self):\n        time.sleep(600)\n",
        );
        let mut command =
            folder.testrunner_command(&[&["--tests", "."], output.as_slice()].concat());
        command.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped());
        let running = folder.watch(command.spawn().expect("rtf starts"));
        running.wait_for(|kind| matches!(kind, EventKind::TestStarted { test, .. } if test.0 == 1));
        running.kill_runner();
        let finished = running.finish();
        assert_eq!(finished.code, Some(1), "{}", finished.stderr);
        assert!(
            finished.stdout.ends_with("Number of failed test cases  : 1\n"),
            "{}",
            finished.stdout
        );
        let file = folder.read(if output[1] == "text" { "result.txt" } else { "result.xml" });
        assert!(file.contains("1-Good") && file.contains("the runner died"), "{file}");
        assert!(nothing_left(&folder));
    }
}

/// Defect 8: texts were cut at 254 characters; a name with a blank shifted the arguments.
#[test]
fn texts_are_whole() {
    let folder = Folder::new();
    folder.file(
        "T.lua",
        "TestCase.run = function() robottestingframework.testReport(('x'):rep(5000)) end\n",
    );
    folder.testrunner(&["-t", "T.lua"]);
    assert!(folder.read("result.txt").contains(&format!("reports: {}\n", "x".repeat(5000))));
}

/// The predecessor's page was there for everybody on the network.
#[test]
fn the_page_is_on_this_machine() {
    let folder = Folder::new();
    folder.file("Good.lua", GOOD);
    let finished = folder.testrunner(&["-t", "Good.lua", "-w", "--web-port", "0", "--no-output"]);
    let address = regex::Regex::new("127.0.0.1:[0-9]+/#token=[0-9a-f]{64}").expect("a pattern");
    assert_snapshot!(address.replace(&folder.shown(&finished), "[ADDRESS]"), @"
    exit code 0
    ----- stdout

    ---------- results -----------
    Total number of test cases   : 1
    Number of passed test cases  : 1
    Number of failed test cases  : 0
    ----- stderr
    web: http://[ADDRESS]
    ");
}
