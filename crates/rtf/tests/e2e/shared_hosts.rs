//! Tests that share a host: each verdict, message, byte of output and leftover process is
//! attributed to the right test.

use std::collections::BTreeMap;

use rtf_model::{Event, EventKind, ExitStatus, Record, Source, Stream, TestId, Verdict};

use crate::support::{Folder, build_cpp, nothing_left, root};

/// Does what its parameter says, and tells its process.
const PYTHON: &str = r#"
import os
import subprocess
import sys
import threading
import time
import rtf


class Shared(rtf.TestCase):
    def setup(self, args):
        self.what = args[0] if args else "pass"

    def run(self):
        self.report(f"pid {os.getpid()}")
        if self.what == "fail":
            self.fail("asked to")
        if self.what == "crash":
            os.abort()
        if self.what == "exit":
            os._exit(0)
        if self.what == "leave":
            script = "sleep 1000 & until read name < /proc/$!/comm && test $name = sleep; do :; done"
            subprocess.Popen(["setsid", "sh", "-c", script]).wait()
        if self.what == "zombie":
            subprocess.Popen(["true"])
            time.sleep(0.05)
        if self.what == "thread":
            with open("armed", "w") as stream:
                stream.write(str(os.getpid()))
            threading.Thread(target=self.end_later, daemon=True).start()
        if self.what == "sleep":
            open("sleeping", "w").close()
            self.sleep(60)
        if self.what == "print":
            for _ in range(50):
                print("out", flush=True)
                print("err", file=sys.stderr, flush=True)
                os.write(1, b"raw\n")

    def end_later(self):
        while not (os.path.exists("sleeping") or os.path.exists("checking")):
            time.sleep(0.01)
        os._exit(7)
"#;

const LUA: &str = r#"
TestCase = {}
function TestCase.run()
  rtf.report("pid " .. io.open("/proc/self/stat"):read("n"))
  count = (count or 0) + 1
  rtf.report("count " .. count)
  io.write("printed without an end")
end
"#;

/// Its check lets the host of the test before end, and waits for that.
const FIXTURE: &str = r#"
import os
import time
import rtf


class Waits(rtf.FixtureManager):
    def check(self):
        if not os.path.exists("armed"):
            return
        with open("armed") as stream:
            pid = stream.read()
        open("checking", "w").close()
        while os.path.exists(f"/proc/{pid}"):
            time.sleep(0.01)
        os.remove("armed")
"#;

fn run(tests: &[(&str, &str)], more: &str, code: i32) -> (Record, Vec<Event>) {
    let folder = Folder::new();
    let mut text = format!("<suite name='s'>\n  {more}\n");
    for (name, rest) in tests {
        text += &format!("  <test isolation='shared' name='{name}' {rest}</test>\n");
    }
    folder.file("T.py", PYTHON).file("T.lua", LUA).file("F.py", FIXTURE);
    folder.file("s.xml", &(text + "</suite>\n"));
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(code), "{}{}", finished.stdout, finished.stderr);
    assert!(nothing_left(&folder), "processes are left");
    let journal = folder.journal();
    (journal.record, journal.events)
}

fn verdicts(record: &Record) -> Vec<Verdict> {
    let tests = (0..record.tests.len()).map(|test| TestId(u32::try_from(test).expect("few")));
    tests.map(|test| record.final_verdict(test)).collect()
}

/// The process that each test ran in; `None` when it did not say.
fn processes(record: &Record) -> Vec<Option<String>> {
    let attempts = record.tests.iter().flat_map(|test| &test.attempts);
    let pid = |text: &str| text.strip_prefix("pid ").map(str::to_owned);
    attempts.map(|attempt| attempt.messages.iter().find_map(|m| pid(&m.text))).collect()
}

/// What each test printed: its standard output, then its standard error, since a
/// line of the one may come between two pieces of a line of the other.
fn printed(events: &[Event]) -> BTreeMap<u32, String> {
    let mut printed = BTreeMap::<u32, [String; 2]>::new();
    for event in events {
        if let EventKind::Output(output) = &event.kind
            && let Source::Test(test) = output.source
        {
            let is_error = usize::from(output.stream == Stream::Stderr);
            printed.entry(test.0).or_default()[is_error] += &output.text;
        }
    }
    printed.into_iter().map(|(test, texts)| (test, texts.concat())).collect()
}

