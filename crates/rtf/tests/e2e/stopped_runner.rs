//! A runner or a guard that is stopped (SIGSTOP), by a debugger or by a test.

use rtf_model::{EventKind, Phase};

use crate::support::{Folder, Running, nothing_left, send};

const SUITE: &str = "<suite name='s'>\
    <fixture type='process' name='arm'><command>sh -c 'echo up; exec sleep 1000'</command><ready log='up'/></fixture>\
    <hook name='park' on='interrupt end'><command>sh -c 'echo $RTF_HOOK_TRIGGER >> parked'</command></hook>\
    TESTS</suite>";
const PATIENT: &str =
    "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        self.sleep(1000)\n";

fn start(folder: &Folder, test: &str, tests: &str, args: &[&str]) -> Running {
    folder.file("T.py", test).file("s.xml", &SUITE.replace("TESTS", tests));
    let running = folder.start(&[&["run", "s.xml"], args].concat());
    running.wait_for(|kind| matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. }));
    running
}

/// Nothing that the suite says about time would act any more.
#[test]
fn a_runner_that_stays_stopped_is_taken_over_and_the_robot_is_parked() {
    let folder = Folder::new();
    let one = "<test type='python'>T</test>";
    let running = start(&folder, PATIENT, one, &["--shutdown-timeout", "5s"]);
    send(running.runner(), "STOP");
    let finished = running.finish();
    assert_eq!(finished.code, Some(5), "{}", finished.stderr);
    let told = "error: the runner died: it was stopped, and did not answer for";
    assert!(finished.stderr.starts_with(told), "{}", finished.stderr);
    assert!(finished.stderr.contains("  hook park: parked\n"), "{}", finished.stderr);
    assert_eq!(folder.read("parked"), "interrupt\n");
    assert!(folder.journal().record.runner_death().is_some());
    assert_eq!(folder.rtf(&["show", "latest"]).code, Some(5));
    assert!(nothing_left(&folder));
}

#[test]
fn a_request_to_end_lets_a_stopped_runner_end_in_order() {
    let folder = Folder::new();
    let running = start(&folder, PATIENT, "<test type='python'>T</test>", &[]);
    send(running.runner(), "STOP");
    running.signal("INT");
    assert_eq!(running.finish().code, Some(130));
    let journal = folder.journal();
    assert_eq!(journal.record.interrupted(), Some("SIGINT"));
    let stopped =
        |kind: &EventKind| matches!(kind, EventKind::FixtureStopped { problem: None, .. });
    assert!(journal.events.iter().any(|event| stopped(&event.kind)), "torn down in order");
    assert_eq!(folder.read("parked"), "interrupt\n");
    assert!(nothing_left(&folder));
}

/// All that it has to be told does not fit into a socket.
#[test]
fn a_guard_that_was_stopped_for_a_while_changes_nothing() {
    let folder = Folder::new();
    let test = "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        pass\n";
    let many = "<test type='python' isolation='shared' repetition='600'>T</test>";
    let running = start(&folder, test, many, &[]);
    running.signal("STOP");
    running.wait_for(|kind| matches!(kind, EventKind::RunFinished { .. }));
    running.signal("CONT");
    let finished = running.finish();
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert_eq!(folder.read("parked"), "end\n");
    assert!(nothing_left(&folder));
}
