//! The built-in `type="process"` fixture with real processes.

use std::net::TcpListener;

use rtf_model::{EventKind, TestId, Verdict};

use crate::support::{Folder, free_port, nothing_left};

/// A server: port, then what it should do.
const SERVER: &str = "import http.server, os, signal, sys, threading, time\n\
port, mode = int(sys.argv[1]), sys.argv[2:]\n\
class H(http.server.BaseHTTPRequestHandler):\n    def do_GET(self):\n        self.send_response(503 if 'unwell' in mode and os.path.exists('go') else 200)\n        self.end_headers()\n    def log_message(self, *_): pass\n\
def stop(*_):\n    open('stopped', 'w').write('yes')\n    sys.exit(0)\n\
signal.signal(signal.SIGINT if 'int' in mode else signal.SIGTERM, stop)\n\
if 'stubborn' in mode:\n    signal.signal(signal.SIGTERM, signal.SIG_IGN)\n\
if 'dies' in mode:\n    print('the arm is not connected', flush=True)\n    sys.exit(3)\n\
server = http.server.HTTPServer(('127.0.0.1', port), H)\n\
if 'fatal' in mode:\n    def fatal():\n        while not os.path.exists('go'):\n            time.sleep(0.005)\n        print('FATAL: motor 3', flush=True)\n    threading.Thread(target=fatal, daemon=True).start()\n\
print('serving on', port, flush=True)\n\
server.serve_forever()\n";

const TEST: &str = "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        open('go', 'w').close()\n        self.sleep(float(self.param))\n";

fn folder(mode: &str, probes: &str, seconds: &str) -> (Folder, u16) {
    let folder = Folder::new();
    let port = free_port();
    folder.file("server.py", SERVER).file("T.py", TEST);
    let probes = probes.replace("PORT", &port.to_string());
    folder.file(
        "s.xml",
        &format!(
            "<suite name='s'>\n  <fixture type='process' name='server' timeout='10s' restarts='0'>\n    \
             <command>python3 server.py {port} {mode}</command>\n    {probes}\n  </fixture>\n  \
             <test type='python' param='{seconds}'>T</test>\n</suite>\n"
        ),
    );
    (folder, port)
}

#[test]
fn every_kind_of_probe_makes_it_ready_and_its_signal_stops_it() {
    let probes = "<ready tcp='127.0.0.1:PORT'/><ready http='http://127.0.0.1:PORT/'/><ready log='^serving'/>\
                  <ready command='test -d .'/><alive tcp='127.0.0.1:PORT' every='50ms'/><stop signal='SIGINT' grace='5s'/>";
    let (folder, _) = folder("int", probes, "0.2");
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    assert_eq!(std::fs::read_to_string(folder.path().join("stopped")).expect("a file"), "yes");
    assert!(nothing_left(&folder));
}

#[test]
fn a_death_before_ready_fails_at_once_with_its_last_lines() {
    let (folder, _) = folder("dies", "<ready tcp='127.0.0.1:PORT'/>", "0");
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(1));
    let record = folder.journal().record;
    assert_eq!(record.verdict(TestId(0)), Some(Verdict::Skipped));
    assert_eq!(
        record.fixtures[0].broken.as_deref(),
        Some(
            "set-up failed: it ended with exit code 3 before it was ready; its last line was: the arm is not connected"
        )
    );
    assert_eq!(record.fixtures[0].log_tail, ["the arm is not connected"]);
    assert!(finished.stdout.contains("the arm is not connected"), "{}", finished.stdout);
}

#[test]
fn an_alive_probe_that_fails_is_a_collapse() {
    let probes = "<ready tcp='127.0.0.1:PORT'/><alive http='http://127.0.0.1:PORT/' every='20ms'/>";
    let (folder, _) = folder("unwell", probes, "60");
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    let record = folder.journal().record;
    assert_eq!(record.verdict(TestId(0)), Some(Verdict::Collapsed));
    assert!(
        record.tests[0].reason().expect("a reason").contains("503"),
        "{:?}",
        record.tests[0].reason()
    );
}

#[test]
fn a_bad_line_in_its_log_is_a_collapse() {
    let probes = "<ready log='serving'/><alive log-bad='^FATAL'/>";
    let (folder, _) = folder("fatal", probes, "60");
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    let record = folder.journal().record;
    assert_eq!(
        record.tests[0].reason(),
        Some("fixture `server` collapsed: it printed `FATAL: motor 3`")
    );
}

