//! The grace of a stop belongs to the whole process tree: an arm behind a wrapper that ends at the
//! signal, does not pass it on, or lives in another session, parks.

use rtf_model::{EventKind, Phase, TestId, Verdict};

use crate::support::{Folder, Journal, nothing_left, number, wait_until};

/// An arm. It counts its stop signals, needs some time to park, and then says so.
const ARM: &str = "import signal, sys, time\n\
name, milliseconds = sys.argv[1], float(sys.argv[2])\n\
count = 0\n\
def park(*_):\n    global count\n    count += 1\n    if count > 1:\n        return\n    \
end = time.monotonic() + milliseconds / 1000\n    \
while time.monotonic() < end:\n        time.sleep(0.01)\n    \
print('parked', flush=True)\n    \
open('parked-' + name, 'w').write(str(count))\n    sys.exit(0)\n\
signal.signal(signal.SIGTERM, park)\n\
open('up-' + name, 'w').close()\n\
print('up', flush=True)\n\
while True:\n    time.sleep(1000)\n";

/// Starts the arm, and ends at the signal without it.
const LAUNCHER: &str = "import subprocess, sys\nsys.exit(subprocess.call(sys.argv[1:]))\n";

/// Takes the signal, does not pass it on, and waits for the arm, which is in another session.
const DEAF: &str = "import signal, subprocess, sys\n\
signal.signal(signal.SIGTERM, lambda *_: None)\n\
sys.exit(subprocess.Popen(sys.argv[1:], start_new_session=True).wait())\n";

/// As `xvfb-run`.
const SCRIPT: &str = "#!/bin/sh\ntrap 'exit 0' TERM\n\"$@\" &\nwait\n";

/// The wrappers, and how many signals the arm gets behind each of them, at most.
const WRAPPERS: [(&str, &str, &str); 10] = [
    ("wait", "sh -c '{arm} & wait'", "1"),
    ("shell", "sh -c '{arm}; exit $?'", "1"),
    ("nice", "nice -n 1 {arm}", "1"),
    ("env", "env A=B {arm}", "1"),
    ("cleared", "sh -c 'env -i /usr/bin/env {arm}; exit $?'", "1"),
    ("setsid", "setsid --wait {arm}", "1"),
    ("launcher", "python3 launcher.py {arm}", "1"),
    // It passes the signal on, to its child and to the process group.
    ("timeout", "timeout 1000 {arm}", "3"),
    ("script", "sh script.sh {arm}", "1"),
    ("deaf", "python3 deaf.py {arm}", "1"),
];

/// How long an arm needs to park: `RTF_PARK_MILLISECONDS`.
fn milliseconds() -> u64 {
    number("RTF_PARK_MILLISECONDS").unwrap_or(200)
}

fn arm(name: &str) -> String {
    format!("python3 arm.py {name} {}", milliseconds())
}

fn wrapped(name: &str, command: &str) -> String {
    command.replace("{arm}", &arm(name)).replace('&', "&amp;")
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("arm.py", ARM).file("launcher.py", LAUNCHER).file("deaf.py", DEAF);
    folder.file("script.sh", SCRIPT);
    folder
}

/// A suite with an arm behind each wrapper.
fn arms(test: &str) -> Folder {
    let folder = folder();
    folder.file("T.py", test);
    let fixture = |(name, command, _): &(&str, &str, &str)| {
        // The arm of a deaf wrapper is asked after half of the grace. On a busy machine, the
        // others need more than it takes to park.
        let grace = if *name == "deaf" { "5s" } else { "30s" };
        format!(
            "  <fixture type='process' name='{name}' depends=''>\n    <command>{}</command>\n    \
             <ready file='up-{name}'/>\n    <stop grace='{grace}'/>\n  </fixture>\n",
            wrapped(name, command)
        )
    };
    let fixtures: String = WRAPPERS.iter().map(fixture).collect();
    let tests = "  <test type='python'>T</test>\n";
    folder.file("s.xml", &format!("<suite name='s'>\n{fixtures}{tests}</suite>\n"));
    folder
}

fn parked(folder: &Folder, name: &str) -> Option<String> {
    std::fs::read_to_string(folder.path().join(format!("parked-{name}"))).ok()
}

/// All arms have parked, each with one signal, and nothing was killed or called a leak.
fn check_arms(folder: &Folder, context: &str) {
    for (name, _, signals) in WRAPPERS {
        let parked = parked(folder, name);
        assert!(parked.is_some(), "{name} was killed\n{context}");
        assert!(parked.is_some_and(|count| *count <= *signals), "{name}\n{context}");
    }
    check_no_leaks(&folder.journal(), context);
    assert!(nothing_left(folder), "{context}");
}

