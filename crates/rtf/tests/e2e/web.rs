//! `rtf run --web` and `rtf serve` with a client instead of a browser.

use std::io::{BufRead, BufReader};
use std::net::{SocketAddr, TcpListener};

use rtf_model::{EventKind, Phase, SuiteId, TestId, Verdict};
use serde_json::{Value, json};

use crate::support::{Finished, Folder, Running, nothing_left, wait_until};
use crate::web_client::{Answer, Stream, ask, get};

const PATIENT: &str =
    "function TestCase.run()\n  rtf.report('here')\n  print('<b>')\n  rtf.sleep(1000)\nend\n";
const QUICK: &str = "function TestCase.run() rtf.check(true, 'fine') end\n";
const PARK: &str = "<hook name='park' on='interrupt'><command>true</command></hook>";

/// A run that is in a browser, and the browser's way to it.
pub struct Web {
    running: Running,
    pub address: SocketAddr,
    token: String,
    /// What was said before the address.
    before: Vec<String>,
}

impl Web {
    pub fn start(folder: &Folder, args: &[&str]) -> Self {
        Self::of(folder.start(args))
    }

    pub fn of(mut running: Running) -> Self {
        let err = running.child.stderr.take().expect("standard error");
        let mut before = Vec::new();
        let mut lines = BufReader::new(err).lines();
        loop {
            let line = lines.next().expect("an address").expect("a line");
            let Some((_, rest)) = line.split_once("://") else {
                before.push(line);
                continue;
            };
            let (host, token) = rest.split_once('/').expect("a path");
            let token = token.strip_prefix("#token=").unwrap_or_default().to_owned();
            let address = host.parse().expect("an address");
            return Self { running, address, token, before };
        }
    }

    fn post(&self, path: &str) -> Answer {
        self.post_to("current", path)
    }

    pub fn post_to(&self, run: &str, path: &str) -> Answer {
        let bearer = format!("Authorization: Bearer {}", self.token);
        ask(self.address, &format!("POST /api/v1/runs/{run}{path}"), &[&bearer], "")
    }

    /// Waits for the end of the run.
    pub fn finish(self) -> Finished {
        self.running.finish()
    }

    /// Ends the server with a signal.
    pub fn end(self, signal: &str) -> Finished {
        self.running.signal(signal);
        self.running.finish()
    }

    pub fn events(&self, query: &str) -> Stream {
        Stream::open(self.address, &format!("/api/v1/runs/current/events{query}"), &[])
    }
}

/// Two suites; the first has a test that waits until it is stopped.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("wait.lua", PATIENT).file("quick.lua", QUICK);
    let first = format!(
        "<suite name='first'><test type='lua' name='wait' repetition='3'>wait.lua</test><test type='lua'>quick.lua</test>{PARK}</suite>"
    );
    let second = first.replace("name='first'", "name='second'");
    folder.file("first.xml", &first).file("second.xml", &second);
    folder
}

/// Reads on until the first test runs.
pub fn until_test_runs(events: &mut Stream, test: u32) {
    let runs = json!({"type": "test-phase", "phase": "run", "test": test});
    let is = |data: &Value| runs.as_object().expect("fields").iter().all(|(k, v)| data[k] == *v);
    while !is(&events.next_event().data) {}
}

