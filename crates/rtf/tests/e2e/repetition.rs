//! Repetitions and retries of tests.

use insta::assert_snapshot;

use crate::support::Folder;

/// Fails as often as the file `left` says.
const FLAKY: &str = "TestCase = {}\nfunction TestCase.run()\n  local file = io.open('left')\n  \
                     local left = tonumber(file:read('a'))\n  file:close()\n  \
                     if left > 0 then\n    file = io.open('left', 'w')\n    file:write(left - 1)\n    \
                     file:close()\n    rtf.fail('not yet')\n  end\nend\n";

fn folder(fails: u32, attributes: &str) -> Folder {
    let folder = Folder::new();
    folder.file("Flaky.lua", FLAKY).file("left", &fails.to_string());
    folder.file("P.lua", "TestCase = {}\nfunction TestCase.run() end\n");
    let tests = format!("  <test {attributes}>Flaky.lua</test>\n  <test>P.lua</test>\n");
    folder.file("s.xml", &format!("<suite>\n{tests}</suite>\n"));
    folder
}

#[test]
fn a_retry_that_passes_is_flaky() {
    let folder = folder(1, "retries='2' retry-delay='1ms'");
    let finished = folder.rtf(&["run", "s.xml", "--report", "junit=j.xml"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 0
    ----- stdout
    suite s  2 tests  s.xml
         failed     [TIME]  s/Flaky, will be retried
                 failure: not yet
                   at [FOLDER]/Flaky.lua:10
         passed     [TIME]  s/Flaky, attempt 2
         passed     [TIME]  s/P

    flaky tests, which passed only after a retry:
      s/Flaky  2 attempts
        before  failed: not yet

    results: rtf-results/[RUN]
    PASSED  2 tests in 1 suite, [TIME]: 2 passed (1 flaky)
    ----- stderr
    ");
    let junit = std::fs::read_to_string(folder.path().join("j.xml")).expect("a report");
    assert!(junit.contains("flakyFailure"), "{junit}");
}

#[test]
fn flaky_can_be_red() {
    let folder = folder(1, "");
    let args =
        ["run", "s.xml", "--retries", "1", "--flaky-result", "fail", "--report", "junit=j.xml"];
    let finished = folder.rtf(&args);
    assert_eq!(finished.code, Some(1), "{}", finished.stdout);
    let junit = std::fs::read_to_string(folder.path().join("j.xml")).expect("a report");
    assert!(junit.contains("type=\"flaky\"") && junit.contains("failures=\"1\""), "{junit}");
    // What the past run was asked for holds for `show` too.
    assert_eq!(folder.rtf(&["show"]).code, Some(1));
}

#[test]
fn retries_that_all_fail_are_a_failure() {
    let folder = folder(9, "retries='1'");
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 1
    ----- stdout
    suite s  2 tests  s.xml
         failed     [TIME]  s/Flaky, will be retried
                 failure: not yet
                   at [FOLDER]/Flaky.lua:10
         failed     [TIME]  s/Flaky, attempt 2
                 failure: not yet
                   at [FOLDER]/Flaky.lua:10
         passed     [TIME]  s/P

    tests that did not pass:
      s/Flaky  failed
        reason  not yet
        at      [FOLDER]/Flaky.lua:10
        rerun   rtf run s.xml::Flaky

    results: rtf-results/[RUN]
    FAILED  2 tests in 1 suite, [TIME]: 1 passed, 1 failed
    ----- stderr
    ");
    assert_eq!(folder.journal().record.tests[0].attempts.len(), 2);
}

#[test]
fn many_repetitions_are_summed_up() {
    let folder = folder(3, "repetition='5'");
    let finished = folder.rtf(&["run", "--repeat", "4", "s.xml::Flaky"]);
    assert_eq!(finished.code, Some(1));
    assert!(finished.stdout.contains("s/Flaky  17 of 20 passed (85.0 %)"), "{}", finished.stdout);
    assert!(finished.stdout.contains(", 95 % "), "{}", finished.stdout);
}

#[test]
fn a_time_is_filled_with_rounds() {
    let folder = folder(0, "repetition='2'");
    let began = std::time::Instant::now();
    let finished = folder.rtf(&["run", "--for", "1s", "s.xml", "P.lua", "--report", "tap=t.tap"]);
    assert!(began.elapsed() >= std::time::Duration::from_secs(1));
    assert_eq!(finished.code, Some(0), "{}", finished.stdout);
    let record = folder.journal().record;
    let [flaky, quick, alone] = [0, 1, 2].map(|test| record.tests[test].attempts.len());
    assert!(quick > 1 && alone > 1, "both suites had their part: {quick}, {alone}");
    assert_eq!(flaky, 2 * quick, "a round comes to its end");
    let rate = format!("s/P  {quick} of {quick} passed (100.0 %)");
    assert!(finished.stdout.contains(&rate), "{}", finished.stdout);
    // One word on each test, when it is known.
    let tap = std::fs::read_to_string(folder.path().join("t.tap")).expect("a report");
    assert_eq!(tap.matches("ok ").count(), 5, "{tap}");
    let again = folder.rtf(&["show"]);
    assert!(again.stdout.contains(&rate), "{}", again.stdout);
}

#[test]
fn the_first_failure_ends_the_time() {
    let folder = folder(1, "");
    let finished = folder.rtf(&["run", "--for", "1h", "--until-fail", "s.xml"]);
    assert_eq!(finished.code, Some(1), "{}", finished.stdout);
    assert_eq!(folder.journal().record.tests[0].attempts.len(), 1);
    assert!(finished.stdout.contains("s/P: 1 test has not passed"), "{}", finished.stdout);
}

/// Answers each connection; with `leak`, it keeps the connection, a MiB, and a process.
const SERVER: &str = r#"
import socket, subprocess, sys
kept = []
server = socket.socket(socket.AF_UNIX)
server.bind("server.sock")
server.listen()
print("up", flush=True)
while True:
    client, _ = server.accept()
    client.recv(1)
    if "leak" in sys.argv:
        kept.append((client.dup(), bytearray(b"x" * (1 << 20)), subprocess.Popen(["sleep", "1000"])))
    client.sendall(b"!")
    client.close()
"#;

const CLIENT: &str = r#"
import socket
import rtf

class Client(rtf.TestCase):
    def run(self):
        with socket.socket(socket.AF_UNIX) as server:
            server.connect("server.sock")
            server.sendall(b"?")
            self.check(server.recv(1) == b"!", "an answer")
"#;

fn served(argument: &str) -> Folder {
    let folder = Folder::new();
    folder.file("server.py", SERVER).file("Client.py", CLIENT);
    let command = format!("<command>python3 server.py {argument}</command><ready log='^up$'/>");
    let fixture = format!("<fixture name='server' type='process'>{command}</fixture>");
    folder
        .file("s.xml", &format!("<suite>{fixture}<test repetition='20'>Client.py</test></suite>"));
    folder
}

#[test]
fn a_fixture_that_leaks_is_shown() {
    let folder = served("leak");
    let finished = folder.rtf(&["run", "s.xml", "--report", "junit=j.xml"]);
    assert_eq!(finished.code, Some(0), "{}", finished.stdout);
    let lines: Vec<_> = finished.stdout.lines().filter(|line| line.contains(" a test: ")).collect();
    let [memory, descriptors, processes] = lines[..] else { panic!("{}", finished.stdout) };
    // Each `sleep` has a little memory, and three descriptors, too.
    assert!(memory.contains("server  memory grows by 1."), "{memory}");
    assert!(descriptors.contains("open file descriptors grow by 4 a test"), "{descriptors}");
    assert!(
        processes.contains("processes grow by 1 a test: from 6 to 21 in 15 tests"),
        "{processes}"
    );
    let record = folder.journal().record;
    assert_eq!(record.fixtures[0].lives[0].usage.seen(), 20);
    let junit = std::fs::read_to_string(folder.path().join("j.xml")).expect("a report");
    assert!(junit.contains(r#"name="growth.server.processes" value="1""#), "{junit}");
    let text = folder.rtf(&["report", "--format", "text"]);
    assert!(text.stdout.contains("processes grow by 1 a test"), "{}", text.stdout);
}

#[test]
fn a_fixture_that_does_not_leak_is_not_shown() {
    let folder = served("");
    let finished = folder.rtf(&["run", "s.xml", "--repeat", "3"]);
    assert_eq!(finished.code, Some(0), "{}", finished.stdout);
    assert_eq!(folder.journal().record.fixtures[0].lives[0].usage.seen(), 60);
    assert!(!finished.stdout.contains("grow"), "{}", finished.stdout);
}

/// With `leak`, it keeps a MiB and a descriptor in its process.
const SHARED: &str = r#"
import os
import sys
import rtf

kept = sys.__dict__.setdefault("kept", [])

class Shared(rtf.TestCase):
    def setup(self, args):
        self.leaks = "leak" in args

    def run(self):
        if self.leaks:
            kept.append((os.open("/dev/null", os.O_RDONLY), bytearray(b"x" * (1 << 20))))
        if len(kept) == 12 and not os.path.exists("replaced"):
            open("replaced", "w").close()
            self.fail("its host ends with it")
"#;

fn shared(tests: &str) -> Folder {
    let folder = Folder::new();
    folder.file("Leak.py", SHARED).file("s.xml", &format!("<suite>{tests}</suite>"));
    folder
}

#[test]
fn a_shared_host_that_leaks_is_shown() {
    let folder = shared(
        "<test isolation='shared' repetition='30' param='leak'>Leak.py</test>\
         <test isolation='shared' name='Other'>Leak.py</test>",
    );
    folder.file("replaced", "");
    let finished = folder.rtf(&["run", "s.xml", "--report", "junit=j.xml"]);
    assert_eq!(finished.code, Some(0), "{}", finished.stdout);
    let record = folder.journal().record;
    let [host] = &record.suites[0].hosts[..] else { panic!("{:?}", record.suites[0].hosts) };
    // `Other` is the last one: the host ended with it.
    assert_eq!((host.tests_served, host.usage.seen(), host.tests.len()), (30, 30, 1));
    let title = "shared hosts that grow while tests are repeated:\n";
    let (_, shown) = finished.stdout.split_once(title).expect("growth is shown");
    let mut lines = shown.lines();
    assert_eq!(lines.next(), Some("  host of s/Leak (shared, measured after 30 tests)"));
    let memory = lines.next().unwrap_or_default();
    assert!(memory.starts_with("    memory grows by 1"), "{memory}");
    let descriptors = lines.next().unwrap_or_default();
    assert!(
        descriptors.starts_with("    open file descriptors grow by 1 a test: from "),
        "{shown}"
    );
    assert_eq!(lines.next(), Some(""), "there is one process: {shown}");
    let junit = std::fs::read_to_string(folder.path().join("j.xml")).expect("a report");
    let property = r#"name="growth.host of Leak.descriptors" value="1""#;
    assert!(junit.contains(property), "{junit}");
    let text = folder.rtf(&["report", "--format", "text"]);
    let told = "  grows: host of Leak (shared, measured after 30 tests)\n    memory grows by 1";
    assert!(text.stdout.contains(told), "{}", text.stdout);
}

#[test]
fn a_shared_host_that_does_not_leak_is_not_shown() {
    let folder = shared("<test isolation='shared' repetition='30'>Leak.py</test>");
    folder.file("replaced", "");
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}", finished.stdout);
    assert_eq!(folder.journal().record.suites[0].hosts[0].usage.seen(), 29);
    assert!(!finished.stdout.contains("grow"), "{}", finished.stdout);
}

#[test]
fn a_host_that_is_replaced_begins_anew() {
    let folder = shared("<test isolation='shared' repetition='40' param='leak'>Leak.py</test>");
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(1), "{}", finished.stdout);
    let record = folder.journal().record;
    let seen: Vec<_> = record.suites[0].hosts.iter().map(|host| host.usage.seen()).collect();
    assert_eq!(seen, [11, 27], "the twelfth failed, the last one's host ended");
    let told = "host of s/Leak (shared, measured after 27 tests)";
    assert_eq!(finished.stdout.matches("host of").count(), 1, "{}", finished.stdout);
    assert!(finished.stdout.contains(told), "{}", finished.stdout);
}

#[test]
fn enough_is_enough() {
    let folder = folder(9, "repetition='3'");
    let plug_in = "Flaky.lua";
    let all = folder.rtf(&["run", "--max-fail", "2", "s.xml", plug_in, "P.lua"]);
    assert_snapshot!(folder.shown(&all), @"
    exit code 1
    ----- stdout
    suite s  2 tests  s.xml
         failed     [TIME]  s/Flaky (1 of 3)
                 failure: not yet
                   at [FOLDER]/Flaky.lua:10
         failed     [TIME]  s/Flaky (2 of 3)
                 failure: not yet
                   at [FOLDER]/Flaky.lua:10
         failed     [TIME]  s/Flaky (3 of 3)
                 failure: not yet
                   at [FOLDER]/Flaky.lua:10
         passed     [TIME]  s/P
    suite plug-ins  2 tests
         failed     [TIME]  plug-ins/Flaky
                 failure: not yet
                   at [FOLDER]/Flaky.lua:10
        skipped              plug-ins/P: 2 tests have not passed (--max-fail 2)

    tests that did not pass:
      s/Flaky  failed
        reason  not yet
        at      [FOLDER]/Flaky.lua:10
        rerun   rtf run s.xml::Flaky
      plug-ins/Flaky  failed
        reason  not yet
        at      [FOLDER]/Flaky.lua:10
        rerun   rtf run [FOLDER]/Flaky.lua

    repeated tests:
      s/Flaky  0 of 3 passed (0.0 %)
        time    min [TIME], mean [TIME], 95 % [TIME], max [TIME]

    skipped tests:
      1 test: 2 tests have not passed (--max-fail 2)
        plug-ins/P

    results: rtf-results/[RUN]
    FAILED  4 tests in 2 suites, [TIME]: 1 passed, 2 failed, 1 skipped
    ----- stderr
    ");
    let first = folder.rtf(&["run", "--until-fail", "--repeat", "100", "s.xml"]);
    assert_eq!(first.code, Some(1));
    assert_eq!(folder.journal().record.tests[0].attempts.len(), 1, "{}", first.stdout);
}

/// A critical test or a critical assertion ends the suite, or the run if the suite says so.
#[test]
fn what_is_critical_ends_the_suite_or_the_run() {
    let assertion = "function TestCase.run() rtf.require_critical(false, 'it is hot') end";
    let fails = "function TestCase.run() rtf.fail('no') end";
    for (plugin, attribute, why) in [
        (assertion, "", "a critical assertion of `A` did not hold: it is hot"),
        (fails, "critical='true'", "the critical test `A` did not pass: it is failed"),
    ] {
        for (stops, whole) in [("", false), ("critical-stops='run'", true)] {
            let folder = Folder::new();
            folder.file("A.lua", plugin).file("P.lua", "function TestCase.run() end");
            let first = format!(
                "<suite name='first' {stops}><test {attribute}>A.lua</test><test>P.lua</test></suite>"
            );
            folder.file("first.xml", &first);
            folder.file("second.xml", "<suite name='second'><test>P.lua</test></suite>");
            let finished = folder.rtf(&["run", "first.xml", "second.xml"]);
            assert_eq!(finished.code, Some(1), "{}", finished.stdout);
            let record = folder.journal().record;
            let skipped = |test: usize| record.tests[test].skipped.clone();
            assert_eq!(skipped(1).as_deref(), Some(why));
            let of_run = format!("suite `first` ends the run: {why}");
            assert_eq!(skipped(2), whole.then_some(of_run), "{}", finished.stdout);
        }
    }
}