fn check_no_leaks(journal: &Journal, context: &str) {
    for event in &journal.events {
        let leaked = match &event.kind {
            EventKind::ProcessesLeaked { processes, .. } => processes,
            EventKind::RunnerDied { leaked, .. } => leaked,
            EventKind::Warning { diagnostic } => panic!("{diagnostic:?}\n{context}"),
            EventKind::FixtureStopped { problem: Some(problem), .. } => {
                panic!("{problem}\n{context}")
            }
            _ => continue,
        };
        assert!(leaked.is_empty(), "{leaked:?}\n{context}");
    }
}

fn is_in_run(kind: &EventKind) -> bool {
    matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. })
}

const PASSES: &str = "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        pass\n";
const WAITS: &str =
    "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        self.sleep(1000)\n";

#[test]
fn an_arm_behind_any_wrapper_parks_at_the_end_of_the_suite() {
    let folder = arms(PASSES);
    let finished = folder.rtf(&["run", "s.xml"]);
    let context = format!("{}{}", finished.stdout, finished.stderr);
    assert_eq!(finished.code, Some(0), "{context}");
    check_arms(&folder, &context);
}

#[test]
fn an_arm_behind_any_wrapper_parks_after_ctrl_c() {
    let folder = arms(WAITS);
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(is_in_run);
    running.signal("INT");
    let finished = running.finish();
    let context = format!("{}{}", finished.stdout, finished.stderr);
    assert_eq!(finished.code, Some(130), "{context}");
    check_arms(&folder, &context);
}

#[test]
fn an_arm_behind_any_wrapper_parks_after_the_death_of_the_runner() {
    let folder = arms(WAITS);
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(is_in_run);
    running.kill_runner();
    let finished = running.finish();
    let context = format!("{}{}", finished.stdout, finished.stderr);
    assert_eq!(finished.code, Some(5), "{context}");
    check_arms(&folder, &context);
}

/// The plug-in stops the wrapper only.
#[test]
fn an_arm_of_a_plug_in_fixture_parks() {
    let plugin = "import os, subprocess, time, rtf\nclass F(rtf.FixtureManager):\n    \
        def setup(self, args):\n        self.arm = subprocess.Popen(['sh', '-c', 'COMMAND & wait'])\n        \
        while not os.path.exists('up-arm'):\n            time.sleep(0.01)\n        return True\n    \
        def tearDown(self):\n        self.arm.terminate()\n        self.arm.wait()\n        return True\n";
    let folder = folder();
    folder.file("F.py", &plugin.replace("COMMAND", &arm("arm"))).file("T.py", PASSES);
    let fixture = "<fixture type='python'>F</fixture>";
    folder.file("s.xml", &format!("<suite name='s'>{fixture}<test type='python'>T</test></suite>"));
    let finished = folder.rtf(&["run", "s.xml"]);
    let context = format!("{}{}", finished.stdout, finished.stderr);
    assert_eq!(finished.code, Some(0), "{context}");
    assert_eq!(parked(&folder, "arm").as_deref(), Some("1"), "{context}");
    check_no_leaks(&folder.journal(), &context);
    assert!(nothing_left(&folder));
}

/// The test ends when it is asked to, and its wrapper with it.
#[test]
fn an_arm_of_a_test_that_times_out_parks() {
    let test = "import subprocess, rtf\nclass T(rtf.TestCase):\n    def run(self):\n        \
        arm = subprocess.Popen(['sh', '-c', self.param + ' & wait'])\n        \
        self.sleep(1000)\n    \
        def interrupted(self):\n        pass\n";
    let folder = folder();
    folder.file("T.py", test);
    let limits = "timeout='1s' grace='500ms'";
    let param = arm("arm");
    folder.file(
        "s.xml",
        &format!("<suite name='s'><test type='python' {limits} param='{param}'>T</test></suite>"),
    );
    let finished = folder.rtf(&["run", "s.xml"]);
    let context = format!("{}{}", finished.stdout, finished.stderr);
    assert_eq!(finished.code, Some(1), "{context}");
    let journal = folder.journal();
    assert_eq!(journal.record.verdict(TestId(0)), Some(Verdict::TimedOut), "{context}");
    assert_eq!(parked(&folder, "arm").as_deref(), Some("1"), "{context}");
    check_no_leaks(&journal, &context);
    assert!(nothing_left(&folder));
}