#[test]
fn a_live_run_is_watched_and_controlled_to_its_end() {
    let folder = folder();
    let web = Web::start(&folder, &["run", "--web=127.0.0.1:0", "first.xml", "second.xml"]);
    let mut events = web.events("?from=0&details=none");
    until_test_runs(&mut events, 0);
    let server = get(web.address, "/api/v1").json();
    assert_eq!((&server["mode"], &server["control"]), (&json!("run"), &json!(true)));
    assert_eq!(web.post("/tests/1/stop").status, 409, "it does not run");
    assert_eq!(web.post("/tests/0/stop").status, 202);
    until_test_runs(&mut events, 2);
    assert_eq!(web.post("/suites/1/skip").status, 202);
    let rest = events.rest();
    assert_eq!(rest.last().map(|sent| &sent.data), Some(&json!({"state": "finished"})));
    assert_eq!(web.running.finish().code, Some(1));
    let record = folder.journal().record;
    let verdicts: Vec<_> = (0..4).map(|test| record.verdict(TestId(test))).collect();
    let wanted = [Verdict::Interrupted, Verdict::Passed, Verdict::Interrupted, Verdict::Skipped];
    assert_eq!(verdicts, wanted.map(Some));
    assert_eq!(record.tests[0].attempts.len(), 1, "the other repetitions were skipped");
    assert_eq!(
        record.tests[0].reason(),
        Some("stopped by a person, in the browser"),
        "who stopped it is told"
    );
    let parked: Vec<_> = record.hooks.iter().map(|hook| hook.runs.len()).collect();
    assert_eq!(parked, [1, 1], "the robot was parked each time");
    assert!(nothing_left(&folder));
}

#[test]
fn a_run_is_stopped_as_with_ctrl_c() {
    let folder = folder();
    let web = Web::start(&folder, &["run", "--web=127.0.0.1:0", "first.xml", "second.xml"]);
    let mut events = web.events("?from=0");
    until_test_runs(&mut events, 0);
    assert_eq!(web.post("/stop").status, 202);
    let rest = events.rest();
    assert_eq!(rest.last().map(|sent| &sent.data), Some(&json!({"state": "interrupted"})));
    assert_eq!(web.running.finish().code, Some(1));
    let record = folder.journal().record;
    assert_eq!(record.interrupted(), Some("a person, in the browser"));
    assert_eq!(record.totals().of(Verdict::Skipped), 3);
    assert!(nothing_left(&folder));
}

#[test]
fn a_suite_that_has_not_begun_is_skipped_when_its_turn_comes() {
    let folder = folder();
    let web = Web::start(&folder, &["run", "--web=127.0.0.1:0", "first.xml", "second.xml"]);
    let mut events = web.events("?from=0&details=none");
    until_test_runs(&mut events, 0);
    assert_eq!(web.post("/suites/1/skip").status, 202);
    assert_eq!(web.post("/tests/0/stop").status, 202);
    events.rest();
    web.running.finish();
    let journal = folder.journal();
    let of_second =
        |kind: &EventKind| matches!(kind, EventKind::TestStarted { test, .. } if test.0 > 1);
    assert!(!journal.events.iter().any(|event| of_second(&event.kind)));
    let skipped = journal.record.suite_totals(SuiteId(1)).of(Verdict::Skipped);
    assert_eq!(skipped, 2);
}

#[test]
fn another_port_is_taken_when_one_is_not_free() {
    let folder = Folder::new();
    folder.file("quick.lua", QUICK);
    let taken = TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = taken.local_addr().expect("its address").port();
    let web = Web::start(&folder, &["run", &format!("--web={port}"), "quick.lua"]);
    assert_ne!(web.address.port(), port);
    assert_eq!(
        web.before,
        [format!("web: port {port} is in use, using port {}", web.address.port())]
    );
    assert_eq!(web.running.finish().code, Some(0));
}

#[test]
fn the_predecessors_program_shows_its_run_at_the_port_that_it_is_told() {
    let folder = folder();
    let taken = TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = taken.local_addr().expect("its address").port();
    let given = ["-s", "first.xml", "-w", "--web-port", &port.to_string(), "--no-output"];
    let web = Web::of(folder.start_command(folder.testrunner_command(&given)));
    assert!(web.address.ip().is_loopback() && web.address.port() != port);
    let used = format!("web: port {port} is in use, using port {}", web.address.port());
    assert_eq!(web.before, [used]);
    let status = wait_until("a test that runs", || {
        let status = get(web.address, "/status").json();
        (status["testStatus"][0] == 1).then_some(status)
    });
    assert_eq!(status, json!({"name": "first", "testStatus": [1, 0]}));
    let mut events = web.events("?from=0&details=none");
    until_test_runs(&mut events, 0);
    assert_eq!(web.post("/tests/0/stop").status, 202);
    assert_eq!(events.rest().last().map(|sent| &sent.data), Some(&json!({"state": "finished"})));
    let finished = web.running.finish();
    assert_eq!(finished.code, Some(1));
    assert!(finished.stdout.contains("Number of passed test cases  : 1\n"), "{}", finished.stdout);
    assert!(!folder.path().join("rtf-results").exists(), "nothing is kept");
    assert!(nothing_left(&folder));
}