/// Its end takes a while, since its output is held open by something that cannot be
/// found, and it is asked for the next test meanwhile.
#[test]
fn a_host_that_is_asked_for_a_test_while_it_ends_never_hangs_the_run() {
    let folder = Folder::new();
    let plugin = r#"
import os, subprocess, threading, time, rtf
class T(rtf.TestCase):
    def run(self):
        threading.Thread(target=self.end, daemon=True).start()
    def end(self):
        while not os.path.exists(f"checking-{os.getpid()}"):
            time.sleep(0.001)
        subprocess.Popen(["setsid", "env", "-i", "sleep", "2"])
        os._exit(7)
    def tearDown(self):
        with open("pid", "w") as stream:
            stream.write(str(os.getpid()))
"#;
    let fixture = r#"
import os, time, rtf
class F(rtf.FixtureManager):
    def check(self):
        if os.path.exists("pid"):
            with open("pid") as stream:
                pid = stream.read()
            os.rename("pid", f"checking-{pid}")
            while os.path.exists(f"/proc/{pid}"):
                time.sleep(0.001)
"#;
    folder.file("T.py", plugin).file("F.py", fixture);
    let text = "<suite name='s' timeout='30s'><fixture type='python'>F</fixture>\
        <test isolation='shared' type='python' repetition='3'>T</test></suite>";
    folder.file("s.xml", text);
    let finished = folder.rtf(&["run", "s.xml"]);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    let attempts = &folder.journal().record.tests[0].attempts;
    assert_eq!(attempts.len(), 3);
    assert!(finished.stdout.contains("ended between two tests"), "{}", finished.stdout);
}

#[test]
fn tests_that_pass_share_a_process() {
    for plugin in ["T.py", "T.lua"] {
        let rest = format!(">{plugin}");
        let twice = format!("repetition='2'>{plugin}");
        let tests = [("a", rest.as_str()), ("b", twice.as_str()), ("c", rest.as_str())];
        let (record, ..) = run(&tests, "", 0);
        let pids = processes(&record);
        assert_eq!(pids.len(), 4);
        assert!(pids[0].is_some() && pids.iter().all(|pid| *pid == pids[0]), "{pids:?}");
        let last = record.tests[2].attempts[0].finished.as_ref().expect("a finish");
        assert_eq!(last.1.exit, Some(ExitStatus::Code(0)), "the process's end is the last one's");
    }
}

#[test]
fn each_lua_plugin_has_a_state_of_its_own() {
    let (record, ..) = run(&[("a", ">T.lua"), ("b", ">T.lua")], "", 0);
    for test in &record.tests {
        assert!(test.attempts[0].messages.iter().any(|message| message.text == "count 1"));
    }
}

#[test]
fn another_environment_or_type_is_another_process() {
    let env = ">T.py<env name='A' value='1'/>";
    let tests = [("a", ">T.py"), ("b", env), ("c", env), ("d", ">T.lua"), ("e", ">T.py")];
    let pids = processes(&run(&tests, "", 0).0);
    assert_ne!(pids[0], pids[1]);
    assert_eq!(pids[1], pids[2]);
    assert_ne!(pids[2], pids[4]);
}

#[test]
fn what_a_test_prints_is_its_own() {
    let tests: Vec<(String, &str)> = (0..40)
        .map(|n| (format!("t{n}"), if n % 2 == 0 { "param='print'>T.py" } else { ">T.py" }))
        .collect();
    let tests: Vec<(&str, &str)> =
        tests.iter().map(|(name, rest)| (name.as_str(), *rest)).collect();
    let (record, events) = run(&tests, "", 0);
    let pids = processes(&record);
    assert!(pids.iter().all(|pid| *pid == pids[0]), "{pids:?}");
    let printed = printed(&events);
    let expected: Vec<u32> = (0..40).step_by(2).collect();
    assert_eq!(printed.keys().copied().collect::<Vec<_>>(), expected);
    for text in printed.values() {
        for line in ["out\n", "err\n", "raw\n"] {
            assert_eq!(text.matches(line).count(), 50, "{text}");
        }
        assert_eq!(text.len(), 600, "nothing else, and no mark: {text:?}");
    }
}

#[test]
fn a_line_without_an_end_is_its_tests() {
    let (_, events) = run(&[("a", ">T.lua"), ("b", ">T.lua"), ("c", ">T.lua")], "", 0);
    let printed = printed(&events);
    assert_eq!(printed.len(), 3);
    assert!(printed.values().all(|text| text == "printed without an end"), "{printed:?}");
}

#[test]
fn the_end_of_a_host_is_the_fault_of_the_test_that_ran() {
    for what in ["crash", "exit"] {
        let bad = format!("param='{what}'>T.py");
        let (record, ..) = run(&[("a", ">T.py"), ("b", &bad), ("c", ">T.py")], "", 1);
        assert_eq!(verdicts(&record), [Verdict::Passed, Verdict::Crashed, Verdict::Passed]);
        let pids = processes(&record);
        assert_eq!(pids[0], pids[1]);
        assert_ne!(pids[1], pids[2]);
    }
}

