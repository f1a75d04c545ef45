//! However a run ends, no fault is left.

use rtf_model::{EventKind, Phase, TestId, Verdict};

use super::filling::small_file_system;
use super::{faults, folder};
use crate::support::{Folder, Random, nothing_left, number, wait_until};

/// A program that is killed cannot continue what it has stopped; its successor does.
#[test]
fn a_killed_host_of_faults_leaves_no_process_stopped() {
    let folder = folder(
        "<test after-collapse='skip'> T.lua <fault name='drop' kind='stop' fixture='camera' at='0'/></test>
         <test param='next'> T.lua </test>",
        "function TestCase.setup(args) first = args[1] == nil; return true end\n\
         function TestCase.run() if first then rtf.sleep(60) end\n\
         rtf.require(runs('tick')); rtf.require(runs('child')) end\n",
    );
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(|kind| matches!(kind, EventKind::FaultInjected(_)));
    let host = wait_until("the host", || process_below(running.runner(), "rtf-host-faults"));
    crate::support::send(host, "KILL");
    let finished = running.finish();
    let journal = folder.journal();
    let verdict = journal.record.verdict(TestId(1));
    assert_eq!(verdict, Some(Verdict::Passed), "{}{}", finished.stdout, finished.stderr);
    assert!(nothing_left(&folder));
}

pub fn process_below(parent: i32, name: &str) -> Option<i32> {
    let entries = std::fs::read_dir("/proc").ok()?.flatten();
    let pids = entries.filter_map(|entry| entry.file_name().to_str()?.parse::<i32>().ok());
    let mut found = pids.filter(|pid| {
        let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
        let fields = stat
            .rsplit_once(") ")
            .map(|(_, rest)| rest.split(' ').nth(1) == Some(&*parent.to_string()));
        stat.contains(&format!("({name})")) && fields == Some(true)
    });
    found.next()
}

/// The hook runs while the camera is alive: it has been continued.
const PARK: &str = "<hook name='park' on='interrupt'><command>sh -c 'exec python3 park.py 2>park.log'</command></hook>";
const PARK_PROGRAM: &str = "import time\n\
def ticks(name):\n    with open(name) as file: return int(file.read())\n\
for name in ('tick', 'child'):\n    \
before, end = ticks(name), time.monotonic() + 20\n    \
while ticks(name) <= before and time.monotonic() < end: time.sleep(0.001)\n    \
assert ticks(name) > before, name\n\
open('parked', 'a').write('parked')\n";

/// The runner is killed at random moments of a run in which faults begin and end all the time.
#[test]
fn after_the_death_of_the_runner_no_fault_is_left() {
    let dir = small_file_system().expect("`/dev/shm` is a file system of its own");
    let path = dir.path().display();
    let folder = folder(
        &format!(
            "{PARK}<test repetition='1000'> T.lua
             <fault name='drop' kind='stop' fixture='camera' at='0s..40ms' for='30ms..60ms'/>
             <fault name='busy' kind='slow' fixture='camera' cpu='20%' at='0s..40ms'/>
             <fault name='full' kind='disk' dir='{path}' size='64MiB' at='0s..40ms' for='20ms..60ms'/>
             <fault name='net' kind='network' delay='10ms' at='0s..40ms' for='20ms..60ms'/>
             <fault name='memory' kind='memory' size='64MiB' at='0s..40ms' for='20ms..60ms'/></test>"
        ),
        "function TestCase.run() rtf.sleep(0.08) end\n",
    );
    folder.file("park.py", PARK_PROGRAM);
    let suite = folder.read("s.xml").replace("name='arm'", "name='arm' isolate='network'");
    folder.file("s.xml", &suite);
    let before_rules = rules();
    let mut random = Random::from_environment();
    for kill in 0..number("RTF_CHAOS_RUNS").unwrap_or(100).div_ceil(2) {
        let _ = std::fs::remove_file(folder.path().join("parked"));
        let _ = std::fs::remove_dir_all(folder.path().join("rtf-results"));
        let running = folder.start(&["run", "s.xml"]);
        running.wait_for(|kind| matches!(kind, EventKind::TestStarted { .. }));
        let moment = std::time::Duration::from_millis(random.below(1000));
        std::thread::sleep(moment);
        let was_killed = running.try_kill_runner();
        let finished = running.finish();
        assert!(was_killed, "{}{}", finished.stdout, finished.stderr);
        let log = std::fs::read_to_string(folder.path().join("park.log")).unwrap_or_default();
        let error = &finished.stderr;
        assert_eq!(finished.code, Some(5), "kill {kill} after {moment:?}: {error}{log}");
        assert!(nothing_left(&folder), "kill {kill} after {moment:?}");
        assert_eq!(rules(), before_rules, "kill {kill} after {moment:?}");
        // No process is left, so none has a file open that was removed.
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0);
        let was_in_test = finished.stderr.contains("hook park");
        if was_in_test {
            let parked = folder.path().join("parked").exists();
            assert!(parked, "kill {kill} after {moment:?}: {}", finished.stderr);
        }
        for file in ["tick", "child"] {
            std::fs::remove_file(folder.path().join(file)).expect("the camera ran");
        }
    }
}

/// The routing rules of this network, which no suite has changed.
fn rules() -> String {
    let output = std::process::Command::new("ip").args(["rule"]).output().expect("ip");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// A test during which the camera is stopped, and a hook that parks.
fn stopped_camera() -> Folder {
    let folder = folder(
        &format!(
            "{PARK}<test> T.lua <fault name='drop' kind='stop' fixture='camera' at='0'/></test>"
        ),
        "function TestCase.run() rtf.sleep(60) end\n",
    );
    folder.file("park.py", PARK_PROGRAM);
    folder
}

/// The hooks need the fixtures.
#[test]
fn a_fixture_that_a_fault_stopped_is_continued_before_the_hooks_of_the_guard() {
    let folder = stopped_camera();
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(|kind| matches!(kind, EventKind::FaultInjected(_)));
    running.wait_for(|kind| matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. }));
    running.kill_runner();
    let finished = running.finish();
    assert_eq!(finished.code, Some(5), "{}", finished.stderr);
    assert!(finished.stderr.contains("hook park: parked"), "{}", finished.stderr);
    assert!(folder.path().join("parked").exists());
    assert!(nothing_left(&folder));
}

/// Ctrl-C during a fault.
#[test]
fn an_interrupted_run_leaves_no_fault() {
    let folder = stopped_camera();
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(|kind| matches!(kind, EventKind::FaultInjected(_)));
    running.signal("INT");
    let finished = running.finish();
    assert!(folder.path().join("parked").exists(), "{}{}", finished.stdout, finished.stderr);
    let journal = folder.journal();
    assert_eq!(journal.record.verdict(TestId(0)), Some(Verdict::Interrupted));
    assert!(faults(&journal)[0].removed.is_some());
    assert!(nothing_left(&folder));
}