#[test]
fn what_is_not_allowed_starts_nothing() {
    let folder = Folder::new();
    folder.file("quick.lua", QUICK).file("token", "short\n");
    insta::assert_snapshot!(folder.shown(&folder.rtf(&["run", "--web=0.0.0.0:0", "quick.lua"])), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: `0.0.0.0` can be reached from beyond this machine
    hint: `--web-allow-remote` allows that: reading then needs the token, and TLS is used
    ");
    let private = std::os::unix::fs::PermissionsExt::from_mode(0o600);
    std::fs::set_permissions(folder.path().join("token"), private).expect("permissions");
    let weak = ["run", "--web=0", "--web-token-file", "token", "quick.lua"];
    insta::assert_snapshot!(folder.shown(&folder.rtf(&weak)), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: the token in `token` is not one line of at least 16 visible ASCII characters
    ");
    insta::assert_snapshot!(folder.shown(&folder.rtf(&["serve"])), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: there is no results directory `rtf-results`
    hint: choose another directory with `--results DIR`, or run something first
    ");
    assert!(!folder.path().join("rtf-results").exists());
}

/// Another process follows the journal of a run that knows nothing of it.
#[test]
fn serve_follows_a_run_that_goes_on_and_tells_of_one_that_was_killed() {
    let folder = folder();
    let running = folder.start(&["run", "first.xml"]);
    running.wait_for(|kind| matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. }));
    let web = Web::start(&folder, &["serve", "--web", "127.0.0.1:0"]);
    let mut events = web.events("?from=0&details=none");
    until_test_runs(&mut events, 0);
    let server = get(web.address, "/api/v1").json();
    assert_eq!((&server["mode"], &server["control"]), (&json!("serve"), &json!(true)));
    assert_eq!(server["controlled"], Value::Null, "it is not its run");
    assert!(server["current"].is_string(), "{server}");
    let path = "/api/v1/runs/current/tests/0/attempts/1/messages";
    let said =
        wait_until("a message", || get(web.address, path).json()["messages"].get(0).cloned());
    assert_eq!(said["message"]["text"], "here");
    running.kill_runner();
    let rest = events.rest();
    assert_eq!(rest.last().map(|sent| &sent.data), Some(&json!({"state": "died"})));
    running.finish();
    let runs = get(web.address, "/api/v1/runs");
    assert_eq!(runs.header("content-type"), Some("application/json"));
    let runs = runs.json();
    let run = &runs["runs"][0];
    assert_eq!((&run["state"], &run["green"]), (&json!("died"), &json!(false)));
    assert_eq!(run["totals"]["verdicts"]["interrupted"], 1, "{run}");
    assert_eq!(get(web.address, "/api/v1/runs/current").status, 404);
    assert_eq!(web.end("TERM").code, Some(143));
}

#[test]
fn serve_takes_a_results_directory_or_a_run_in_it() {
    let folder = Folder::new();
    folder.file("quick.lua", QUICK);
    assert_eq!(folder.rtf(&["run", "--results", "out", "quick.lua"]).code, Some(0));
    for dir in ["out", "out/latest"] {
        let web = Web::start(&folder, &["serve", dir, "--web", "127.0.0.1:0"]);
        let runs = get(web.address, "/api/v1/runs").json();
        assert_eq!(runs["runs"].as_array().map(Vec::len), Some(1), "{runs}");
        assert_eq!(web.end("TERM").code, Some(143));
    }
}