/// Under the runner, and under the guard.
#[test]
fn an_arm_of_a_hook_that_times_out_parks() {
    for is_killed in [false, true] {
        let folder = folder();
        folder.file("T.py", if is_killed { WAITS } else { PASSES });
        let hook = format!(
            "<hook name='park' on='end interrupt' timeout='2s'><command>{}</command></hook>",
            wrapped("arm", "sh -c '{arm} & wait'")
        );
        folder
            .file("s.xml", &format!("<suite name='s'>{hook}<test type='python'>T</test></suite>"));
        let running = folder.start(&["run", "s.xml"]);
        if is_killed {
            running.wait_for(is_in_run);
            running.kill_runner();
        }
        let finished = running.finish();
        let context = format!("{}{}", finished.stdout, finished.stderr);
        assert_eq!(finished.code, Some(4), "{context}");
        assert_eq!(parked(&folder, "arm").as_deref(), Some("1"), "{context}");
        check_no_leaks(&folder.journal(), &context);
        assert!(nothing_left(&folder));
    }
}

/// The wrapper dies while a test runs: the collapse comes at once, and the arm parks.
#[test]
fn an_arm_whose_wrapper_dies_parks_after_the_collapse() {
    let folder = folder();
    folder.file("T.py", WAITS);
    folder.file(
        "s.xml",
        &format!(
            "<suite name='s'><fixture type='process' name='arm' restarts='0'>\
             <command>{}</command><ready file='up-arm'/></fixture>\
             <test type='python'>T</test></suite>",
            wrapped("arm", "sh -c 'echo $$ > pid; {arm} & wait'")
        ),
    );
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(is_in_run);
    let pid = folder.read("pid").trim().parse().expect("a number");
    crate::support::kill(pid);
    running.wait_for(|kind| matches!(kind, EventKind::FixtureCollapsed { .. }));
    let finished = running.finish();
    let context = format!("{}{}", finished.stdout, finished.stderr);
    assert_eq!(finished.code, Some(1), "{context}");
    assert_eq!(folder.journal().record.verdict(TestId(0)), Some(Verdict::Collapsed));
    assert_eq!(parked(&folder, "arm").as_deref(), Some("1"), "{context}");
    assert!(nothing_left(&folder));
}

/// What is left after the grace is killed, and named.
#[test]
fn an_arm_that_does_not_park_in_time_is_killed_and_the_run_is_red() {
    let folder = folder();
    folder.file("T.py", PASSES);
    let stubborn = "sh -c '(trap \"\" TERM; echo up; exec sleep 1000) &amp; wait'";
    folder.file(
        "s.xml",
        &format!(
            "<suite name='s'><fixture type='process' name='arm'><command>{stubborn}</command>\
             <ready log='up'/><stop grace='300ms'/></fixture><test type='python'>T</test></suite>"
        ),
    );
    let finished = folder.rtf(&["run", "s.xml"]);
    let context = format!("{}{}", finished.stdout, finished.stderr);
    assert_eq!(finished.code, Some(1), "{context}");
    let journal = folder.journal();
    let problem = &journal.record.fixtures[0].problems.first().expect("a problem").1;
    let expected =
        "it did not stop within 300ms and was killed; `sleep 1000` still ran and was killed";
    assert_eq!(problem, expected);
    let is_leak = |kind: &EventKind| matches!(kind, EventKind::ProcessesLeaked { .. });
    assert!(!journal.events.iter().any(|event| is_leak(&event.kind)), "{context}");
    assert!(nothing_left(&folder));
}

/// A process that is left by a fixture that ends by itself is a leak.
#[test]
fn a_daemon_of_a_fixture_that_ends_by_itself_is_a_leak() {
    let folder = folder();
    folder.file("T.py", WAITS);
    folder.file(
        "s.xml",
        "<suite name='s'><fixture type='process' name='arm' restarts='0'>\
         <command>sh -c 'setsid sleep 1000 &amp; echo up; until test -e go; do sleep 0.01; done'</command>\
         <ready log='up'/></fixture><test type='python'>T</test></suite>",
    );
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(is_in_run);
    folder.file("go", "");
    assert_eq!(running.finish().code, Some(1));
    let journal = folder.journal();
    let is_leak = |kind: &EventKind| matches!(kind, EventKind::ProcessesLeaked { .. });
    wait_until("nothing", || nothing_left(&folder).then_some(()));
    assert!(journal.events.iter().any(|event| is_leak(&event.kind)));
}
