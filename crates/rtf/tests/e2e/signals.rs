//! Ctrl-C: once tears down, twice kills, and nothing is left.

use std::io::Write as _;
use std::process::Stdio;

use rtf_model::{EventKind, Phase, TestId, Verdict};

use crate::support::{Folder, Running, nothing_left};

const FIXTURE: &str = "import rtf\nclass F(rtf.FixtureManager):\n    def setup(self, args):\n        return True\n    def tearDown(self):\n        open('torn-down', 'w').close()\n";
const PATIENT: &str =
    "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        self.sleep(1000)\n";
const STUBBORN: &str = "import rtf, signal, time\nclass T(rtf.TestCase):\n    def run(self):\n        signal.signal(signal.SIGTERM, signal.SIG_IGN)\n        while True:\n            time.sleep(1)\n";

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