#[test]
fn after_a_failure_the_next_test_has_another_process() {
    let tests = [("a", "param='fail'>T.py"), ("b", ">T.py"), ("c", ">T.py")];
    let (record, ..) = run(&tests, "", 1);
    assert_eq!(verdicts(&record), [Verdict::Failed, Verdict::Passed, Verdict::Passed]);
    let pids = processes(&record);
    assert_ne!(pids[0], pids[1]);
    assert_eq!(pids[1], pids[2]);
}

#[test]
fn a_time_out_stops_the_right_test() {
    let sleeps = "timeout='300ms' param='sleep'>T.py";
    let (record, ..) = run(&[("a", ">T.py"), ("b", sleeps), ("c", ">T.py")], "", 1);
    assert_eq!(verdicts(&record), [Verdict::Passed, Verdict::TimedOut, Verdict::Passed]);
}

#[test]
fn what_a_test_leaves_is_its_own_and_ends_with_it() {
    let leaves = "leaks='fail' param='leave'>T.py";
    let tests = [("a", "leaks='fail'>T.py"), ("b", leaves), ("c", "leaks='fail'>T.py")];
    let (record, ..) = run(&tests, "", 1);
    assert_eq!(verdicts(&record), [Verdict::Passed, Verdict::Error, Verdict::Passed]);
    let left = &record.tests[1].attempts[0].leaked;
    assert!(left.iter().any(|process| process.command == "sleep 1000"), "{left:?}");
    assert!(left.iter().all(|process| process.owner.as_deref() == Some("test s/b")), "{left:?}");
    assert_eq!(processes(&record)[0], processes(&record)[1]);
}

#[test]
fn a_child_that_has_ended_is_not_left() {
    let tests = [("a", "leaks='fail' param='zombie'>T.py"), ("b", "leaks='fail'>T.py")];
    let (record, ..) = run(&tests, "", 0);
    assert_eq!(processes(&record)[0], processes(&record)[1]);
}

#[test]
fn a_thread_that_was_left_ends_the_test_that_runs_then() {
    let sleeps = "param='sleep'>T.py";
    let (record, ..) = run(&[("a", "param='thread'>T.py"), ("b", sleeps), ("c", ">T.py")], "", 1);
    assert_eq!(verdicts(&record), [Verdict::Passed, Verdict::Crashed, Verdict::Passed]);
}

#[test]
fn a_host_that_ends_between_two_tests_is_warned_of() {
    let fixture = "<fixture type='python'>F.py</fixture>";
    let (record, events) =
        run(&[("a", "param='thread'>T.py"), ("b", ">T.py"), ("c", ">T.py")], fixture, 0);
    assert_eq!(verdicts(&record), [Verdict::Passed; 3]);
    let pids = processes(&record);
    assert_ne!(pids[0], pids[1]);
    assert_eq!(pids[1], pids[2], "with fixtures hosts are shared, too");
    let is_told = |event: &Event| matches!(&event.kind, EventKind::Warning { diagnostic } if diagnostic.code == "shared-host-ended");
    assert_eq!(events.iter().filter(|event| is_told(event)).count(), 1);
}

#[test]
fn a_suite_that_ends_early_takes_the_host_along() {
    let tests = [("a", ">T.py"), ("b", "critical='true' param='fail'>T.py"), ("c", ">T.py")];
    let (record, ..) = run(&tests, "<fixture type='python'>F.py</fixture>", 1);
    assert_eq!(verdicts(&record), [Verdict::Passed, Verdict::Failed, Verdict::Skipped]);
}

#[test]
fn a_cpp_plugin_is_loaded_once() {
    let plugins = build_cpp(&root().join("conformance"), "conformance");
    let (pass, crash) = (plugins.join("pass.so"), plugins.join("crash.so"));
    let (pass, crash) = (format!(">{}", pass.display()), format!(">{}", crash.display()));
    let tests = [("a", pass.as_str()), ("b", &pass), ("c", &crash), ("d", &pass), ("e", &pass)];
    let (record, ..) = run(&tests, "", 1);
    use Verdict::{Crashed, Passed};
    assert_eq!(verdicts(&record), [Passed, Passed, Crashed, Passed, Passed]);
    let exits: Vec<_> = record
        .tests
        .iter()
        .map(|test| test.attempts[0].finished.as_ref().and_then(|(_, finish)| finish.exit))
        .collect();
    let crashed = Some(ExitStatus::Signal(11));
    assert_eq!(exits, [None, None, crashed, None, Some(ExitStatus::Code(0))]);
}