#[test]
fn one_that_ignores_its_signal_is_killed_and_that_is_told() {
    let (folder, _) = folder("stubborn", "<ready log='serving'/><stop grace='200ms'/>", "0");
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    let record = folder.journal().record;
    assert_eq!(record.verdict(TestId(0)), Some(Verdict::Passed));
    assert_eq!(record.fixtures[0].problems[0].1, "it did not stop within 200ms and was killed");
    assert!(nothing_left(&folder));
}

#[test]
fn somebody_elses_server_is_not_taken_for_the_fixture() {
    let (folder, port) = folder("", "<ready tcp='127.0.0.1:PORT'/>", "0");
    let _taken = TcpListener::bind(("127.0.0.1", port)).expect("the port");
    assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
    let record = folder.journal().record;
    let broken = record.fixtures[0].broken.clone().expect("broken");
    assert!(broken.contains("answers already"), "{broken}");
}

#[test]
fn a_file_from_before_the_start_does_not_make_it_ready() {
    // The clock may have been set back since it was written.
    for time in ["1 hour ago", "now", "1 hour"] {
        let (folder, _) = folder("", "<ready file='ready.txt'/>", "0");
        folder.file("ready.txt", "old");
        let suite = std::fs::read_to_string(folder.path().join("s.xml")).expect("the suite");
        folder.file("s.xml", &suite.replace("timeout='10s'", "timeout='500ms'"));
        let old = std::process::Command::new("touch")
            .args(["-d", time, "ready.txt"])
            .current_dir(folder.path())
            .status();
        assert!(old.expect("touch").success());
        assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(1));
        let broken = folder.journal().record.fixtures[0].broken.clone().expect("broken");
        assert!(broken.starts_with("set-up failed: it was not ready within 500ms: "), "{broken}");
        assert!(broken.ends_with("ready.txt is from before the start"), "{broken}");
    }
}

/// A file system's times, or a clock that is set, may say that it is older.
#[test]
fn a_file_that_is_written_after_the_start_makes_it_ready_whatever_its_time() {
    let folder = Folder::new();
    folder.file("ready.txt", "old").file("T.lua", "TestCase = {}\nfunction TestCase.run() end\n");
    folder.file(
        "s.xml",
        "<suite name='s'><fixture type='process' name='f' timeout='20s'>\
         <command>sh -c 'touch -d \"1 hour ago\" ready.txt; exec sleep 1000'</command>\
         <ready file='ready.txt'/></fixture><test>T.lua</test></suite>",
    );
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
}

#[test]
fn a_detached_grandchild_goes_with_its_fixture() {
    let folder = Folder::new();
    folder.file("T.py", TEST);
    folder.file(
        "s.xml",
        "<suite name='s'>\n  <fixture type='process' name='daemon'>\n    \
         <command>bash -c 'setsid sleep 1000 &amp; echo up; exec sleep 1000'</command>\n    <ready log='up'/>\n  \
         </fixture>\n  <test type='python' param='0'>T</test>\n</suite>\n",
    );
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    let journal = folder.journal();
    let left =
        journal.events.iter().any(|event| matches!(event.kind, EventKind::ProcessesLeaked { .. }));
    assert!(!left, "it was asked to stop with its fixture");
    assert!(nothing_left(&folder));
}

#[test]
fn a_command_probe_runs_in_the_suites_folder_with_its_environment_and_may_print() {
    let folder = Folder::new();
    folder.file("sub/T.py", TEST).file("sub/robot.txt", "");
    folder.file(
        "sub/s.xml",
        "<suite name='s'>\n  <env name='ROBOT' value='arm'/>\n  \
         <fixture type='process' name='sleeper' restarts='0'>\n    <command>sleep 1000</command>\n    \
         <ready command=\"sh -c 'echo looking; test -f robot.txt -a $ROBOT = arm'\"/>\n    \
         <alive command=\"sh -c 'echo looking; test -f robot.txt'\" every='10ms'/>\n  \
         </fixture>\n  <test type='python' param='0.1'>T</test>\n</suite>\n",
    );
    let finished = folder.rtf(&["run", "sub/s.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
}
