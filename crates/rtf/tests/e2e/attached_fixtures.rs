//! `attach="true"`: running programs are monitored, and neither started nor stopped.

use std::net::TcpStream;
use std::process::{Child, Command, Stdio};

use rtf_model::{EventKind, Phase, TestId, Verdict};

use crate::support::{Folder, free_port, nothing_left, wait_until};

/// A robot that was there before: a web server in a folder of its own.
struct Robot {
    server: Child,
    port: u16,
    _folder: tempfile::TempDir,
}

impl Robot {
    fn at(port: u16) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let server = Command::new("python3")
            .args(["-m", "http.server", &port.to_string(), "--bind", "127.0.0.1"])
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("python3");
        let robot = Self { server, port, _folder: folder };
        wait_until("the server", || robot.is_there().then_some(()));
        robot
    }

    fn is_there(&self) -> bool {
        TcpStream::connect(("127.0.0.1", self.port)).is_ok()
    }
}

impl Drop for Robot {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// Waits the first time, and passes when it runs again.
const TEST: &str = "import os, rtf\nclass T(rtf.TestCase):\n    def run(self):\n        again = os.path.exists('seen')\n        open('seen', 'w').close()\n        self.sleep(0 if again or self.param else 60)\n";

fn folder(port: u16, more: &str, param: &str) -> Folder {
    let folder = Folder::new();
    folder.file("T.py", TEST);
    folder.file(
        "s.xml",
        &format!(
            "<suite name='s' after-collapse='rerun'>\n  <fixture type='process' name='robot' attach='true' check-every='20ms' {more}>\n    \
             <ready http='http://127.0.0.1:{port}/'/>\n  </fixture>\n  \
             <test type='python' param='{param}'>T</test>\n</suite>\n"
        ),
    );
    folder
}

fn is_in_run(kind: &EventKind) -> bool {
    matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. })
}

#[test]
fn what_runs_already_is_used_and_left_alone() {
    let robot = Robot::at(free_port());
    let folder = folder(robot.port, "", "short");
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert!(robot.is_there(), "it was not stopped");
    assert!(nothing_left(&folder));
}

#[test]
fn it_is_waited_for_when_it_goes_and_comes_back() {
    let robot = Robot::at(free_port());
    let port = robot.port;
    let folder = folder(port, "timeout='30s'", "");
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(is_in_run);
    drop(robot);
    running.wait_for(|kind| matches!(kind, EventKind::FixtureStarting { attempt: 2, .. }));
    let _robot = Robot::at(port);
    let finished = running.finish();
    assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
    let record = folder.journal().record;
    let verdicts: Vec<_> = record.tests[0].attempts.iter().filter_map(|a| a.verdict()).collect();
    assert_eq!(verdicts, [Verdict::Collapsed, Verdict::Passed]);
    let (_, reason) = &record.fixtures[0].collapses[0];
    assert!(reason.contains(&format!("http://127.0.0.1:{port}/")), "{reason}");
}

#[test]
fn one_that_is_not_there_is_told_with_what_was_asked() {
    let port = free_port();
    let folder = folder(port, "timeout='1s'", "");
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    let record = folder.journal().record;
    assert_eq!(record.verdict(TestId(0)), Some(Verdict::Skipped));
    let broken = record.fixtures[0].broken.clone().expect("broken");
    let start = format!(
        "set-up failed: it was not ready within 1s: no answer from http://127.0.0.1:{port}/"
    );
    assert!(broken.starts_with(&start), "{broken}");
}

#[test]
fn ctrl_c_leaves_it_alone() {
    let robot = Robot::at(free_port());
    let folder = folder(robot.port, "", "");
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(is_in_run);
    running.signal("INT");
    assert_eq!(running.finish().code, Some(130));
    assert!(robot.is_there(), "it was not stopped");
    let record = folder.journal().record;
    assert!(record.fixtures[0].problems.is_empty(), "{:?}", record.fixtures[0].problems);
    assert!(nothing_left(&folder));
}
