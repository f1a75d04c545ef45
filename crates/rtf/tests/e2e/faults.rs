//! Injected faults: each one is felt by real processes, and none is left however a run ends.

mod filling;
mod from_tests;
mod leftovers;
mod network;
mod values;

use rtf_model::{FaultKind, FaultRecord, TestId, Verdict};

use crate::support::{Finished, Folder, Journal, nothing_left};

/// Replaces the file `tick` all the time, with a count; a child does the same with `child`.
const CAMERA: &str = "import itertools, os, sys, time\n\
name = sys.argv[1]\n\
if name == 'tick' and os.fork() == 0:\n    name = 'child'\n\
for number in itertools.count(1):\n    \
with open(name + '.new', 'w') as file: file.write(str(number))\n    \
os.rename(name + '.new', name)\n    \
time.sleep(0.002)\n";

/// Waits for a file with a text, which the test under a fault writes or reads.
const SUPPORT: &str = "function ticks(name) local f = io.open(name); if not f then return 0 end\n\
local n = tonumber(f:read('a')) or 0; f:close(); return n end\n\
function runs(name) local from = ticks(name); return rtf.wait_until(function() return ticks(name) > from end, 30, name .. ' runs') end\n\
function stands(name) local from = ticks(name); rtf.sleep(0.15); return ticks(name) == from end\n";

const FIXTURE: &str = "<fixture type='process' name='camera'>\
    <command>python3 camera.py tick</command><ready command='test -e tick -a -e child'/></fixture>";

fn folder(inside: &str, test: &str) -> Folder {
    let folder = Folder::new();
    folder.file("camera.py", CAMERA).file("T.lua", &format!("{SUPPORT}{test}"));
    folder.file("s.xml", &format!("<suite name='arm'>\n{FIXTURE}\n{inside}\n</suite>"));
    folder
}

fn run(inside: &str, test: &str) -> (Finished, Journal, Folder) {
    let folder = folder(inside, test);
    let finished = folder.rtf(&["run", "s.xml", "--report", "junit=junit.xml"]);
    let journal = folder.journal();
    assert!(nothing_left(&folder));
    (finished, journal, folder)
}

fn faults(journal: &Journal) -> &[FaultRecord] {
    &journal.record.tests[0].attempts.last().expect("an attempt").faults
}

fn passes(finished: &Finished) {
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
}

/// Waits for the fault in the test: the camera runs, stands, and runs again.
const STANDS_BETWEEN: &str = "function TestCase.run()\n\
    rtf.require(runs('tick')); rtf.require(runs('child'))\n\
    rtf.wait_until(function() return stands('tick') and stands('child') end, 30, 'the camera stands')\n\
    rtf.require(runs('tick')); rtf.require(runs('child')) end\n";

#[test]
fn a_stopped_fixture_stands_for_the_declared_time() {
    let (finished, journal, folder) = run(
        "<fault name='drop' kind='stop' fixture='camera' at='300ms' for='1s'/>\n<test> T.lua </test>",
        STANDS_BETWEEN,
    );
    passes(&finished);
    let [fault] = faults(&journal) else { panic!("{:?}", faults(&journal)) };
    assert_eq!((fault.fault.kind, &*fault.fault.name), (FaultKind::Stop, "drop"));
    assert_eq!(fault.fault.effect, "stopped 2 processes of `camera`");
    let lasted = fault.removed.expect("it was removed").since(fault.injected).as_secs_f64();
    assert!((0.99..5.0).contains(&lasted), "{lasted}");
    assert!(finished.stdout.contains("arm/T, drop: stopped 2 processes"), "{}", finished.stdout);
    let junit = folder.read("junit.xml");
    assert!(junit.contains("<property name=\"fault.drop\" value=\"stop from "), "{junit}");
}

#[test]
fn a_fault_of_one_process_leaves_the_others_alone() {
    let (finished, journal, _folder) = run(
        "<fixture type='process' name='other'><command>python3 camera.py other</command><ready file='other'/></fixture>
         <test> T.lua <fault name='drop' kind='stop' fixture='other' process='camera.py' at='0'/></test>",
        "function TestCase.run() rtf.wait_until(function() return stands('other') end, 30, 'it stands')\n\
         rtf.require(runs('tick')) end\n",
    );
    passes(&finished);
    // It lasted until the end of the test.
    assert!(faults(&journal)[0].removed.is_some());
}

/// It stands for 19 of 20 ms: a program that sleeps for 2 ms runs at most a few times in each.
#[test]
fn a_slowed_fixture_runs_for_its_share() {
    let (finished, journal, _folder) = run(
        "<fault name='busy' kind='slow' fixture='camera' cpu='5%' at='1s' for='1s'/>\n<test> T.lua </test>",
        "function rate() local from = ticks('tick'); rtf.sleep(0.4); return (ticks('tick') - from) / 0.4 end\n\
         function TestCase.run() local fast = rate(); rtf.sleep(0.8); local slow = rate()\n\
         rtf.measure('fast', fast); rtf.measure('slow', slow)\n\
         rtf.require(slow > 0, 'it runs'); rtf.require(slow < fast / 2, 'it is slow')\n\
         rtf.wait_until(function() return rate() > 1.5 * slow end, 30, 'it is fast again') end\n",
    );
    passes(&finished);
    assert!(faults(&journal)[0].fault.effect.starts_with("slowed to 5 %: 2 processes of `camera`"));
    assert!(faults(&journal)[0].removed.is_some());
}

#[test]
fn a_killed_process_is_a_collapse_of_its_fixture() {
    let (finished, journal, _folder) = run(
        "<test after-collapse='fail'> T.lua <fault name='crash' kind='kill' fixture='camera' at='100ms'/></test>",
        "function TestCase.run() rtf.sleep(60) end\n",
    );
    assert_ne!(finished.code, Some(0));
    assert_eq!(journal.record.verdict(TestId(0)), Some(Verdict::Collapsed));
    let [fault] = faults(&journal) else { panic!("{:?}", faults(&journal)) };
    assert_eq!((fault.fault.kind, fault.removed), (FaultKind::Kill, None));
}

#[test]
fn a_fault_without_its_process_is_an_error_at_its_place() {
    let (_, journal, _folder) = run(
        "<test> T.lua
         <fault name='drop' kind='stop' fixture='camera' process='driver' at='0'/></test>",
        "function TestCase.run() rtf.sleep(0.5) end\n",
    );
    let attempt = &journal.record.tests[0].attempts[0];
    let failure = attempt.failures().next().expect("an error");
    assert_eq!(
        failure.text,
        "fault `drop` was not injected: the fixture `camera` has no process `driver`; it has \
         `camera.py`"
    );
    assert_eq!(failure.location.as_ref().unwrap().to_string(), "s.xml:4");
}
