//! Ctrl-C: the first tears down, the second kills, and no process is left.

use std::io::Write as _;
use std::process::{Command, Stdio};

use rtf_model::{EventKind, Phase, TestId, Verdict};

use crate::support::{Folder, Running, next_request, nothing_left, send, wait_until};

const FIXTURE: &str = "import rtf\nclass F(rtf.FixtureManager):\n    def setup(self, args):\n        return True\n    def tearDown(self):\n        open('torn-down', 'w').close()\n";
const PATIENT: &str =
    "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        self.sleep(1000)\n";
const STUBBORN: &str = "import rtf, signal, time\nclass T(rtf.TestCase):\n    def run(self):\n        signal.signal(signal.SIGTERM, signal.SIG_IGN)\n        while True:\n            try:\n                time.sleep(1000)\n            except BaseException:\n                pass\n";

fn run(folder: &Folder, test: &str) -> Running {
    folder.file("F.py", FIXTURE).file("T.py", test);
    let suite = "<suite name='NAME'><fixture type='python'>F</fixture><test type='python' grace='60s'>T</test><test type='python'>T</test></suite>";
    folder.file("a.xml", &suite.replace("NAME", "a")).file("b.xml", &suite.replace("NAME", "b"));
    let running = folder.start(&["run", "a.xml", "b.xml", "--report", "junit=junit.xml"]);
    running.wait_for(|kind| matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. }));
    running
}

#[test]
fn the_first_signal_stops_the_test_and_tears_down() {
    for (signal, code) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
        let folder = Folder::new();
        let running = run(&folder, PATIENT);
        running.signal(signal);
        assert_eq!(running.finish().code, Some(code));
        let record = folder.journal().record;
        assert_eq!(record.verdict(TestId(0)), Some(Verdict::Interrupted));
        assert_eq!(record.totals().of(Verdict::Skipped), 3, "the next suite, too");
        assert_eq!(record.interrupted(), Some(format!("SIG{signal}").as_str()));
        assert!(folder.path().join("torn-down").exists());
        assert!(folder.path().join("junit.xml").exists());
        assert!(nothing_left(&folder));
    }
}

/// Schedulers end a job with a signal to all its processes, of which the test's may be the first:
/// nothing is wrong with the test.
#[test]
fn a_signal_to_the_process_of_the_test_and_to_the_runner_is_an_interruption() {
    let folder = Folder::new();
    let reports = "import os, rtf\nclass T(rtf.TestCase):\n    def run(self):\n        \
        open('new', 'w').write(str(os.getpid()))\n        os.rename('new', 'pid')\n        \
        self.sleep(1000)\n";
    let running = run(&folder, reports);
    let pid =
        wait_until("the test runs", || std::fs::read_to_string(folder.path().join("pid")).ok());
    send(pid.parse().expect("a process"), "TERM");
    running.signal("TERM");
    assert_eq!(running.finish().code, Some(143));
    assert_eq!(folder.journal().record.verdict(TestId(0)), Some(Verdict::Interrupted));
    assert!(nothing_left(&folder));
}

/// Programs that start rtf hold its standard input: what is written there does not
/// matter, and their death ends the run in order, once.
#[test]
fn the_end_of_standard_input_is_a_first_signal() {
    let folder = Folder::new();
    folder.file("F.py", FIXTURE).file("T.py", PATIENT);
    folder.file(
        "a.xml",
        "<suite><fixture type='python'>F</fixture><test type='python'>T</test></suite>",
    );
    let mut command = folder.command(&["run", "--end-with-stdin", "a.xml"]);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut lifeline = child.stdin.take().unwrap();
    let running = folder.watch(child);
    lifeline.write_all(b"this changes nothing\n").unwrap();
    running.wait_for(|kind| matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. }));
    drop(lifeline);
    assert_eq!(running.finish().code, Some(143));
    assert_eq!(folder.journal().record.interrupted(), Some("SIGTERM"));
    assert!(folder.path().join("torn-down").exists());
    assert!(nothing_left(&folder));
}

#[test]
fn the_second_signal_kills_without_tear_down() {
    let folder = Folder::new();
    let running = run(&folder, STUBBORN);
    running.signal("INT");
    running.wait_for(|kind| matches!(kind, EventKind::TestStopping { .. }));
    next_request();
    running.signal("INT");
    assert_eq!(running.finish().code, Some(130));
    assert_eq!(folder.journal().record.verdict(TestId(0)), Some(Verdict::Interrupted));
    assert!(!folder.path().join("torn-down").exists());
    assert!(folder.path().join("junit.xml").exists());
    assert!(nothing_left(&folder));
}

#[test]
fn a_tear_down_that_hangs_ends_with_the_time_for_the_shutdown() {
    let folder = Folder::new();
    let hanging = FIXTURE.replace(
        "'torn-down', 'w').close()",
        "'torn-down', 'w').close()\n        import time\n        time.sleep(1000)",
    );
    let hook =
        "<hook name='park' on='interrupt'><command>sh -c 'echo parked > parked'</command></hook>";
    let suite = format!(
        "<suite name='s'><fixture type='python' teardown-timeout='1h'>F</fixture>{hook}<test type='python'>T</test></suite>"
    );
    folder.file("F.py", &hanging).file("T.py", PATIENT).file("s.xml", &suite);
    let running = folder.start(&["run", "s.xml", "--shutdown-timeout", "500ms"]);
    running.wait_for(|kind| matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. }));
    running.signal("INT");
    let finished = running.finish();
    assert_eq!(finished.code, Some(130));
    let told = "the run did not end within 500ms of SIGINT";
    assert!(finished.stdout.contains(told), "{}", finished.stdout);
    let record = folder.journal().record;
    assert_eq!(record.verdict(TestId(0)), Some(Verdict::Interrupted));
    assert_eq!(record.fixtures[0].problems[0].1, format!("it was killed: {told}"));
    assert!(folder.path().join("torn-down").exists(), "its tear-down had begun");
    assert!(folder.path().join("parked").exists());
    assert!(nothing_left(&folder));
}

const HOOK: &str =
    "<hook name='park' on='interrupt'><command>sh -c 'echo parked >> parked'</command></hook>";

/// A patient test over a fixture, with a hook; it runs already.
fn run_with_hook(folder: &Folder, hook: &str) -> Running {
    folder.file("F.py", FIXTURE).file("T.py", PATIENT);
    let suite = format!(
        "<suite><fixture type='python'>F</fixture>{hook}<test type='python'>T</test></suite>"
    );
    folder.file("s.xml", &suite);
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(|kind| matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. }));
    running
}

fn shell(script: &str) {
    assert!(Command::new("sh").args(["-c", script]).status().expect("sh").success());
}

/// `timeout` signals its child and then its group, a logout sends SIGHUP, SIGTERM
/// and SIGCONT.
#[test]
fn signals_that_come_together_are_one_request() {
    let folder = Folder::new();
    let running = run_with_hook(&folder, HOOK);
    let guard = running.child.id();
    shell(&format!("for s in TERM HUP INT TERM CONT TERM; do kill -$s {guard}; done"));
    assert_eq!(running.finish().code, Some(143));
    assert!(folder.path().join("torn-down").exists(), "torn down, not killed");
    assert_eq!(folder.read("parked"), "parked\n");
    assert!(nothing_left(&folder));
}

/// A logout does that: it stops processes, signals them, and lets them go on.
#[test]
fn signals_that_wait_for_a_stopped_runner_are_one_request() {
    let folder = Folder::new();
    let running = run_with_hook(&folder, HOOK);
    let runner = running.runner();
    shell(&format!("for s in STOP TERM HUP CONT; do kill -$s {runner}; done"));
    let code = running.finish().code;
    assert!(code == Some(143) || code == Some(129), "{code:?}");
    assert!(folder.path().join("torn-down").exists(), "torn down, not killed");
    assert_eq!(folder.read("parked"), "parked\n");
    assert!(nothing_left(&folder));
}

#[test]
fn the_second_request_kills_and_the_hook_runs() {
    let folder = Folder::new();
    folder.file("T.py", STUBBORN).file("F.py", FIXTURE);
    let suite = format!(
        "<suite><fixture type='python'>F</fixture>{HOOK}<test type='python' grace='60s'>T</test></suite>"
    );
    folder.file("s.xml", &suite);
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(|kind| matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. }));
    running.signal("INT");
    running.wait_for(|kind| matches!(kind, EventKind::TestStopping { .. }));
    next_request();
    running.signal("INT");
    assert_eq!(running.finish().code, Some(130));
    assert!(!folder.path().join("torn-down").exists());
    assert_eq!(folder.read("parked"), "parked\n");
}

#[test]
fn the_third_request_kills_the_hook_which_the_journal_and_the_exit_code_say() {
    let folder = Folder::new();
    let hook = "<hook name='park' on='interrupt' timeout='1h'><command>sleep 1000</command></hook>";
    let running = run_with_hook(&folder, hook);
    running.signal("INT");
    running.wait_for(|kind| matches!(kind, EventKind::HookStarted { .. }));
    next_request();
    running.signal("INT");
    running.wait_for(|kind| matches!(kind, EventKind::FixtureStopped { .. }));
    next_request();
    running.signal("INT");
    let finished = running.finish();
    assert_eq!(finished.code, Some(4), "{}{}", finished.stdout, finished.stderr);
    let record = folder.journal().record;
    assert_eq!(record.interrupted(), Some("SIGINT"));
    assert_eq!(
        record.hooks[0].problems().collect::<Vec<_>>(),
        ["hook `park` on interrupt: it was killed by the third request to end the run"]
    );
    assert_eq!(folder.rtf(&["show", "latest"]).code, Some(4));
    assert!(nothing_left(&folder));
}

/// SIGXFSZ would end the runner and the guard without a word. What they start
/// keeps its own way with it.
#[test]
fn a_limit_of_file_sizes_is_reported_and_does_not_end_the_run() {
    let folder = Folder::new();
    folder.file("F.py", FIXTURE).file(
        "T.py",
        "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        for i in range(2000):\n            self.report('line %d' % i)\n",
    );
    let hook = "<hook name='park' on='end'><command>sh -c 'exec head -c 1000000 /dev/zero > big'</command></hook>";
    folder.file(
        "s.xml",
        &format!(
            "<suite><fixture type='python'>F</fixture>{hook}<test type='python'>T</test></suite>"
        ),
    );
    let mut command = Command::new("sh");
    command.args(["-c", "ulimit -f 64; exec \"$0\" run s.xml", env!("CARGO_BIN_EXE_rtf")]);
    let output = command.current_dir(folder.path()).output().expect("sh");
    let shown = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{shown}");
    assert!(shown.contains("File too large"), "{shown}");
    assert!(shown.contains("it ended with signal 25 (SIGXFSZ)"), "{shown}");
    assert!(folder.path().join("torn-down").exists(), "{shown}");
    assert!(nothing_left(&folder));
}
